// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/block_rows.h>

#include <algorithm>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;

    constexpr unsigned int none = std::numeric_limits<unsigned int>::max();



    /// Consecutive local numbers for nodes: owned nodes first, then others in
    /// the order in which their numbers are asked for.
    class LocalNumbers
    {
    public:
      LocalNumbers(const std::vector<Node> &owned,
                   const Node               begin,
                   const Node               end)
        : begin(begin)
        , end(end)
        , nodes(owned)
        , number_of_owned(end - begin, none)
      {
        for (unsigned int i = 0; i < owned.size(); ++i)
          number_of_owned[owned[i] - begin] = i;
      }

      unsigned int
      operator()(const Node node)
      {
        if (node >= begin && node < end)
          return number_of_owned[node - begin];
        const auto [entry, is_new] = others.emplace(node, nodes.size());
        if (is_new)
          nodes.push_back(node);
        return entry->second;
      }

      /// The node of each local number.
      const std::vector<Node> &
      all() const
      {
        return nodes;
      }

    private:
      const Node                   begin, end;
      std::vector<Node>            nodes;
      std::vector<unsigned int>    number_of_owned;
      std::map<Node, unsigned int> others;
    };



    /// A block on its way to the rank that owns the row.
    template <int dim>
    struct Entry
    {
      Node           row, column;
      NodeBlock<dim> block;

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &row &column &block;
      }
    };



    /// Return @p rows plus the blocks that other ranks send. Collective.
    template <int dim>
    BlockRows<dim>
    exchange(const BlockRows<dim>                                  &rows,
             const std::map<unsigned int, std::vector<Entry<dim>>> &to_send,
             LocalNumbers                                          &number,
             const MPI_Comm communicator)
    {
      std::map<unsigned int, std::map<Node, NodeBlock<dim>>> sums;
      // Adding in the order of the ranks makes sums reproducible.
      for (const auto &from :
           Utilities::MPI::some_to_some(communicator, to_send))
        for (const Entry<dim> &entry : from.second)
          {
            const auto [place, is_new] =
              sums[number(entry.row)].emplace(entry.column, entry.block);
            if (!is_new)
              place->second += entry.block;
          }
      BlockRows<dim> result;
      result.begin.reserve(rows.begin.size());
      for (unsigned int row = 0; row < rows.n_rows(); ++row)
        {
          const auto sum = sums.find(row);
          if (sum != sums.end())
            for (std::size_t e = rows.begin[row]; e < rows.begin[row + 1]; ++e)
              {
                const auto [place, is_new] =
                  sum->second.emplace(rows.columns[e], rows.values[e]);
                if (!is_new)
                  place->second += rows.values[e];
              }
          if (sum != sums.end())
            for (const auto &[column, block] : sum->second)
              {
                result.columns.push_back(column);
                result.values.push_back(block);
              }
          else
            {
              result.columns.insert(result.columns.end(),
                                    rows.columns.begin() + rows.begin[row],
                                    rows.columns.begin() + rows.begin[row + 1]);
              result.values.insert(result.values.end(),
                                   rows.values.begin() + rows.begin[row],
                                   rows.values.begin() + rows.begin[row + 1]);
            }
          result.begin.push_back(result.columns.size());
        }
      return result;
    }


    /// One list of numbers per row, in compressed form.
    struct Lists
    {
      std::vector<std::size_t>  begin;
      std::vector<unsigned int> entries;
    };



    /// Return for each column the rows in which it occurs, in ascending order;
    /// @p columns are those of @p n_rows compressed rows.
    Lists
    transpose(const std::vector<std::size_t>  &row_begin,
              const std::vector<unsigned int> &columns,
              const unsigned int               n_rows,
              const unsigned int               n_columns)
    {
      Lists result{std::vector<std::size_t>(n_columns + 1, 0),
                   std::vector<unsigned int>(row_begin[n_rows])};
      for (std::size_t e = 0; e < row_begin[n_rows]; ++e)
        ++result.begin[columns[e] + 1];
      for (unsigned int I = 0; I < n_columns; ++I)
        result.begin[I + 1] += result.begin[I];
      std::vector<std::size_t> next(result.begin.begin(),
                                    result.begin.end() - 1);
      for (unsigned int i = 0; i < n_rows; ++i)
        for (std::size_t e = row_begin[i]; e < row_begin[i + 1]; ++e)
          result.entries[next[columns[e]]++] = i;
      return result;
    }



    /// Return for each entry of A the interpolation's row of its column.
    template <int dim>
    std::vector<unsigned int>
    rows_of_columns(const BlockRows<dim>    &A,
                    const std::vector<Node> &owned_nodes,
                    const std::vector<Node> &ghosts,
                    const Node               begin,
                    const Node               end)
    {
      std::vector<unsigned int> result(A.columns.size()), number(end - begin);
      for (unsigned int i = 0; i < owned_nodes.size(); ++i)
        number[owned_nodes[i] - begin] = i;
      for (std::size_t e = 0; e < result.size(); ++e)
        {
          const Node node = A.columns[e];
          result[e] =
            node >= begin && node < end ?
              number[node - begin] :
              owned_nodes.size() +
                (std::lower_bound(ghosts.begin(), ghosts.end(), node) -
                 ghosts.begin());
        }
      return result;
    }
  } // namespace



  template <int dim>
  BlockRows<dim>
  galerkin_product(const BlockRows<dim>    &A,
                   const std::vector<Node> &owned_nodes,
                   const std::vector<Node> &ghosts,
                   const Interpolation     &P,
                   const std::vector<Node> &coarse_nodes,
                   const std::vector<Node> &begins,
                   const MPI_Comm           communicator)
  {
    const unsigned int rank  = Utilities::MPI::this_mpi_process(communicator);
    const Node         begin = begins[rank], end = begins[rank + 1];

    // Number the columns of P, which are coarse nodes, consecutively.
    LocalNumbers              number(coarse_nodes, begin, end);
    std::vector<unsigned int> parents(P.parents.size());
    for (std::size_t e = 0; e < parents.size(); ++e)
      parents[e] = number(P.parents[e].node);
    const std::vector<Node> &coarse = number.all();
    const Lists              children =
      transpose(P.begin, parents, A.n_rows(), coarse.size());
    const std::vector<unsigned int> fine_column =
      rows_of_columns(A, owned_nodes, ghosts, begin, end);
    // Call act(e, p) for all pairs of entries whose products make row i of A P.
    const auto for_each_product = [&](const unsigned int i, const auto &act) {
      for (std::size_t e = A.begin[i]; e < A.begin[i + 1]; ++e)
        for (std::size_t p = P.begin[fine_column[e]];
             p < P.begin[fine_column[e] + 1];
             ++p)
          act(e, p);
    };

    // Away from cells that the finer mesh has refined, rows of A are those of
    // the product: all their nodes interpolate themselves alone.
    const auto is_itself = [&](const unsigned int row, const Node node) {
      const std::size_t first = P.begin[row];
      return P.begin[row + 1] == first + 1 && P.parents[first].node == node &&
             P.parents[first].weight == 1.;
    };
    std::vector<bool> is_row_of_A(coarse.size(), false);

    // Make the sparsity pattern, coarse row by coarse row.
    std::vector<std::size_t>                   row_begin(1, 0);
    std::vector<unsigned int>                  columns;
    std::vector<unsigned int>                  seen_in(coarse.size(), none);
    std::vector<std::pair<Node, unsigned int>> in_order;
    for (unsigned int I = 0; I < coarse.size(); ++I)
      {
        const unsigned int i = children.begin[I + 1] - children.begin[I] == 1 ?
                                 children.entries[children.begin[I]] :
                                 none;
        bool               is_copy = i != none && is_itself(i, coarse[I]);
        for (std::size_t e = is_copy ? A.begin[i] : 0;
             is_copy && e < A.begin[i + 1];
             ++e)
          is_copy = is_itself(fine_column[e], A.columns[e]);
        if (is_copy)
          {
            is_row_of_A[I] = true;
            for (std::size_t e = A.begin[i]; e < A.begin[i + 1]; ++e)
              columns.push_back(parents[P.begin[fine_column[e]]]);
            row_begin.push_back(columns.size());
            continue;
          }
        in_order.clear();
        for (std::size_t c = children.begin[I]; c < children.begin[I + 1]; ++c)
          for_each_product(children.entries[c],
                           [&](const std::size_t, const std::size_t p) {
                             if (seen_in[parents[p]] == I)
                               return;
                             seen_in[parents[p]] = I;
                             in_order.emplace_back(coarse[parents[p]],
                                                   parents[p]);
                           });
        std::sort(in_order.begin(), in_order.end());
        for (const auto &entry : in_order)
          columns.push_back(entry.second);
        row_begin.push_back(columns.size());
      }

    // Add up the values, fine row by fine row: T = A_i P, then P_i^T T.
    std::vector<NodeBlock<dim>> values(columns.size(), NodeBlock<dim>());
    std::vector<unsigned int>   place(coarse.size(), none), touched;
    std::vector<NodeBlock<dim>> sums;
    for (unsigned int i = 0; i < A.n_rows(); ++i)
      {
        if (P.begin[i + 1] - P.begin[i] == 1 &&
            is_row_of_A[parents[P.begin[i]]])
          {
            std::copy(A.values.begin() + A.begin[i],
                      A.values.begin() + A.begin[i + 1],
                      values.begin() + row_begin[parents[P.begin[i]]]);
            continue;
          }
        touched.clear();
        sums.clear();
        for_each_product(i, [&](const std::size_t e, const std::size_t p) {
          unsigned int &k = place[parents[p]];
          if (k == none)
            {
              k = touched.size();
              touched.push_back(parents[p]);
              sums.push_back(NodeBlock<dim>());
            }
          sums[k] += P.parents[p].weight * A.values[e];
        });
        for (std::size_t p = P.begin[i]; p < P.begin[i + 1]; ++p)
          {
            const unsigned int I = parents[p];
            for (std::size_t e = row_begin[I]; e < row_begin[I + 1]; ++e)
              if (place[columns[e]] != none)
                values[e] += P.parents[p].weight * sums[place[columns[e]]];
          }
        for (const unsigned int J : touched)
          place[J] = none;
      }

    BlockRows<dim> rows;
    const auto     n_owned = coarse_nodes.size();
    rows.begin.assign(row_begin.begin(), row_begin.begin() + n_owned + 1);
    rows.columns.reserve(rows.begin.back());
    for (std::size_t e = 0; e < rows.begin.back(); ++e)
      rows.columns.push_back(coarse[columns[e]]);
    rows.values.assign(values.begin(), values.begin() + rows.begin.back());
    if (Utilities::MPI::n_mpi_processes(communicator) == 1)
      return rows;
    std::map<unsigned int, std::vector<Entry<dim>>> to_send;
    for (unsigned int I = n_owned; I < coarse.size(); ++I)
      for (std::size_t e = row_begin[I]; e < row_begin[I + 1]; ++e)
        to_send[owner_of(coarse[I], begins)].push_back(
          {coarse[I], coarse[columns[e]], values[e]});
    return exchange(rows, to_send, number, communicator);
  }



  VISCOPLASTIC_INSTANTIATE(galerkin_product);
} // namespace Viscoplastic
