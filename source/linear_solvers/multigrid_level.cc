// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/multigrid_level.h>

#include <algorithm>
#include <numeric>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;
  } // namespace



  std::vector<std::vector<NodeHierarchy::Parent>>
  ask_owners(
    const std::vector<Node> &nodes,
    const std::vector<Node> &begins,
    const MPI_Comm           communicator,
    const std::function<std::vector<NodeHierarchy::Parent>(const Node)> &answer)
  {
    std::map<unsigned int, std::vector<Node>> questions;
    for (const Node node : nodes)
      questions[owner_of(node, begins)].push_back(node);
    std::map<unsigned int, std::vector<std::vector<NodeHierarchy::Parent>>>
      to_send;
    for (const auto &[rank, asked] :
         Utilities::MPI::some_to_some(communicator, questions))
      for (const Node node : asked)
        to_send[rank].push_back(answer(node));
    const auto received = Utilities::MPI::some_to_some(communicator, to_send);

    std::vector<std::vector<NodeHierarchy::Parent>> result;
    std::map<unsigned int, unsigned int>            next;
    for (const Node node : nodes)
      {
        const unsigned int rank = owner_of(node, begins);
        result.push_back(received.at(rank)[next[rank]++]);
      }
    return result;
  }



  template <int dim>
  MultigridLevel<dim>::MultigridLevel(const BlockRows<dim>    &matrix,
                                      const std::vector<Node> &nodes_,
                                      const std::vector<Node> &others,
                                      const std::vector<Node> &begins,
                                      const MPI_Comm           communicator)
    : nodes(nodes_)
    , ghosts(others)
    , begin(begins[Utilities::MPI::this_mpi_process(communicator)])
    , end(begins[Utilities::MPI::this_mpi_process(communicator) + 1])
    , n_owned(nodes.size())
    , is_serial(Utilities::MPI::n_mpi_processes(communicator) == 1)
  {
    if (!is_serial)
      {
        for (const Node node : matrix.columns)
          if (node < begin || node >= end)
            ghosts.push_back(node);
        std::sort(ghosts.begin(), ghosts.end());
        ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
      }

    // Nodes of this level are numbered rank by rank.
    const auto counts = Utilities::MPI::all_gather(communicator, n_owned);
    const Node first =
      std::accumulate(counts.begin(),
                      counts.begin() +
                        Utilities::MPI::this_mpi_process(communicator),
                      Node(0));
    const Node size = std::accumulate(counts.begin(), counts.end(), Node(0));
    IndexSet   owned_dofs(size * dim), ghost_dofs(size * dim);
    owned_dofs.add_range(first * dim, (first + n_owned) * dim);
    if (!is_serial)
      for (const auto &answer :
           ask_owners(ghosts, begins, communicator, [&](const Node node) {
             return std::vector<NodeHierarchy::Parent>{
               {first + local_number(node), 1.}};
           }))
        ghost_dofs.add_range(answer[0].node * dim, (answer[0].node + 1) * dim);
    partitioner =
      std::make_shared<const Utilities::MPI::Partitioner>(owned_dofs,
                                                          ghost_dofs,
                                                          communicator);
    x.reinit(partitioner);
    b.reinit(partitioner);
    r.reinit(partitioner);

    set_values(matrix);
  }



  template <int dim>
  unsigned int
  MultigridLevel<dim>::local_number(const Node node) const
  {
    const bool  is_owned = node >= begin && node < end;
    const auto &where    = is_owned ? nodes : ghosts;
    const auto  entry    = std::lower_bound(where.begin(), where.end(), node);
    Assert(entry != where.end() && *entry == node, ExcInternalError());
    return (entry - where.begin()) + (is_owned ? 0 : n_owned);
  }



  template <int dim>
  std::vector<unsigned int>
  MultigridLevel<dim>::local_numbers(const std::vector<Node> &asked) const
  {
    // A table is faster than a search for each node.
    std::vector<unsigned int> number_of_owned(end - begin);
    for (unsigned int i = 0; i < n_owned; ++i)
      number_of_owned[nodes[i] - begin] = i;
    std::vector<unsigned int> result;
    result.reserve(asked.size());
    for (const Node node : asked)
      result.push_back(node >= begin && node < end ?
                         number_of_owned[node - begin] :
                         local_number(node));
    return result;
  }



  template <int dim>
  void
  MultigridLevel<dim>::set_values(const BlockRows<dim> &matrix)
  {
    rows.set_values(matrix, local_numbers(matrix.columns));
  }



  template <int dim>
  void
  MultigridLevel<dim>::set_interpolation(const Interpolation &interpolation,
                                         const MultigridLevel<dim> &coarser)
  {
    parent_begin.assign(interpolation.begin.begin(),
                        interpolation.begin.begin() + n_owned + 1);
    weights.clear();
    weights.reserve(parent_begin.back());
    std::vector<Node> nodes_of_parents;
    nodes_of_parents.reserve(parent_begin.back());
    for (std::size_t e = 0; e < parent_begin.back(); ++e)
      {
        nodes_of_parents.push_back(interpolation.parents[e].node);
        weights.push_back(interpolation.parents[e].weight);
      }
    parents = coarser.local_numbers(nodes_of_parents);
  }



  template <int dim>
  NodeBlock<dim>
  MultigridLevel<dim>::smoothing_block(const unsigned int node) const
  {
    // Adding half the absolute row sums of couplings between ranks,
    // Gauss-Seidel without waiting converges as with it (Baker, Falgout, Kolev,
    // Yang, SISC 33, 2011).
    auto [block, sums_of_others] = rows.diagonal_block(node);
    for (unsigned int d = 0; d < dim; ++d)
      block[d][d] += 0.5 * sums_of_others[d];
    return block;
  }



  template <int dim>
  void
  MultigridLevel<dim>::smooth_forward_from_zero(Vector       &x,
                                                const Vector &b) const
  {
    rows.smooth_forward_from_zero(x.begin(), b.begin());
  }



  template <int dim>
  void
  MultigridLevel<dim>::smooth_backward(Vector &x, const Vector &b) const
  {
    if (!is_serial)
      x.update_ghost_values();
    rows.smooth_backward(x.begin(), b.begin());
    if (!is_serial)
      x.zero_out_ghost_values();
  }



  template <int dim>
  void
  MultigridLevel<dim>::residual(Vector &r, Vector &x, const Vector &b) const
  {
    if (!is_serial)
      x.update_ghost_values();
    rows.residual(r.begin(), x.begin(), b.begin());
    if (!is_serial)
      x.zero_out_ghost_values();
  }



  template <int dim>
  void
  MultigridLevel<dim>::restrict_to_coarse(Vector       &coarse,
                                          const Vector &fine) const
  {
    coarse                    = 0.f;
    const float *const f      = fine.begin();
    float *const       target = coarse.begin();
    for (unsigned int i = 0; i < n_owned; ++i)
      for_each_parent(i, [&](const unsigned int parent, const float weight) {
        for (unsigned int d = 0; d < dim; ++d)
          target[parent * dim + d] += weight * f[i * dim + d];
      });
    if (!is_serial)
      coarse.compress(VectorOperation::add);
  }



  template <int dim>
  void
  MultigridLevel<dim>::interpolate(Vector &fine, Vector &coarse) const
  {
    if (!is_serial)
      coarse.update_ghost_values();
    const float *const source = coarse.begin();
    float *const       f      = fine.begin();
    for (unsigned int i = 0; i < n_owned; ++i)
      {
        float value[dim] = {};
        for_each_parent(i, [&](const unsigned int parent, const float weight) {
          for (unsigned int d = 0; d < dim; ++d)
            value[d] += weight * source[parent * dim + d];
        });
        for (unsigned int d = 0; d < dim; ++d)
          f[i * dim + d] = value[d];
      }
    if (!is_serial)
      coarse.zero_out_ghost_values();
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(MultigridLevel);
} // namespace Viscoplastic
