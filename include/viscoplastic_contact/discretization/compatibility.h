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
    /// The norm of unbalanced nodal forces over that of the loads.
    double relative = 0.;
    /// The node with the largest unbalanced force, and the boundaries that it
    /// is on; none inside of the body.
    Point<dim>                   position;
    std::set<types::boundary_id> boundaries;
    /// Whether the imbalance is that of the axial force.
    bool is_axial = false;
  };

  /// Return the violation of compatibility (2.12),
  ///
  ///     (sigma0, eps(v)) + j(v) >= L(0, v)  for all v,
  ///
  /// relative to the loads: the norm of the residual off Gamma_3 and of its
  /// excess over the friction ball on Gamma_3. sigma0 itself is integrated by
  /// quadrature, as its projection violates equilibrium by O(h). @p contact
  /// gets the multipliers at t = 0. @p face is null without contact points.
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

  /// Return the jump at the first end of a phase at which prescribed
  /// displacements differ, or nothing. Displacements of finite energy do not
  /// jump on the boundary; those of a mesh do within a cell, with an energy
  /// that grows with each refinement. Collective.
  template <int dim>
  std::optional<DisplacementJump<dim>>
  first_jump(const AdmissibleSpace<dim> &space);
} // namespace Viscoplastic
