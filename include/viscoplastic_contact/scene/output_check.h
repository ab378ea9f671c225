// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/scene/scene.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Check the output places of a scene against its mesh: points and lines lie
  /// in the body; boundaries, materials and fields exist. Returns warnings, a
  /// sentence each. Throws ExcMessage. Collective.
  template <int dim>
  std::vector<std::string>
  check_output_places(
    const Scene<dim>                                &scene,
    const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
