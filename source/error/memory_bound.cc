// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/memory_bound.h>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// Memory of the program on each rank, mostly of its libraries, and of
    /// mesh, spaces and states per unknown. Measured, see doc/solvers.md.
    constexpr double bytes_of_rank = 0.19e9, bytes_of_unknown = 700.;
  } // namespace



  template <int dim>
  unsigned int
  cells_in_memory(const Discretization<dim> &present, const double bytes)
  {
    const SolverDemand demand = present.solver_demand();
    const double       n_cells =
      present.space.dof_handler.get_triangulation().n_global_active_cells();
    const auto fits = [&](const double factor) {
      SolverDemand finer = demand;
      finer.n_dofs       = std::llround(factor * demand.n_dofs);
      finer.n_face_dofs =
        std::llround(std::pow(factor, (dim - 1.) / dim) * demand.n_face_dofs);
      return bytes_of_rank * demand.n_ranks + bytes_of_unknown * finer.n_dofs +
               expected_memory(choose_bulk_solver(finer), finer) <=
             bytes;
    };
    // The demand may drop where another solver takes over; the search stops at
    // the first size that does not fit.
    double factor = 1. / n_cells;
    while (fits(1.05 * factor) &&
           1.05 * factor * n_cells < std::numeric_limits<int>::max())
      factor *= 1.05;
    return static_cast<unsigned int>(factor * n_cells);
  }



  VISCOPLASTIC_INSTANTIATE(cells_in_memory);
} // namespace Viscoplastic
