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
    /// g_c in rho_c = g_c + sum_k mu_ck p_k, by friction point.
    std::vector<double> given;
    /// mu_ck, by friction point and obstacle k of its node.
    std::vector<std::vector<double>> of_pressure;

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
    /// @p law: null where bounds are given. All arguments stay in use.
    NodeForces(const ContactLayout       &face,
               unsigned int               node,
               const ContactState        &state,
               const CoulombCoefficients *law);

    /// Set the node's multipliers in @p state, with a law also its bounds, to
    /// the admissible ones whose force is nearest to @p residual (least
    /// squares). Returns the rest of the residual.
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

    /// The changes of least norm of constraint multipliers that balance a
    /// change of force and spring pressures and keep friction at bounds that
    /// are reached.
    PressureChanges
    changes_of_what_holds() const;

    /// The equations of these multipliers, one a column: balance of the force,
    /// then friction at the bounds of the points in @p limits.
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

    /// Whether a point's multiplier is an unknown of fit().
    bool
    takes_part(const unsigned int p) const
    {
      const ContactLayout::Point &point = face.points[p];
      return state.blocks(point, p) ||
             (law != nullptr && !point.is_obstacle && !slips(p));
    }

    /// Whether an obstacle is compliant and in contact.
    bool
    is_spring(const unsigned int o) const
    {
      return state.sticks[o] && face.points[o].gives_way();
    }

    /// The part of a point's friction bound that does not depend on the
    /// pressures to be found.
    double
    given_bound(unsigned int p) const;

    /// The friction bound of point @p p for these multipliers of the node.
    double
    bound(unsigned int p, const std::vector<Tensor<1, 2>> &multipliers) const;

    /// Project the multipliers of the node onto the admissible set: |lambda_c|
    /// <= rho_c, p_k >= 0.
    void
    clip(std::vector<Tensor<1, 2>> &multipliers) const;

    /// The force of the multipliers in constrained directions, with that of
    /// slipping points as far as it depends on pressures.
    Tensor<1, 3>
    force(const std::vector<Tensor<1, 2>> &multipliers) const;

    /// G^+ x with the Gram matrix G of the forces of unit multipliers.
    Tensor<1, 3>
    invert_gram(const Tensor<1, 3> &x) const;

    const ContactLayout       &face;
    const unsigned int         node, begin, end, obstacle;
    const ContactState        &state;
    const CoulombCoefficients *law;

    /// The node force of unit pressure and its friction, by obstacle.
    std::vector<Tensor<1, 3>> push;
    /// The projector onto the constrained directions, and their number.
    Tensor<2, 3> held;
    unsigned int n_held = 0;
    /// The weight of pressures relative to friction in the least norm.
    double pressure_scale;
    /// Whether an obstacle of the node is compliant.
    bool any_springs;
    /// Eigenvalues and vectors of G, and the largest without that weight.
    std::array<std::pair<double, Tensor<1, 3>>, 3> gram;
    double                                         largest;
  };
} // namespace Viscoplastic
