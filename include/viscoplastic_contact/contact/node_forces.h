// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/full_matrix.h>

#include <viscoplastic_contact/contact/contact_layout.h>

#include <vector>

namespace Viscoplastic
{
  /// The coefficients of friction bounds that depend on the pressures p_k >= 0
  /// of the obstacles of the same node:
  ///
  ///     rho_c = g_c + sum_k mu_ck p_k
  struct CoulombCoefficients
  {
    /// g_c, point by point; of no meaning for obstacles.
    std::vector<double> given;
    /// mu_ck, in the order of the obstacles of the node.
    std::vector<std::vector<double>> of_pressure;

    /// The bound of a point of friction at the pressures of @p state.
    double
    bound(const ContactLayout &face,
          const ContactState  &state,
          const unsigned int   point) const
    {
      double       result = given[point];
      unsigned int o      = face.first_obstacle(face.points[point].node);
      for (const double coefficient : of_pressure[point])
        result += coefficient * state.multiplier[o++][0];
      return result;
    }
  };



  /// The forces of the points at a node where pieces meet. What holds the node
  /// makes up for a force as far as the laws of its points allow: pressures
  /// p >= 0, friction in the ball |lambda| <= rho, or with Coulomb's law in the
  /// cone |lambda| <= g + sum mu p, where the other piece may hold what this
  /// one presses. A point that slips adds mu s/|s| to the force of a unit of
  /// pressure. All of these sets are convex, so there is a best fit; where it
  /// leaves a choice, as at a corner that sticks, that of least norm is taken,
  /// or where the node can move, that whose pressures hold what they can.
  class NodeForces
  {
  public:
    /// All arguments stay in use. @p law: null where bounds are given.
    NodeForces(const ContactLayout       &face,
               unsigned int               node,
               const ContactState        &state,
               const CoulombCoefficients *law);

    /// Set the node's multipliers, and with a law its bounds, in @p state to
    /// what fits @p residual best. Returns what is missing of it.
    Tensor<1, 3>
    fit(const Tensor<1, 3> &residual, ContactState &state) const;

    /// By how much the pressures of the obstacles, as fit() finds them, change
    /// with the node's force: each by its vector times the change. The node may
    /// move as far as nothing holds it, so that springs press more or less,
    /// what is at its bound of friction goes with them, and so on.
    std::vector<Tensor<1, 3>>
    pressures_of_force() const;

    /// The pressures in the force @p residual by these, from the multipliers
    /// that fit() has found on.
    std::vector<double>
    pressures(const Tensor<1, 3> &residual) const;

    /// Whether the node can move.
    bool
    is_free() const
    {
      return n_held < face.n_node_dofs(node);
    }

  private:
    /// A row of a point that takes part: a component of its multiplier.
    struct Column
    {
      unsigned int point, component;
    };

    /// By how much pressures change: of_force[j] times a change of the node's
    /// force, of_spring[k][j] times one of the pressure k of a spring.
    struct PressureChanges
    {
      std::vector<Tensor<1, 3>>        of_force;
      std::vector<std::vector<double>> of_spring;
    };

    /// Those of what holds the node: changes of its multipliers of least norm
    /// that make up for those of force and springs and keep friction at the
    /// bounds it has reached.
    PressureChanges
    changes_of_what_holds() const;

    /// Their equations, for the multipliers in @p columns: the force, then the
    /// bounds of the points in @p limits.
    FullMatrix<double>
    equations(const std::vector<Column>       &columns,
              const std::vector<unsigned int> &limits) const;

    /// By how much springs press more with the node's force, obstacle by
    /// obstacle: by how far the node moves. In the directions that are free
    /// their forces, with the friction that follows from a unit of pressure,
    /// are in balance with it: dual vectors tell which is which.
    std::vector<Tensor<1, 3>>
    springs_of_force(const PressureChanges &changes) const;

    /// Whether a point slips, so that its friction has the direction of the
    /// slip.
    bool
    slips(const unsigned int p) const
    {
      return !face.points[p].is_obstacle && !state.sticks[p] &&
             state.slip[p].norm() > 0.;
    }

    /// Whether a point is one of those that hold the node here.
    bool
    takes_part(const unsigned int p) const
    {
      const ContactLayout::Point &point = face.points[p];
      return state.blocks(point, p) ||
             (law != nullptr && !point.is_obstacle && !slips(p));
    }

    /// Whether an obstacle presses by how far the node is in it.
    bool
    is_spring(const unsigned int o) const
    {
      return state.sticks[o] && face.points[o].gives_way();
    }

    /// What a slipping point has of its bound, and any point of its bound,
    /// whatever the obstacles that take part press.
    double
    given_bound(unsigned int p) const;

    /// The same with these.
    double
    bound(unsigned int p, const std::vector<Tensor<1, 2>> &multipliers) const;

    /// Move the multipliers of the node to the nearest ones that the laws
    /// allow.
    void
    clip(std::vector<Tensor<1, 2>> &multipliers) const;

    /// The forces of those that take part, of slipping points as far as it
    /// follows from pressures, in the directions that are held.
    Tensor<1, 3>
    force(const std::vector<Tensor<1, 2>> &multipliers) const;

    /// G^+ x for the matrix of these forces.
    Tensor<1, 3>
    invert_gram(const Tensor<1, 3> &x) const;

    const ContactLayout       &face;
    const unsigned int         node, begin, end, obstacle;
    const ContactState        &state;
    const CoulombCoefficients *law;

    /// The force of a unit of pressure, obstacle by obstacle.
    std::vector<Tensor<1, 3>> push;
    /// Onto the directions that are held, and their number.
    Tensor<2, 3> held;
    unsigned int n_held = 0;
    /// How much more pressures count than friction in what is least.
    double pressure_scale;
    /// Whether an obstacle here gives way.
    bool any_springs;
    /// Eigenvalues and vectors of G with this, and the largest without.
    std::array<std::pair<double, Tensor<1, 3>>, 3> gram;
    double                                         largest;
  };
} // namespace Viscoplastic
