// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <viscoplastic_contact/linear_solvers/algebraic_coarse_solver.h>

#include <algorithm>

namespace Viscoplastic
{
  namespace
  {
    /// The part of the masks that may change before a cycle is rebuilt.
    constexpr double outdated_part = 0.1;
  } // namespace



  template <int dim>
  AlgebraicCoarseSolver<dim>::AlgebraicCoarseSolver(
    const BlockRows<dim>      &rows,
    const MultigridLevel<dim> &level,
    const std::vector<double> &rigid_body_modes,
    const MPI_Comm             communicator)
    : rows(rows)
    , level(level)
    , rigid_body_modes(rigid_body_modes)
    , communicator(communicator)
    , source(level.x.locally_owned_elements(), communicator)
    , solution(source)
  {}



  template <int dim>
  bool
  AlgebraicCoarseSolver<dim>::set_masks(const Masking            masking,
                                        const std::vector<Mask> &masks,
                                        const bool               may_rebuild)
  {
    Cycle &cycle = cycles[masking];
    if (cycle.aggregation)
      {
        if (!may_rebuild)
          return false;
        std::vector<unsigned int> numbers{0, 0}; // of changes, of masks
        numbers[1] = masks.size();
        for (unsigned int i = 0; i < masks.size(); ++i)
          numbers[0] +=
            (masks[i].free - cycle.built_for[i].free).norm() > 1e-6 ? 1 : 0;
        Utilities::MPI::sum(numbers, communicator, numbers);
        if (numbers[0] <= outdated_part * numbers[1])
          return false;
      }
    const Cycle &other = cycles[masking == LevelMasks<dim>::truncated ?
                                  LevelMasks<dim>::untruncated :
                                  LevelMasks<dim>::truncated];
    const bool   has_other =
      other.aggregation != nullptr &&
      Utilities::MPI::min(masks == other.built_for ? 1 : 0, communicator) == 1;
    if (has_other)
      cycle = other;
    else
      build(masks, cycle);
    return true;
  }



  template <int dim>
  void
  AlgebraicCoarseSolver<dim>::build(const std::vector<Mask> &masks,
                                    Cycle                   &cycle) const
  {
    cycle.aggregation.reset();
    cycle.built_for = masks;

    // Projectors are needed at ghost nodes, too, with which owned rows couple.
    const unsigned int n_owned = rows.n_rows();
    const auto        &where   = level.x.get_partitioner();
    const unsigned int n_nodes =
      n_owned + where->n_ghost_indices() / dim; // with ghosts
    std::vector<Tensor<2, dim>> free(n_nodes, identity<dim>()), spring(n_owned);
    for (const Mask &mask : masks)
      {
        const unsigned int i = where->global_to_local(mask.node * dim) / dim;
        free[i]              = mask.free;
        spring[i]            = mask.spring;
      }
    LinearAlgebra::distributed::Vector<double> column(where);
    for (unsigned int d = 0; d < dim; ++d)
      {
        for (unsigned int i = 0; i < n_owned; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            column.local_element(i * dim + c) = free[i][c][d];
        column.update_ghost_values();
        for (unsigned int i = n_owned; i < n_nodes; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            free[i][c][d] = column.local_element(i * dim + c);
        column.zero_out_ghost_values();
      }

    const IndexSet        &owned = where->locally_owned_range();
    DynamicSparsityPattern pattern(owned.size(), owned.size(), owned);
    std::vector<types::global_dof_index> columns;
    const auto columns_of_row = [&](const unsigned int i) {
      columns.clear();
      for (std::size_t e = rows.begin[i]; e < rows.begin[i + 1]; ++e)
        for (unsigned int d = 0; d < dim; ++d)
          columns.push_back(
            level.global_number(level.local_number(rows.columns[e])) * dim + d);
    };
    for (unsigned int i = 0; i < n_owned; ++i)
      {
        columns_of_row(i);
        for (unsigned int c = 0; c < dim; ++c)
          pattern.add_entries(level.global_number(i) * dim + c,
                              columns.begin(),
                              columns.end());
      }
    auto matrix = std::make_unique<TrilinosWrappers::SparseMatrix>();
    matrix->reinit(owned, pattern, communicator);
    std::vector<double> values;
    for (unsigned int i = 0; i < n_owned; ++i)
      {
        columns_of_row(i);
        for (unsigned int c = 0; c < dim; ++c)
          {
            values.clear();
            for (std::size_t e = rows.begin[i]; e < rows.begin[i + 1]; ++e)
              {
                const unsigned int   j = level.local_number(rows.columns[e]);
                const Tensor<2, dim> block =
                  i == j ? on_range(rows.values[e] + spring[i], free[i]) :
                           free[i] * rows.values[e] * free[j];
                for (unsigned int d = 0; d < dim; ++d)
                  values.push_back(block[c][d]);
              }
            matrix->set(level.global_number(i) * dim + c, columns, values);
          }
      }
    matrix->compress(VectorOperation::insert);

    std::vector<double> near_null_space = rigid_body_modes;
    for (std::size_t k = 0; k < near_null_space.size(); k += dim)
      multiply(free[(k / dim) % n_owned], near_null_space.data() + k);
    cycle.aggregation =
      std::make_shared<SmoothedAggregation>(std::move(matrix),
                                            std::move(near_null_space),
                                            dim);
  }



  template <int dim>
  void
  AlgebraicCoarseSolver<dim>::solve(const Masking masking,
                                    Vector       &x,
                                    const Vector &b) const
  {
    std::copy(b.begin(), b.end(), source.begin());
    cycles[masking].aggregation->vmult(solution, source);
    std::copy(solution.begin(), solution.end(), x.begin());
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(AlgebraicCoarseSolver);
} // namespace Viscoplastic
