// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters/parameters.h>

namespace Viscoplastic
{
  /**
   * The mesh of a scene before any adaptation: from a generator or a file, with
   * ids by expression, moved, checked and refined. Collective. Throws
   * ExcMessage with a sentence for the user.
   */
  template <int dim>
  void
  make_mesh(const GeometryParameters                  &geometry,
            parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
