// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/evaluated_state.h>
#include <viscoplastic_contact/run/announcer.h>
#include <viscoplastic_contact/time_stepping/step_control.h>

namespace Viscoplastic
{
  // What is known of a scene without solving anything. All functions are
  // collective and throw ExcMessage with a sentence for the user.

  /// Make the first mesh, hold the scene against it, and let steps that are
  /// chosen by their error end at kinks and jumps of the data. @p announcer is
  /// null if nothing is to be said.
  template <int dim>
  void
  make_first_mesh(Scene<dim>                                &scene,
                  parallel::distributed::Triangulation<dim> &triangulation,
                  StepControl                               &control,
                  Announcer<dim>                            *announcer);

  /// Refuse stages of construction that do not fit the scene.
  template <int dim>
  void
  check_stages(const FiniteElement<dim> &fe,
               DoFHandler<dim>          &dof_handler,
               Scene<dim>               &scene);

  /// Refuse initial data that violate (2.12), and set the multipliers of those
  /// that do not.
  template <int dim>
  void
  check_compatibility(const Discretization<dim> &discretization,
                      State<dim>                &initial,
                      const Load<dim>           &load);

  /// Refuse a first step beyond the stability limit, before anything is
  /// written, and warn of later ones. Evaluates the rate of @p initial.
  template <int dim>
  void
  check_steps(const Discretization<dim> &discretization,
              const StepControl         &control,
              Console                   &console,
              EvaluatedState<dim>       &initial);

  /// Everything that can be known without solving: validates the scene with its
  /// mesh, initial data and the data of all times, and prints size, solver and
  /// what memory they need.
  template <int dim>
  void
  check_scene(const Parameters &parameters, Console &console);
} // namespace Viscoplastic
