// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/scene/scene.h>

#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A time at which a datum has a kink, or jumps.
  struct Kink
  {
    double t;
    bool   is_jump;
  };

  /// The times within a run at which a datum has kinks or jumps at these places
  /// together, ascending. Second differences over windows of width w fall like
  /// w at a kink, like w^2 where the datum is smooth: windows in which they do
  /// not fall like w^2 are halved until the time is known to 1e-10 of the end
  /// time. A kink is a change of the derivative by more than a twentieth of the
  /// mean slope over the run, at a tenth of the places or more, so that a load
  /// that wanders from place to place has none. Two within a 200th of a phase
  /// may be taken for one. Costs nothing where the text of the expression has
  /// nothing that can make kinks.
  template <int dim>
  std::vector<Kink>
  find_kinks(const Expression<dim>         &datum,
             const std::vector<Point<dim>> &places,
             const TimeSchedule            &schedule);

  /// A time at which a datum jumps at these places together, which the theory
  /// excludes: data are Lipschitz continuous in time, (2.10). One that
  /// find_kinks() finds, or at either end of the run.
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

  /// The kinks of loads, displacements and data of friction. The same on all
  /// ranks.
  template <int dim>
  KinksOfScene
  kinks_of_scene(const Scene<dim>         &scene,
                 const Triangulation<dim> &triangulation);
} // namespace Viscoplastic
