// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <viscoplastic_contact/linear_solvers/direct_coarse_solver.h>

namespace Viscoplastic
{
  namespace
  {
    /// Concatenate the parts of all ranks in their order. Collective.
    template <typename T>
    std::vector<T>
    gather(const std::vector<T> &part, const MPI_Comm communicator)
    {
      if (Utilities::MPI::n_mpi_processes(communicator) == 1)
        return part; // all_gather() would serialize it
      std::vector<T> result;
      for (const auto &one : Utilities::MPI::all_gather(communicator, part))
        result.insert(result.end(), one.begin(), one.end());
      return result;
    }
  } // namespace



  template <int dim>
  DirectCoarseSolver<dim>::DirectCoarseSolver(const BlockRows<dim>      &rows,
                                              const MultigridLevel<dim> &level,
                                              const MPI_Comm communicator)
    : level(level)
    , communicator(communicator)
    , n_nodes(level.x.size() / dim)
  {
    std::vector<Entry> entries;
    for (unsigned int i = 0; i < rows.n_rows(); ++i)
      for (std::size_t e = rows.begin[i]; e < rows.begin[i + 1]; ++e)
        entries.push_back(
          {level.global_number(i),
           level.global_number(level.local_number(rows.columns[e])),
           rows.values[e]});
    matrix = gather(entries, communicator);
    DynamicSparsityPattern entries_of_matrix(n_nodes * dim);
    for (const Entry &entry : matrix)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          entries_of_matrix.add(entry.row * dim + i, entry.column * dim + j);
    pattern.copy_from(entries_of_matrix);
  }



  template <int dim>
  bool
  DirectCoarseSolver<dim>::set_masks(const Masking            masking,
                                     const std::vector<Mask> &owned_masks,
                                     const bool /*may_rebuild*/)
  {
    Factor                 &result = factors[masking];
    const std::vector<Mask> masks  = gather(owned_masks, communicator);
    if (result.factor && result.masks == masks)
      return false;
    result.masks = masks;
    std::vector<Tensor<2, dim>> free(n_nodes, identity<dim>()), spring(n_nodes);
    for (const Mask &mask : masks)
      {
        free[mask.node]   = mask.free;
        spring[mask.node] = mask.spring;
      }

    result.matrix.reinit(pattern);
    for (const Entry &entry : matrix)
      {
        const Tensor<2, dim> block =
          entry.row == entry.column ?
            on_range(entry.block + spring[entry.row], free[entry.row]) :
            free[entry.row] * entry.block * free[entry.column];
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            result.matrix.set(entry.row * dim + i,
                              entry.column * dim + j,
                              block[i][j]);
      }
    result.factor = std::make_unique<SparseDirectUMFPACK>();
    result.factor->initialize(result.matrix);
    return true;
  }



  template <int dim>
  void
  DirectCoarseSolver<dim>::solve(const Masking masking,
                                 Vector       &x,
                                 const Vector &b) const
  {
    dealii::Vector<double> sum(n_nodes * dim);
    const auto             entry = [this](const unsigned int i) {
      return level.global_number(i / dim) * dim + i % dim;
    };
    for (unsigned int i = 0; i < b.locally_owned_size(); ++i)
      sum[entry(i)] = b.begin()[i];
    Utilities::MPI::sum(sum, communicator, sum);
    factors[masking].factor->solve(sum);
    for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
      x.begin()[i] = sum[entry(i)];
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(DirectCoarseSolver);
} // namespace Viscoplastic
