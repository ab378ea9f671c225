// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/scene/scene.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Hold what a scene records against its mesh: points and lines have to be in
  /// the body, boundaries, materials and fields to exist. Returns what is
  /// allowed but means nothing, a sentence each. Collective. Throws ExcMessage.
  template <int dim>
  std::vector<std::string>
  check_output_places(
    const Scene<dim>                                &scene,
    const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
