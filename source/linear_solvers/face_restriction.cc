// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>

namespace Viscoplastic
{
  FaceRestriction::FaceRestriction(ContactLayout                        face,
                                   std::vector<types::global_dof_index> dofs,
                                   const IndexSet                      &owned)
    : contact_layout(std::move(face))
    , global_dofs(std::move(dofs))
  {
    const MPI_Comm communicator = contact_layout.communicator;
    AssertDimension(global_dofs.size(), contact_layout.n_dofs());
    for (const types::global_dof_index dof : global_dofs)
      owned_positions.push_back(owned.index_within_set(dof));
    numbers = Utilities::MPI::create_ascending_partitioning(
      communicator,
      global_dofs.size())[Utilities::MPI::this_mpi_process(communicator)];
  }



  Vector<double>
  FaceRestriction::gather(const DistributedVector &v) const
  {
    Vector<double> x(global_dofs.size());
    for (unsigned int k = 0; k < x.size(); ++k)
      x[k] = v.begin()[owned_positions[k]];
    return x;
  }



  void
  FaceRestriction::set(const Vector<double> &x, DistributedVector &v) const
  {
    for (unsigned int k = 0; k < x.size(); ++k)
      v.begin()[owned_positions[k]] = x[k];
  }



  void
  FaceRestriction::add(const double          factor,
                       const Vector<double> &x,
                       DistributedVector    &v) const
  {
    for (unsigned int k = 0; k < x.size(); ++k)
      v.begin()[owned_positions[k]] += factor * x[k];
  }



  void
  FaceRestriction::add_springs(const FaceTruncation    &truncation,
                               const DistributedVector &x,
                               DistributedVector       &y) const
  {
    for (unsigned int n = 0; n < contact_layout.n_nodes(); ++n)
      {
        const unsigned int *const position =
          &owned_positions[contact_layout.first_dof[n]];
        const unsigned int n_dofs = contact_layout.n_node_dofs(n);
        for (unsigned int i = 0; i < n_dofs; ++i)
          for (unsigned int j = 0; j < n_dofs; ++j)
            y.begin()[position[i]] +=
              truncation.spring[n][i][j] * x.begin()[position[j]];
      }
  }
} // namespace Viscoplastic
