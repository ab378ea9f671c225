// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/discretization/admissible_space.h>

#include <algorithm>

// The part of AdmissibleSpace that assembles matrices in frames.

namespace Viscoplastic
{
  template <int dim>
  void
  AdmissibleSpace<dim>::make_sparsity_pattern(
    TrilinosWrappers::SparsityPattern &pattern) const
  {
    pattern.reinit(owned, owned, relevant, communicator);
    // Node by node, as the degrees of freedom of one couple with the same ones:
    // each row is entered once.
    using Dofs = std::vector<types::global_dof_index>;
    Dofs              dofs, columns;
    std::vector<Dofs> nodes_beside(relevant.n_elements() / dim);
    for (const auto &cell : cells)
      {
        dofs.clear();
        for (const unsigned int v : cell->vertex_indices())
          {
            const auto first = cell->vertex_dof_index(v, 0);
            if (!hanging_cartesian.is_constrained(first))
              dofs.push_back(first);
            else
              for (const auto &parent :
                   *hanging_cartesian.get_constraint_entries(first))
                dofs.push_back(parent.first);
            if (hanging_cartesian.is_constrained(first))
              for (unsigned int d = 0; d < dim; ++d)
                pattern.add(first + d, first + d);
          }
        for (const auto dof : dofs)
          {
            Dofs &beside = nodes_beside[relevant.index_within_set(dof) / dim];
            beside.insert(beside.end(), dofs.begin(), dofs.end());
          }
      }
    for (std::size_t n = 0; n < nodes_beside.size(); ++n)
      {
        Dofs &beside = nodes_beside[n];
        std::sort(beside.begin(), beside.end());
        beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
        columns.clear();
        for (const auto first : beside)
          for (unsigned int d = 0; d < dim; ++d)
            columns.push_back(first + d);
        for (unsigned int d = 0; d < dim && !columns.empty(); ++d)
          pattern.add_entries(relevant.nth_index_in_set(n * dim + d),
                              columns.begin(),
                              columns.end(),
                              /* indices_are_sorted = */ true);
      }
    if (axial)
      {
        const auto n = dof_handler.n_dofs();
        Dofs       others;
        for (const auto dof : relevant)
          if (dof < n && !hanging_in_frames.is_constrained(dof))
            {
              pattern.add(dof, n);
              others.push_back(dof);
            }
        pattern.add_entries(n, others.begin(), others.end());
        for (unsigned int d = 0; d < dim; ++d)
          pattern.add(n + d, n + d);
      }
    if (!couplings.empty())
      {
        FullMatrix<double> none;
        for (const auto &cell : cells)
          {
            dofs.resize(dof_handler.get_fe().n_dofs_per_cell());
            cell->get_dof_indices(dofs);
            if (!is_coupled(dofs))
              continue;
            couple(dofs, none);
            hanging_in_frames.add_entries_local_to_global(dofs, pattern, false);
          }
      }
    pattern.compress();
  }



  namespace
  {
    /// Add a cell matrix without constraints to rows of this rank, where it is
    /// much faster to find entries than by global numbers. Returns false, and
    /// adds nothing, unless all rows are such.
    bool
    add_to_own_rows(const AffineConstraints<double>            &constraints,
                    const std::vector<types::global_dof_index> &dofs,
                    const FullMatrix<double>                   &cell_matrix,
                    DistributedMatrix                          &matrix)
    {
      const Epetra_CrsMatrix &crs = matrix.trilinos_matrix();
      std::vector<int>        columns(dofs.size());
      for (unsigned int j = 0; j < dofs.size(); ++j)
        {
          const int dof = dofs[j];
          if (constraints.is_constrained(dof) || !crs.MyGRID(dof))
            return false;
          columns[j] = crs.LCID(dof);
        }
      for (unsigned int i = 0; i < dofs.size(); ++i)
        {
          const int row = crs.LRID(static_cast<int>(dofs[i]));
          int       length, *indices;
          double   *values;
          crs.ExtractMyRowView(row, length, values, indices);
          int at = -1;
          for (unsigned int j = 0; j < dofs.size(); ++j)
            {
              // Components of a node are neighbors.
              if (++at >= length || indices[at] != columns[j])
                at = std::find(indices, indices + length, columns[j]) - indices;
              if (at < length) // else it is zero
                values[at] += cell_matrix(i, j);
            }
        }
      return true;
    }
  } // namespace



  template <int dim>
  void
  AdmissibleSpace<dim>::add_cell_matrix(
    const std::vector<types::global_dof_index> &dofs,
    FullMatrix<double>                         &cell_matrix,
    DistributedMatrix                          &matrix) const
  {
    if (!is_coupled(dofs))
      {
        rotate(dofs, cell_matrix);
        if (!add_to_own_rows(hanging_in_frames, dofs, cell_matrix, matrix))
          hanging_in_frames.distribute_local_to_global(cell_matrix,
                                                       dofs,
                                                       matrix);
        return;
      }
    std::vector<types::global_dof_index> all(dofs);
    FullMatrix<double>                   coupled(cell_matrix);
    couple(all, coupled);
    rotate(all, coupled);
    hanging_in_frames.distribute_local_to_global(coupled, all, matrix);
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::rotate(const std::vector<types::global_dof_index> &dofs,
                               FullMatrix<double> &cell_matrix) const
  {
    if (rotated_nodes.empty())
      return;
    const unsigned int n = dofs.size();
    // Cell degrees of freedom come node by node for FE_Q(1).
    for (unsigned int a = 0; a < n; a += dim)
      {
        if (hanging_cartesian.is_constrained(dofs[a]))
          continue;
        const NodalFrame<dim> &frame =
          frames[frame_of_node[relevant.index_within_set(dofs[a]) / dim]];
        if (frame.is_cartesian)
          continue;
        const Tensor<2, dim> &R = frame.directions;
        for (unsigned int j = 0; j < n; ++j)
          {
            Tensor<1, dim> block;
            for (unsigned int d = 0; d < dim; ++d)
              block[d] = cell_matrix(a + d, j);
            block = transpose(R) * block;
            for (unsigned int d = 0; d < dim; ++d)
              cell_matrix(a + d, j) = block[d];
          }
        for (unsigned int i = 0; i < n; ++i)
          {
            Tensor<1, dim> block;
            for (unsigned int d = 0; d < dim; ++d)
              block[d] = cell_matrix(i, a + d);
            block = block * R;
            for (unsigned int d = 0; d < dim; ++d)
              cell_matrix(i, a + d) = block[d];
          }
      }
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, make_sparsity_pattern);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, add_cell_matrix);
} // namespace Viscoplastic
