// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/scene.h>

#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /**
   * A time at which a datum jumps at these places together, which the theory
   * excludes: data are Lipschitz continuous in time, (2.10). Found by halving
   * the intervals with the largest changes until only a jump is left; it has to
   * be more than a twentieth of the largest values, so that a load that wanders
   * from place to place is none. Pulses shorter than a 200th of a phase may be
   * overlooked. Costs nothing where the text of the expression has nothing that
   * can jump.
   */
  template <int dim>
  std::optional<double>
  find_jump(const Expression<dim>         &datum,
            const std::vector<Point<dim>> &places,
            const TimeSchedule            &schedule);


  /// A sentence that names the loads, displacements and data of friction that
  /// jump in time, or nothing. The same on all ranks.
  template <int dim>
  std::string
  warning_of_jumps(const Scene<dim>         &scene,
                   const Triangulation<dim> &triangulation);
} // namespace Viscoplastic
