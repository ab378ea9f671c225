// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters/parameters.h>

namespace Viscoplastic
{
  /// Make the initial mesh of a scene: generate or read it, set ids, move,
  /// check and refine it. Collective. Throws ExcMessage with a sentence for the
  /// user.
  template <int dim>
  void
  make_mesh(const GeometryParameters                  &geometry,
            parallel::distributed::Triangulation<dim> &triangulation);

  /// Make the coarse mesh of `Geometry/Generator'. Collective. Throws
  /// ExcMessage with a sentence for the user, also where the mesh would be
  /// larger than any memory.
  template <int dim>
  void
  generate_mesh(const GeometryParameters                  &geometry,
                parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
