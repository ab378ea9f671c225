// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>

namespace Viscoplastic
{
  /// A node by itself on a foundation with Coulomb's law: without contact it
  /// would move by `free_motion`, first along the normal of the foundation as
  /// far as it is beyond it, then along it; forces against these motions take
  /// `flexibility` times as much of it.
  struct CoulombNode
  {
    Tensor<2, 3> flexibility;
    Tensor<1, 3> free_motion;
    unsigned int n_tangents;
    /// The bound of friction is `given` + `coefficient` p.
    double                  given, coefficient;
    const NormalCompliance &compliance;
    /// The force at which the node is now; zero where it does not touch.
    double present;
  };

  /// The force p of the node on the foundation. Friction of a given p is known
  /// in closed form (solve_friction_point()); then p is the root of a scalar
  /// function, the penetration that is left at p less that at which the
  /// foundation presses by p. There is always a solution: for p = 0 the node is
  /// beyond the foundation if it is not open, and where p is large friction
  /// holds it. In 2D on a rigid foundation the root of slip is
  ///
  ///     p = (q_n -+ W_nt g)/(W_nn +- mu W_nt).
  ///
  /// For a large mu a node that could be open may be held, or slip, as well.
  /// Then it stays what it is: touching if it touches now, otherwise open.
  double
  coulomb_pressure(const CoulombNode &node);
} // namespace Viscoplastic
