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



  /// The multipliers at a node where pieces meet, whose forces balance a given
  /// force as far as the laws of the points allow: pressures p >= 0, friction
  /// in the ball |lambda| <= rho, or with Coulomb's law in the cone |lambda| <=
  /// g + sum mu p. A point that slips adds mu s/|s| to the force of a unit of
  /// pressure. All of these sets are convex, so there is a best fit. Where it
  /// is not unique, as at a corner that sticks, the one of least norm is taken
  /// or, at a node that can move into a compliant obstacle, the one whose
  /// pressures carry what they can.
  class NodeForces
  {
  public:
    /// @p law: null where bounds are given. Keeps references to all arguments.
    NodeForces(const ContactLayout       &face,
               unsigned int               node,
               const ContactState        &state,
               const CoulombCoefficients *law);

    /// Set the node's multipliers in @p state, with a law also its bounds, to
    /// the admissible ones whose force is nearest to @p residual (least
    /// squares). Returns the rest of the residual.
    Tensor<1, 3>
    fit(const Tensor<1, 3> &residual, ContactState &state) const;

    /// The derivatives of the pressures that fit() finds with respect to the
    /// force of the node, one vector for each obstacle. They include that the
    /// node moves in its free directions, which changes the forces of compliant
    /// obstacles and friction that is at its bound.
    std::vector<Tensor<1, 3>>
    pressures_of_force() const;

    /// The pressures for the node force @p residual, linearized by these
    /// derivatives about the multipliers of the state; at least zero.
    std::vector<double>
    pressures(const Tensor<1, 3> &residual) const;

    bool
    is_free() const
    {
      return n_held < face.n_node_dofs(node);
    }

  private:
    /// A column of equations(): a component of the multiplier of a point.
    struct Column
    {
      unsigned int point, component;
    };

    /// Derivatives of the pressure j: of_force[j] with respect to the node's
    /// force, of_spring[k][j] to the pressure of the compliant obstacle k.
    struct PressureChanges
    {
      std::vector<Tensor<1, 3>>        of_force;
      std::vector<std::vector<double>> of_spring;
    };

    /// The least-norm changes of constraint multipliers that balance a change
    /// of force and spring pressures and keep friction at bounds that are
    /// reached.
    PressureChanges
    changes_of_what_holds() const;

    /// The equations for these multipliers: three rows for the balance of
    /// forces, then one for each point in @p limits, whose friction stays at
    /// its bound.
    FullMatrix<double>
    equations(const std::vector<Column>       &columns,
              const std::vector<unsigned int> &limits) const;

    /// The derivatives of the pressures of compliant obstacles with respect to
    /// the node's force. In the free directions their forces, with the friction
    /// of a unit of pressure, balance it; a dual basis gives the part of each.
    std::vector<Tensor<1, 3>>
    springs_of_force(const PressureChanges &changes) const;

    /// Whether a point slips, so that its friction has the direction of the
    /// slip.
    bool
    slips(const unsigned int p) const
    {
      return p < obstacle && !state.sticks[p] && state.slip[p].norm() > 0.;
    }

    /// Whether a point's multiplier is an unknown of fit().
    bool
    takes_part(const unsigned int p) const
    {
      return state.blocks(face.points[p], p) ||
             (law != nullptr && p < obstacle && !slips(p));
    }

    /// Whether an obstacle is compliant and in contact.
    bool
    is_spring(const unsigned int o) const
    {
      return state.sticks[o] && !face.points[o].compliance.is_rigid();
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

    /// The force of the multipliers in constrained directions, including the
    /// friction of slipping points that is proportional to pressures.
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
    /// Eigenpairs of G, and the largest eigenvalue without pressure_scale.
    std::array<std::pair<double, Tensor<1, 3>>, 3> gram;
    double                                         largest;
  };
} // namespace Viscoplastic
