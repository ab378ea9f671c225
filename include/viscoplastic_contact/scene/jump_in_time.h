// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/scene/scene.h>

#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Return a time within a step at which a datum is far from its values at
  /// both ends of the step, as a load oscillating with the steps or a short
  /// pulse, which a run does not see. Far means 2/5 of the range of values in
  /// the run, both summed over @p places, so that a load moving from place to
  /// place is not reported, nor is a jump or a ramp within a step. Steps are
  /// sampled: in long runs a single pulse may be missed.
  template <int dim>
  std::optional<double>
  find_unseen_change(const Expression<dim>         &datum,
                     const std::vector<Point<dim>> &places,
                     const TimeSchedule            &schedule);


  /// Return warnings that name loads, displacements and data of friction that
  /// jump in time or change unseen within time steps, and foundation motions
  /// without effect. The same on all ranks.
  template <int dim>
  std::vector<std::string>
  warnings_of_data_in_time(const Scene<dim>         &scene,
                           const Triangulation<dim> &triangulation);
} // namespace Viscoplastic
