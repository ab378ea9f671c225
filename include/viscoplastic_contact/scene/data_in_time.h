// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/scene/scene.h>

#include <optional>
#include <string>
#include <vector>

// The data of a scene as functions of time: where they have kinks, jump, or
// change unseen between the ends of steps.

namespace Viscoplastic
{
  // About 64 sample places, spread evenly over a part of the boundary or over
  // the body, at which data are examined. They are taken from the coarse mesh,
  // which all ranks know.

  template <int dim>
  std::vector<Point<dim>>
  places_on_boundary(const Triangulation<dim> &triangulation,
                     const types::boundary_id  id);

  template <int dim>
  std::vector<Point<dim>>
  places_in_body(const Triangulation<dim> &triangulation);

  /// Return the values of a datum at the places at time t; a single value if it
  /// does not depend on position.
  template <int dim>
  std::vector<double>
  values_at(const Expression<dim>         &datum,
            const std::vector<Point<dim>> &places,
            const double                   t);

  /// A datum that depends on time, with sample places where it acts.
  template <int dim>
  struct DatumInTime
  {
    const Expression<dim>  &datum;
    std::vector<Point<dim>> places;
  };

  /// Return the loads, displacements, data of friction and the temperature that
  /// depend on time.
  template <int dim>
  std::vector<DatumInTime<dim>>
  data_in_time(const Scene<dim>         &scene,
               const Triangulation<dim> &triangulation);


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
