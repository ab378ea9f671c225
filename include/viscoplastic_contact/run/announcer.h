// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/scene/data_in_time.h>

namespace Viscoplastic
{
  // Tell the user what is simulated, with warnings, of which the console prints
  // each once.

  /// The effects of a scene.
  template <int dim>
  void
  announce_scene(const Scene<dim> &scene, Console &console);

  /// The kinks and jumps of data at which steps will end.
  void
  announce_kinks(const KinksOfScene &found, Console &console);

  /// How far the body has moved into equilibrium at t = 0.
  template <int dim>
  void
  announce_equilibrium(const Scene<dim> &scene,
                       const State<dim> &initial,
                       Console          &console);

  /// The stage of construction that begins.
  template <int dim>
  void
  announce_stage(const Scene<dim> &scene, Console &console);

  /// The size of the first mesh, advice on the number of ranks, from a model of
  /// their speed-up and memory, and a warning of contradictory prescribed
  /// displacements. Collective.
  template <int dim>
  void
  announce_first_mesh(const Discretization<dim> &discretization,
                      Console                   &console);

  /// Name contact boundaries of whose nodes other conditions hold all.
  /// Collective.
  template <int dim>
  void
  warn_of_held_faces(const Discretization<dim> &discretization,
                     Console                   &console);
} // namespace Viscoplastic
