// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/mesh_controller.h>
#include <viscoplastic_contact/run/announcer.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

namespace Viscoplastic
{
  // Checks of a scene without solving it. All functions are collective and
  // throw ExcMessage with a sentence for the user.

  /// Make the first mesh, check the scene against it, and let steps of
  /// controlled size end at kinks and jumps of the data. @p announcer is null
  /// if nothing is to be printed.
  template <int dim>
  void
  make_first_mesh(Scene<dim>                                &scene,
                  parallel::distributed::Triangulation<dim> &triangulation,
                  StepControl                               &control,
                  Announcer<dim>                            *announcer);

  /// Throw unless a discretization exists in all stages of construction.
  template <int dim>
  void
  check_stages(const FiniteElement<dim> &fe,
               DoFHandler<dim>          &dof_handler,
               Scene<dim>               &scene);

  /// Give @p accepted the initial data, (3.20), in equilibrium if the scene
  /// asks for that. Returns false, with cells marked, if the mesh of a run to a
  /// tolerance is too coarse for them. @p error_estimator may be null.
  template <int dim>
  bool
  resolve_initial_data(const Discretization<dim> &discretization,
                       const ErrorEstimator<dim> *error_estimator,
                       MeshController<dim>       &mesh_controller,
                       TimeStepper<dim>          &time_stepper,
                       EvaluatedState<dim>       &accepted);

  /// Refuse a first step beyond the stability limit before any file is written,
  /// and warn of later ones. Sets the rate of @p initial.
  template <int dim>
  void
  check_steps(const Discretization<dim> &discretization,
              const StepControl         &control,
              Console                   &console,
              EvaluatedState<dim>       &initial);

  /// Perform all checks that need no solution: those of the scene with its
  /// mesh, initial data and data at sampled times; print size, solver and
  /// expected memory.
  template <int dim>
  void
  check_scene(const Parameters &parameters, Console &console);
} // namespace Viscoplastic
