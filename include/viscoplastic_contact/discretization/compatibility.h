// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/loads.h>

#include <optional>
#include <set>

namespace Viscoplastic
{
  /// The imbalance between the initial stress and the loads at t = 0.
  template <int dim>
  struct CompatibilityViolation
  {
    /// The largest nodal imbalance over that of the loads.
    double relative = 0.;
    /// The node with the largest force that nothing balances, and the
    /// boundaries that it is on; none inside of the body.
    Point<dim>                   position;
    std::set<types::boundary_id> boundaries;
    /// Whether the imbalance is that of the axial force.
    bool is_axial = false;
  };

  /// The violation of compatibility (2.12),
  ///
  ///     (sigma0, eps(v)) + j(v) >= L(0, v)  for all v,
  ///
  /// relative to the loads: the norm of the residual off Gamma_3 and of its
  /// excess over the friction ball on Gamma_3. Evaluated with sigma0 itself by
  /// quadrature: its projection would violate equilibrium by O(h). Also gives
  /// the multipliers at t = 0. @p face is null without contact points.
  /// Collective.
  template <int dim>
  CompatibilityViolation<dim>
  compatibility_violation(const AdmissibleSpace<dim> &space,
                          const Load<dim>            &load,
                          const ContactFace<dim>     *face,
                          const DistributedVector    &u,
                          ContactState               &contact);

  /// The node at which the displacements that two boundaries prescribe at time
  /// t differ most.
  template <int dim>
  struct DisplacementJump
  {
    double t = 0., size = 0.;
    /// The largest prescribed displacement, a length.
    double                       largest = 0.;
    Point<dim>                   position;
    std::set<types::boundary_id> boundaries;
  };

  /// Find that at the first end of a phase at which they differ; absent: at
  /// none. No displacement of finite energy jumps on the boundary: that of a
  /// mesh does within a cell, and its energy grows with each finer one.
  /// Collective.
  template <int dim>
  std::optional<DisplacementJump<dim>>
  first_jump(const AdmissibleSpace<dim> &space);
} // namespace Viscoplastic
