// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/bulk_solver.h>
#include <viscoplastic_contact/krylov_solver.h>
#include <viscoplastic_contact/schur_solver.h>

namespace Viscoplastic
{
  namespace
  {
    /**
     * Whether the direct solver is expected to win. A factorisation costs about
     * ten (2D) to eighty (3D) of its own solves and, in 3D, much memory;
     * multigrid is cheap to set up and needs no memory to speak of, but dies of
     * incompressibility.
     */
    bool
    prefer_direct(const unsigned int            dim,
                  const types::global_dof_index n_dofs,
                  const unsigned int            n_face_dofs,
                  const double                  max_poissons_ratio,
                  const unsigned int            n_solves)
    {
      // The dense face problem: 200 MB and a cubic set-up.
      if (n_face_dofs > 5000)
        return false;
      if (dim == 2)
        return n_dofs < 2000000;
      if (max_poissons_ratio > 0.45)
        return n_dofs < 200000;
      return n_dofs < 20000 || (n_dofs < 150000 && n_solves >= 20);
    }
  } // namespace



  template <int dim>
  bool
  is_direct(const AdmissibleSpace<dim> &space,
            const unsigned int          n_face_dofs,
            const std::string          &choice,
            const double                max_poissons_ratio,
            const unsigned int          n_solves)
  {
    const unsigned int n_ranks =
      Utilities::MPI::n_mpi_processes(space.communicator);
    AssertThrow(choice != "direct" || n_ranks == 1,
                ExcMessage("'Solver/Linear solver' = direct works on one MPI "
                           "rank, but the run has " +
                           std::to_string(n_ranks) +
                           "; use multigrid or automatic."));
    AssertThrow(choice == "automatic" || choice == "direct" ||
                  choice == "multigrid",
                ExcMessage("'Solver/Linear solver' = " + choice +
                           " is unknown; it must be automatic, direct or "
                           "multigrid."));
    return choice == "direct" || (choice == "automatic" && n_ranks == 1 &&
                                  prefer_direct(dim,
                                                space.dof_handler.n_dofs(),
                                                n_face_dofs,
                                                max_poissons_ratio,
                                                n_solves));
  }



  template <int dim>
  std::unique_ptr<BulkSolver>
  make_bulk_solver(const AdmissibleSpace<dim>                 &space,
                   const DistributedMatrix                    &matrix,
                   const FrictionFace                         &face,
                   const std::vector<types::global_dof_index> &face_dofs,
                   const std::string                          &choice,
                   const double       max_poissons_ratio,
                   const unsigned int n_solves)
  {
    if (is_direct(space, face.n_dofs(), choice, max_poissons_ratio, n_solves))
      return std::make_unique<SchurSolver>(
        matrix, space.excluded(), face, face_dofs, dim);
    return std::make_unique<KrylovSolver>(
      matrix, space.excluded(), space.rigid_body_modes(), face, face_dofs, dim);
  }



  template bool
  is_direct<2>(const AdmissibleSpace<2> &,
               const unsigned int,
               const std::string &,
               const double,
               const unsigned int);
  template bool
  is_direct<3>(const AdmissibleSpace<3> &,
               const unsigned int,
               const std::string &,
               const double,
               const unsigned int);
  template std::unique_ptr<BulkSolver>
  make_bulk_solver<2>(const AdmissibleSpace<2> &,
                      const DistributedMatrix &,
                      const FrictionFace &,
                      const std::vector<types::global_dof_index> &,
                      const std::string &,
                      const double,
                      const unsigned int);
  template std::unique_ptr<BulkSolver>
  make_bulk_solver<3>(const AdmissibleSpace<3> &,
                      const DistributedMatrix &,
                      const FrictionFace &,
                      const std::vector<types::global_dof_index> &,
                      const std::string &,
                      const double,
                      const unsigned int);
} // namespace Viscoplastic
