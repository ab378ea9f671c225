// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/scene/scene.h>

#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A time within a step at which a datum is far from its values at both ends
  /// of the step, so that a run with these steps does not see what it does: a
  /// load that vibrates in time with the steps, or a short blow. Far is two
  /// fifths of the range of its values, summed over the places, so that a load
  /// that wanders is no such datum; nor is a jump or a ramp within a step. In
  /// long runs a single pulse may be overlooked.
  template <int dim>
  std::optional<double>
  find_unseen_change(const Expression<dim>         &datum,
                     const std::vector<Point<dim>> &places,
                     const TimeSchedule            &schedule);


  /// Sentences that name the loads, displacements and data of friction that
  /// jump in time, that change unseen by the time steps, or that are given but
  /// move nothing. The same on all ranks.
  template <int dim>
  std::vector<std::string>
  warnings_of_data_in_time(const Scene<dim>         &scene,
                           const Triangulation<dim> &triangulation);
} // namespace Viscoplastic
