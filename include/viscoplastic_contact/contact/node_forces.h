// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>
#include <viscoplastic_contact/contact/coulomb_coefficients.h>

namespace Viscoplastic
{
  /**
   * The forces of the points at a node where pieces meet. What holds the node
   * makes up for a force as far as the laws of its points allow: pressures
   * p >= 0, friction in the ball |lambda| <= rho, or with Coulomb's law in the
   * cone |lambda| <= g + sum mu p, where the other piece may hold what this one
   * presses. A point that slips adds mu s/|s| to the force of a unit of
   * pressure. All of these sets are convex, so there is a best fit; where it
   * leaves a choice, as at a corner that sticks, that of least norm is taken.
   */
  class NodeForces
  {
  public:
    /// All arguments stay in use. @p law: null where bounds are given. With
    /// @p with_springs obstacles that give way count as if they held the node.
    NodeForces(const ContactLayout       &face,
               unsigned int               node,
               const ContactState        &state,
               const CoulombCoefficients *law,
               bool                       with_springs = false);

    /// Set the node's multipliers, and with a law its bounds, in @p state to
    /// what fits @p residual best. Returns what is missing of it.
    Tensor<1, 3>
    fit(const Tensor<1, 3> &residual, ContactState &state) const;

    /// The pressure of an obstacle is this vector times the node's force, as
    /// long as no law limits it, but for what given bounds make of it.
    Tensor<1, 3>
    pressure_of_force(unsigned int obstacle) const;

    /// The pressures in the force @p residual, obstacle by obstacle.
    std::vector<double>
    pressures(const Tensor<1, 3> &residual) const;

    /// Whether the node can move.
    bool
    is_free() const
    {
      return n_held < face.n_node_dofs(node);
    }

  private:
    /// Whether friction at a point has the direction of a slip.
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
      if (!face.points[p].is_obstacle)
        return state.sticks[p] || (law != nullptr && !slips(p));
      return state.sticks[p] && (with_springs || !face.points[p].gives_way());
    }

    /// Of the square of an obstacle's pressure in what is least.
    double
    weight_of(unsigned int o) const;

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
    const bool                 with_springs;

    /// The force of a unit of pressure, obstacle by obstacle.
    std::vector<Tensor<1, 3>> push;
    /// Onto the directions that are held, and their number.
    Tensor<2, 3> held;
    unsigned int n_held = 0;
    /// Eigenvalues and vectors of G.
    std::array<std::pair<double, Tensor<1, 3>>, 3> gram;
  };
} // namespace Viscoplastic
