// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/error_estimator.h>
#include <viscoplastic_contact/results/energy_balance.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <functional>
#include <memory>

namespace Viscoplastic
{
  // Transfer the accepted state of a run to another discretization and restore
  // equilibrium with sticking friction; the next step lets it slip. @p set_up
  // makes the new discretization and its stepper. @p error_estimator is null if
  // errors are not estimated. Return how the energies change. Collective.

  /// Transfer to the mesh for which cells have been marked.
  template <int dim>
  EnergyChange
  carry_to_marked_mesh(
    const ErrorEstimator<dim>                  *error_estimator,
    const std::unique_ptr<Discretization<dim>> &discretization,
    const std::unique_ptr<TimeStepper<dim>>    &time_stepper,
    parallel::distributed::Triangulation<dim>  &triangulation,
    const std::function<void()>                &set_up,
    EvaluatedState<dim>                        &accepted);

  /// Transfer to a stage of construction with other materials.
  template <int dim>
  EnergyChange
  carry_to_stage(const ErrorEstimator<dim>                  *error_estimator,
                 const std::unique_ptr<Discretization<dim>> &discretization,
                 const std::unique_ptr<TimeStepper<dim>>    &time_stepper,
                 const std::function<void()>                &set_up,
                 EvaluatedState<dim>                        &accepted);
} // namespace Viscoplastic
