// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// A body with friction, and the bulk solvers for it.

#include "body.h"
#include <viscoplastic_contact/discretization/bulk_system.h>
#include <viscoplastic_contact/linear_solvers/algebraic_multigrid.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>
#include <viscoplastic_contact/linear_solvers/schur_solver.h>

#include <memory>
#include <string>
#include <vector>

namespace Viscoplastic::Testing
{
  /// A rotated box with friction on two adjacent sides: below, on a moving
  /// foundation with @p contact_law, and with given normal stress at x = 0;
  /// clamped at x = 2. It has 2n cells along x, refined @p n_levels times, and
  /// once more near a vertex of the face if @p refined.
  template <int dim>
  struct BulkScenario : Body<dim>
  {
    explicit BulkScenario(const unsigned int n,
                          const unsigned int n_levels,
                          const bool         refined     = false,
                          const std::string &contact_law = "bilateral")
      : Body<dim>(text(n, n_levels, contact_law))
    {
      if (refined)
        {
          const Point<dim> marked = this->triangulation.begin(0)->vertex(0);
          this->refine_where([&marked](const Point<dim> &x) {
            return (x - marked).norm() < 0.6;
          });
        }
      this->set_up();
      assemble_elastic_matrix(*this->space, *this->moduli, false, matrix);
      start = this->rough_unknowns(2.);
      start *= 0.05;
      this->space->set_prescribed(0.5, start);
      load = this->rough_unknowns(0.7);
      // Rows of the load at excluded components are not used.
      load.add(0.1, this->space->rigid_body_modes()[0]);
      load.add(1., this->loads->assemble(0.5).values);
    }

    static std::string
    text(const unsigned int n,
         const unsigned int n_levels,
         const std::string &contact_law)
    {
      std::string text =
        box<dim>(n,
                 oblique<dim>() +
                   "\nset Global refinements = " + std::to_string(n_levels)) +
        boundary(0,
                 "set Role = contact\nset Friction law = coulomb\n"
                 "set Friction coefficient = 0.3\nset Normal stress = -1") +
        boundary(1, "set Role = clamped") +
        boundary(2,
                 "set Role = contact\nset Contact law = " + contact_law +
                   "\nset Friction law = tresca\n"
                   "set Friction bound = 0.4\n"
                   "set Foundation displacement = -0.1*t") +
        boundary(3, "set Role = free");
      for (unsigned int id = 4; id < 2 * dim; ++id)
        text +=
          boundary(id, id == 4 ? "set Role = symmetry" : "set Role = free");
      return text;
    }

    std::unique_ptr<BulkSolver>
    direct() const
    {
      return std::make_unique<SchurSolver>(matrix,
                                           this->space->excluded(),
                                           this->face->restriction(),
                                           dim);
    }

    std::unique_ptr<BulkSolver>
    krylov(std::unique_ptr<Preconditioner> preconditioner) const
    {
      return std::make_unique<KrylovSolver>(matrix,
                                            this->space->excluded(),
                                            this->face->restriction(),
                                            std::move(preconditioner));
    }

    std::unique_ptr<BulkSolver>
    algebraic() const
    {
      return krylov(
        std::make_unique<AlgebraicMultigrid>(matrix,
                                             this->space->excluded(),
                                             this->space->rigid_body_modes(),
                                             this->face->restriction(),
                                             dim));
    }

    /// Geometric multigrid with all meshes as levels, however small. The first
    /// one may be left to smoothed aggregation.
    std::unique_ptr<BulkSolver>
    geometric(const bool has_algebraic_coarse_solver = false) const
    {
      typename GeometricMultigrid<dim>::Options options;
      options.coarse_size = 0;
      std::vector<DistributedVector> rigid_body_modes;
      if (has_algebraic_coarse_solver)
        rigid_body_modes = this->space->rigid_body_modes();
      return krylov(std::make_unique<GeometricMultigrid<dim>>(
        matrix,
        this->space->excluded(),
        make_node_hierarchy(*this->space),
        rigid_body_modes,
        this->face->restriction(),
        options));
    }

    /// The solvers that run on the present number of ranks.
    std::vector<std::unique_ptr<BulkSolver>>
    solvers() const
    {
      std::vector<std::unique_ptr<BulkSolver>> result;
      result.push_back(geometric());
      result.push_back(geometric(true));
      result.push_back(algebraic());
      if (Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
        result.push_back(direct());
      return result;
    }

    DistributedMatrix matrix;
    DistributedVector load, start;
  };
} // namespace Viscoplastic::Testing
