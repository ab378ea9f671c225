// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/bounding_box.h>
#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/mesh_size.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// Return the memory of this computer in bytes, or the limit of the process
    /// if that is less.
    double
    physical_memory()
    {
      double       bytes = std::numeric_limits<double>::infinity();
      const double pages = sysconf(_SC_PHYS_PAGES);
      if (pages > 0.)
        bytes = pages * sysconf(_SC_PAGESIZE);
      rlimit limit;
      if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        bytes = std::min(bytes, static_cast<double>(limit.rlim_cur));
      return bytes;
    }



    unsigned int
    n_ranks_on_this_computer(const MPI_Comm communicator)
    {
      MPI_Comm computer;
      AssertThrowMPI(MPI_Comm_split_type(
        communicator, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &computer));
      const unsigned int n = Utilities::MPI::n_mpi_processes(computer);
      AssertThrowMPI(MPI_Comm_free(&computer));
      return n;
    }
  } // namespace



  double
  bytes_of_coarse_cells(const unsigned int dim, const double n_coarse_cells)
  {
    // Measured with 10^5 cells from a file, on 1 to 4 ranks.
    return (dim == 2 ? 650. : 1600.) * n_coarse_cells;
  }



  void
  check_mesh_size(const unsigned int dim,
                  const double       n_cells,
                  const double       n_coarse_cells,
                  const std::string &cause,
                  const MPI_Comm     communicator)
  {
    // There are about as many nodes as cells. Trilinos numbers unknowns and the
    // matrix entries of a rank by signed 32-bit integers.
    constexpr double   most       = std::numeric_limits<int>::max();
    const double       n_unknowns = dim * n_cells;
    const double       n_entries  = n_unknowns * (dim == 2 ? 18. : 81.);
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(communicator);

    std::ostringstream message;
    message << cause << " would make about " << n_cells << " cells and "
            << n_unknowns << " unknowns, ";
    if (n_unknowns > most)
      refuse(message.str() + "more than can be numbered (" +
             std::to_string(std::numeric_limits<int>::max()) + ").");
    if (n_entries / n_ranks > most)
      refuse(
        message.str() + "which is too much for " +
        (n_ranks == 1 ? "one MPI rank" :
                        std::to_string(n_ranks) + " MPI ranks") +
        ", whose matrix would have more entries than can be numbered; take at "
        "least " +
        std::to_string(static_cast<unsigned int>(std::ceil(n_entries / most))) +
        ".");

    // Measured: mesh and spaces take 760 (2D) and 1280 bytes (3D) a cell. The
    // solver takes several times as much: only runs that must fail are refused.
    const unsigned int n_here = n_ranks_on_this_computer(communicator);
    const double       n_coarse_bytes =
      n_ranks > 1 ? n_here * bytes_of_coarse_cells(dim, n_coarse_cells) : 0.;
    const double n_bytes =
      n_coarse_bytes + n_cells / n_ranks * n_here * (dim == 2 ? 760. : 1280.);
    const double n_possible = physical_memory();
    message << "whose mesh alone takes " << std::ceil(n_bytes / 1e9)
            << " GB of memory, and there are "
            << std::floor(n_possible / 1e8) / 10.;
    if (n_coarse_bytes > 0.5 * n_bytes)
      message << " GB. Most of it are the " << n_coarse_cells
              << " coarse cells, which each rank keeps: begin with fewer and "
                 "refine them ('Geometry/Global refinements'), or take fewer "
                 "ranks on a computer.";
    else
      message << " GB; --check says what a mesh needs.";
    // Memory may differ between computers, but all ranks have to throw.
    if (Utilities::MPI::logical_or(n_bytes > n_possible, communicator))
      refuse(message.str());
  }



  template <int dim>
  double
  body_diagonal(const Triangulation<dim> &triangulation)
  {
    std::vector<Point<dim>> points;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      for (const unsigned int v : cell->vertex_indices())
        points.push_back(cell->vertex(v));
    const auto corners = BoundingBox<dim>(points).get_boundary_points();
    return corners.first.distance(corners.second);
  }



  VISCOPLASTIC_INSTANTIATE(body_diagonal);
} // namespace Viscoplastic
