// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/scene/scene.h>

#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A time at which a datum has a kink or jumps.
  struct Kink
  {
    double t;
    bool   is_jump;
  };

  /// Return the times within a run at which a datum has kinks or jumps at these
  /// places together, ascending. Second differences over windows of width w
  /// decrease like w at a kink and like w^2 where the datum is smooth: windows
  /// in which they do not decrease like w^2 are halved until the time is known
  /// to 1e-10 of the end time. A kink is a change of the derivative by a 20th
  /// of its mean size in the run, at a 10th of the places, so that a load
  /// moving from place to place has none. Kinks in one window, a 200th of a run
  /// with a single phase, may be taken for one. Returns at once if the text of
  /// the expression has nothing that makes kinks.
  template <int dim>
  std::vector<Kink>
  find_kinks(const Expression<dim>         &datum,
             const std::vector<Point<dim>> &places,
             const TimeSchedule            &schedule);

  /// Return a time within the run or at either end of it at which a datum jumps
  /// at these places together, which the theory excludes: data are Lipschitz
  /// continuous in time, (2.10).
  template <int dim>
  std::optional<double>
  find_jump(const Expression<dim>         &datum,
            const std::vector<Point<dim>> &places,
            const TimeSchedule            &schedule);


  /// Times at which steps should end because of the data of a scene.
  struct KinksOfScene
  {
    std::vector<Kink> kinks; // ascending
    /// The entries whose data have kinks.
    std::vector<std::string> entries;
  };

  /// Return the kinks of loads, displacements, data of friction and the
  /// temperature. The same on all ranks.
  template <int dim>
  KinksOfScene
  kinks_of_scene(const Scene<dim>         &scene,
                 const Triangulation<dim> &triangulation);
} // namespace Viscoplastic
