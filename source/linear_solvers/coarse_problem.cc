// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <viscoplastic_contact/linear_solvers/coarse_problem.h>

namespace Viscoplastic
{
  namespace
  {
    /// What the ranks have, in the order of the ranks.
    template <typename T>
    std::vector<T>
    gather(const std::vector<T> &part, const MPI_Comm communicator)
    {
      std::vector<T> result;
      for (const auto &one : Utilities::MPI::all_gather(communicator, part))
        result.insert(result.end(), one.begin(), one.end());
      return result;
    }
  } // namespace



  template <int dim>
  CoarseProblem<dim>::CoarseProblem(const std::vector<Entry> &entries,
                                    const NodeHierarchy::Node n_nodes,
                                    const MPI_Comm            communicator)
    : n_nodes(n_nodes)
    , communicator(communicator)
    , matrix(gather(entries, communicator))
  {}



  template <int dim>
  void
  CoarseProblem<dim>::factorize(const std::vector<Mask> &owned_masks,
                                Factor                  &result) const
  {
    const std::vector<Mask> masks = gather(owned_masks, communicator);
    if (result.factor && result.masks == masks)
      return;
    result.masks = masks;
    std::vector<Tensor<2, dim>> free(n_nodes, identity<dim>()), spring(n_nodes);
    for (const Mask &mask : masks)
      {
        free[mask.node]   = mask.free;
        spring[mask.node] = mask.spring;
      }

    DynamicSparsityPattern pattern(n_unknowns());
    for (const Entry &entry : matrix)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          pattern.add(entry.row * dim + i, entry.column * dim + j);
    result.matrix.clear();
    result.pattern.copy_from(pattern);
    result.matrix.reinit(result.pattern);
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
  }



  template class CoarseProblem<2>;
  template class CoarseProblem<3>;
} // namespace Viscoplastic
