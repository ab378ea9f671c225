// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/grid/tria.h>

#include <mpi.h>

#include <string>

namespace Viscoplastic
{
  /// Check that a mesh of @p n_cells cells in @p dim dimensions, refined from
  /// @p n_coarse_cells, is possible: unknowns and the matrix entries of a rank
  /// have to be numbered by 32 bits, and the mesh has to fit into memory, with
  /// all coarse cells on each rank. To be called before memory is allocated,
  /// since running out of it may end other programs without an error here.
  /// Throws ExcMessage with a sentence that begins with @p cause, e.g. an entry
  /// and its value. Collective.
  void
  check_mesh_size(const unsigned int dim,
                  const double       n_cells,
                  const double       n_coarse_cells,
                  const std::string &cause,
                  const MPI_Comm     communicator);

  /// Return the bytes that all coarse cells take on each rank of several.
  double
  bytes_of_coarse_cells(const unsigned int dim, const double n_coarse_cells);


  /// Return the diagonal of the bounding box of the coarse mesh, which all
  /// ranks know.
  template <int dim>
  double
  body_diagonal(const dealii::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
