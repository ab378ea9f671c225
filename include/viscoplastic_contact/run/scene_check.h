// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

namespace Viscoplastic
{
  // Checks of a scene without solving it. All functions are collective and
  // throw ExcMessage with a sentence for the user.

  /// Make the first mesh, check the scene against it, and let steps of
  /// controlled size end at kinks and jumps of the data. @p console is null if
  /// nothing is to be printed.
  template <int dim>
  void
  make_first_mesh(Scene<dim>                                &scene,
                  parallel::distributed::Triangulation<dim> &triangulation,
                  StepControl                               &control,
                  Console                                   *console);

  /// Throw unless a discretization exists in all stages of construction.
  template <int dim>
  void
  check_stages(const FiniteElement<dim> &fe,
               DoFHandler<dim>          &dof_handler,
               Scene<dim>               &scene);

  /// Refuse initial data that violate (2.12); otherwise set their contact
  /// multipliers.
  template <int dim>
  void
  check_compatibility(const Discretization<dim> &discretization,
                      State<dim>                &initial,
                      const Load<dim>           &load);

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
