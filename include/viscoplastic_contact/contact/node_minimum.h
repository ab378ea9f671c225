// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>

#include <optional>

namespace Viscoplastic
{
  /// Minimize J over the components of one node, whatever points meet there:
  ///
  ///     J(x) = 1/2 x . D x - f . x + sum rho_c |s_c| + energies of obstacles
  ///            that give way,   s_c <= d_c at the others.
  ///
  /// For each set of points that may be held, J is minimized with these at rest
  /// or touching, which is a smooth problem; the lowest of the results that
  /// enter no obstacle is the minimum. With up to 2^6 sets where three pieces
  /// meet, this is for nodes at which simpler methods do not converge, such as
  /// one that an obstacle pushes along the direction in which friction holds
  /// it.
  ///
  /// Returns x, and sets `sticks` and the multipliers of slipping points.
  /// Nothing is returned or changed if the obstacles leave no place for the
  /// node.
  std::optional<Tensor<1, 3>>
  minimize_at_node(const ContactLayout &face,
                   const unsigned int   node,
                   const Tensor<2, 3>  &stiffness, // D
                   const Tensor<1, 3>  &force,     // f
                   ContactState        &state);
} // namespace Viscoplastic
