// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/distributed_matrix.h>

#include <boost/serialization/utility.hpp>

#include <algorithm>

// Which blocks a matrix has, on which ranks.

namespace Viscoplastic
{
  namespace
  {
    using Node      = DistributedMatrix::Node;
    using NodeLists = DistributedMatrix::NodeLists;



    /// Append to @p lists those of other ranks that contain nodes of this rank;
    /// @p begins are the first nodes of all ranks, and the end. Collective.
    void
    add_lists_of_others(NodeLists               &lists,
                        const std::vector<Node> &begins,
                        const MPI_Comm           communicator)
    {
      const unsigned int me = Utilities::MPI::this_mpi_process(communicator);
      std::map<unsigned int, std::vector<Node>> to_send; // length, then nodes
      std::vector<unsigned int>                 ranks;
      for (std::size_t l = 0; l + 1 < lists.begin.size(); ++l)
        {
          const auto begin = lists.nodes.begin() + lists.begin[l],
                     end   = lists.nodes.begin() + lists.begin[l + 1];
          ranks.clear();
          for (auto node = begin; node != end; ++node)
            ranks.push_back(
              std::upper_bound(begins.begin(), begins.end(), *node) -
              begins.begin() - 1);
          std::sort(ranks.begin(), ranks.end());
          ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
          for (const unsigned int rank : ranks)
            if (rank != me)
              {
                to_send[rank].push_back(end - begin);
                to_send[rank].insert(to_send[rank].end(), begin, end);
              }
        }
      for (const auto &message :
           Utilities::MPI::some_to_some(communicator, to_send))
        for (auto at = message.second.begin(); at != message.second.end();)
          {
            const auto end = at + 1 + *at;
            lists.nodes.insert(lists.nodes.end(), at + 1, end);
            lists.begin.push_back(lists.nodes.size());
            at = end;
          }
    }
  } // namespace



  unsigned int
  DistributedMatrix::Pattern::local_number(const Node node) const
  {
    if (node >= first && node < first + n_owned)
      return node - first;
    const auto ghost = std::lower_bound(ghosts.begin(), ghosts.end(), node);
    Assert(ghost != ghosts.end() && *ghost == node, ExcInternalError());
    return n_owned + (ghost - ghosts.begin());
  }



  bool
  DistributedMatrix::Pattern::has(const unsigned int row,
                                  const unsigned int column) const
  {
    // Of two nodes of the same rank, the row of the first stores the block.
    if (row < n_owned)
      return column >= row;
    return column < n_owned || column >= row ||
           owner_of_ghost[row - n_owned] != owner_of_ghost[column - n_owned];
  }



  std::size_t
  DistributedMatrix::Pattern::find(const unsigned int row,
                                   const unsigned int column) const
  {
    const auto row_begin = columns.begin() + begin[row],
               row_end   = columns.begin() + begin[row + 1],
               entry     = std::lower_bound(row_begin, row_end, column);
    return entry != row_end && *entry == column ? entry - columns.begin() :
                                                  no_entry;
  }



