// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/grid/tria.h>

#include <mpi.h>

#include <string>

namespace Viscoplastic
{
  /// Check that a mesh of @p n_cells cells in @p dim dimensions, refined from
  /// @p n_coarse_cells, is possible: its unknowns have to be numbered by 32
  /// bits, those of a rank's matrix entries, too, and the mesh has to fit the
  /// memory of the computers, the coarse cells once a rank. To be
  /// called before memory is taken, which would not end with an error but with
  /// all other programs of the computer. Collective. Throws ExcMessage with a
  /// sentence that begins with @p cause, e.g. an entry and its value.
  void
  check_mesh_size(const unsigned int dim,
                  const double       n_cells,
                  const double       n_coarse_cells,
                  const std::string &cause,
                  const MPI_Comm     communicator);

  /// The bytes that all coarse cells take on each of several ranks.
  double
  bytes_of_coarse_cells(const unsigned int dim, const double n_coarse_cells);


  /// The diagonal of the bounding box of the vertices of the coarse mesh.
  template <int dim>
  double
  body_diagonal(const dealii::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
