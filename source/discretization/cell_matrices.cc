// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/discretization/admissible_space.h>

#include <algorithm>

// The part of AdmissibleSpace that assembles matrices in frames.

namespace Viscoplastic
{
  template <int dim>
  void
  AdmissibleSpace<dim>::reinit(DistributedMatrix &matrix) const
  {
    DistributedMatrix::NodeLists         lists;
    std::vector<types::global_dof_index> dofs;
    FullMatrix<double>                   none;
    for (const auto &cell : cells)
      {
        get_dofs(cell, dofs);
        if (is_coupled(dofs))
          couple(dofs, none);
        for (std::size_t a = 0; a < dofs.size(); a += dim)
          if (const auto *parents =
                hanging_cartesian.get_constraint_entries(dofs[a]))
            for (const auto &parent : *parents)
              lists.nodes.push_back(parent.first / dim);
          else
            lists.nodes.push_back(dofs[a] / dim);
        lists.begin.push_back(lists.nodes.size());
        for (std::size_t a = 0; a < dofs.size(); a += dim)
          if (hanging_cartesian.is_constrained(dofs[a]))
            {
              lists.nodes.push_back(dofs[a] / dim);
              lists.begin.push_back(lists.nodes.size());
            }
      }
    matrix.reinit(owned, dim, std::move(lists), communicator);
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::add_cell_matrix(
    std::vector<types::global_dof_index> &dofs,
    FullMatrix<double>                   &cell_matrix,
    DistributedMatrix                    &matrix) const
  {
    if (is_coupled(dofs))
      couple(dofs, cell_matrix);
    resolve_hanging_nodes(dofs, cell_matrix);
    rotate(dofs, cell_matrix);
    matrix.add(dofs, cell_matrix);
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::resolve_hanging_nodes(
    std::vector<types::global_dof_index> &dofs,
    FullMatrix<double>                   &cell_matrix) const
  {
    struct Share
    {
      std::size_t hanging, parent;
      double      weight;
    };
    const std::size_t  n = dofs.size();
    std::vector<Share> shares;
    for (std::size_t a = 0; a < n; a += dim)
      if (const auto *parents =
            hanging_cartesian.get_constraint_entries(dofs[a]))
        for (const auto &[dof, weight] : *parents)
          {
            std::size_t p = 0;
            while (p < dofs.size() && dofs[p] != dof)
              p += dim;
            for (unsigned int d = 0; d < dim && dofs.size() <= p + d; ++d)
              dofs.push_back(dof + d);
            shares.push_back({a, p, weight});
          }
    if (shares.empty())
      return;
    const std::size_t  m = dofs.size();
    FullMatrix<double> resolved(m, m);
    for (std::size_t i = 0; i < n; ++i)
      std::copy_n(&cell_matrix(i, 0), n, &resolved(i, 0));
    for (const auto &[a, p, weight] : shares)
      for (std::size_t i = 0; i < n; ++i)
        for (unsigned int d = 0; d < dim; ++d)
          resolved(i, p + d) += weight * resolved(i, a + d);
    for (const auto &[a, p, weight] : shares)
      for (unsigned int d = 0; d < dim; ++d)
        for (std::size_t j = 0; j < m; ++j)
          resolved(p + d, j) += weight * resolved(a + d, j);
    for (const Share &share : shares)
      for (std::size_t i = share.hanging; i < share.hanging + dim; ++i)
        {
          for (std::size_t j = 0; j < m; ++j)
            resolved(i, j) = resolved(j, i) = 0.;
          resolved(i, i) = cell_matrix(i, i);
        }
    cell_matrix.swap(resolved);
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



  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, reinit);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, add_cell_matrix);
} // namespace Viscoplastic
