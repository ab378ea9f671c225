// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters/parameters.h>

#include <set>

namespace Viscoplastic
{
  /// Give the coarse mesh the ids of the expressions `Geometry/Boundary ids'
  /// and `Geometry/Material ids', if there are any. Throws ExcMessage with a
  /// sentence for the user.
  template <int dim>
  void
  set_ids(const GeometryParameters                  &geometry,
          parallel::distributed::Triangulation<dim> &triangulation);

  /// Return the boundary ids of the coarse mesh, which all ranks know.
  template <int dim>
  std::set<types::boundary_id>
  boundary_ids(const parallel::distributed::Triangulation<dim> &triangulation);

  /// Return the material ids of the coarse mesh, which all ranks know.
  template <int dim>
  std::set<types::material_id>
  material_ids(const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