  void
  DistributedMatrix::Pattern::add_rows(const NodeLists  &lists,
                                       const std::size_t n_own_lists)
  {
    const std::size_t         n_lists = lists.begin.size() - 1;
    const unsigned int        n_nodes = n_owned + ghosts.size();
    std::vector<unsigned int> numbers;
    numbers.reserve(lists.nodes.size());
    for (const Node node : lists.nodes)
      numbers.push_back(local_number(node));
    // The lists that contain each node, in compressed storage.
    std::vector<std::size_t> first_list(n_nodes + 1, 0);
    for (const unsigned int n : numbers)
      ++first_list[n + 1];
    for (unsigned int n = 0; n < n_nodes; ++n)
      first_list[n + 1] += first_list[n];
    std::vector<unsigned int> lists_of_nodes(numbers.size());
    std::vector<std::size_t>  next(first_list.begin(), first_list.end() - 1);
    for (std::size_t l = 0; l < n_lists; ++l)
      for (std::size_t k = lists.begin[l]; k < lists.begin[l + 1]; ++k)
        lists_of_nodes[next[numbers[k]]++] = l;

    // This is usually more than needed; unused pages take no memory.
    columns.reserve(n_nodes * (dim == 2 ? 8ULL : 24ULL));
    begin.reserve(n_nodes + 1);
    std::vector<unsigned int> seen_in(n_nodes, numbers::invalid_unsigned_int);
    for (unsigned int i = 0; i < n_nodes; ++i)
      {
        // The diagonal is stored even for nodes without lists.
        if (i < n_owned)
          columns.push_back(i);
        seen_in[i] = i < n_owned ? i : numbers::invalid_unsigned_int;
        for (std::size_t k = first_list[i]; k < first_list[i + 1]; ++k)
          {
            const std::size_t l = lists_of_nodes[k];
            if (i >= n_owned && l >= n_own_lists)
              continue; // another rank contributes this list
            for (std::size_t e = lists.begin[l]; e < lists.begin[l + 1]; ++e)
              if (const unsigned int j = numbers[e];
                  seen_in[j] != i && has(i, j))
                {
                  seen_in[j] = i;
                  columns.push_back(j);
                }
          }
        std::sort(columns.begin() + begin.back(), columns.end());
        begin.push_back(columns.size());
      }
  }



  void
  DistributedMatrix::Pattern::make_exchange()
  {
    using Entry = std::pair<Node, Node>;
    std::map<unsigned int, std::vector<Entry>> entries;
    const auto                                 global = [&](const auto number) {
      return number < n_owned ? first + number : ghosts[number - n_owned];
    };
    for (unsigned int g = 0; g < ghosts.size(); ++g)
      {
        const std::size_t row_begin = begin[n_owned + g],
                          row_end   = begin[n_owned + g + 1];
        if (row_begin == row_end)
          continue;
        const unsigned int rank = owner_of_ghost[g];
        to_send.try_emplace(rank, row_begin, row_end).first->second.second =
          row_end;
        for (std::size_t e = row_begin; e < row_end; ++e)
          entries[rank].emplace_back(ghosts[g], global(columns[e]));
      }
    for (const auto &[rank, received] :
         Utilities::MPI::some_to_some(partitioner->get_mpi_communicator(),
                                      entries))
      for (const auto &[row, column] : received)
        to_receive[rank].push_back(
          find(local_number(row), local_number(column)));
  }



  void
  DistributedMatrix::reinit(const IndexSet    &owned,
                            const unsigned int dim,
                            NodeLists          lists,
                            const MPI_Comm     communicator)
  {
    const auto result = std::make_shared<Pattern>();
    result->dim       = dim;
    result->n_owned   = owned.n_elements() / dim;
    std::vector<Node> begins(1, 0);
    for (const unsigned int n :
         Utilities::MPI::all_gather(communicator, result->n_owned))
      begins.push_back(begins.back() + n);
    result->first = begins[Utilities::MPI::this_mpi_process(communicator)];
    const std::size_t n_own_lists = lists.begin.size() - 1;
    if (begins.size() > 2)
      add_lists_of_others(lists, begins, communicator);

    for (const Node node : lists.nodes)
      if (node < result->first || node >= result->first + result->n_owned)
        result->ghosts.push_back(node);
    std::sort(result->ghosts.begin(), result->ghosts.end());
    result->ghosts.erase(std::unique(result->ghosts.begin(),
                                     result->ghosts.end()),
                         result->ghosts.end());
    IndexSet ghost_dofs(owned.size());
    for (const Node node : result->ghosts)
      {
        ghost_dofs.add_range(node * dim, (node + 1) * dim);
        result->owner_of_ghost.push_back(
          std::upper_bound(begins.begin(), begins.end(), node) -
          begins.begin() - 1);
      }
    result->partitioner =
      std::make_shared<const Utilities::MPI::Partitioner>(owned,
                                                          ghost_dofs,
                                                          communicator);
    result->add_rows(lists, n_own_lists);
    result->make_exchange();
    values.assign(result->columns.size() * dim * dim, 0.);
    shared_block.clear();
    pattern = result;
  }
} // namespace Viscoplastic
