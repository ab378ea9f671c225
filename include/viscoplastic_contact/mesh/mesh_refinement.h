// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters/parameters.h>

namespace Viscoplastic
{
  /**
   * Refine the mesh as `Geometry/Global refinements' and `Boundary refinements'
   * say. Collective. Throws ExcMessage with a sentence for the user.
   */
  template <int dim>
  void
  refine_mesh(const GeometryParameters                  &geometry,
              parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
