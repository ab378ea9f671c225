// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/multigrid_level.h>

#include <boost/functional/hash.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;



    template <int dim>
    using FourNumbers = typename LevelBlock<dim>::FourNumbers;



    /// sum := sum + block times y. In 2D the result is in two parts.
    template <int dim>
    inline void
    add_product(const LevelBlock<dim>        &a,
                const std::array<float, dim> &y,
                FourNumbers<dim>             &sum)
    {
      if constexpr (dim == 2)
        sum += a.columns[0] * FourNumbers<dim>{y[0], y[0], y[1], y[1]};
      else
        sum += a.columns[0] * y[0] + a.columns[1] * y[1] + a.columns[2] * y[2];
    }



    template <int dim>
    inline std::array<float, dim>
    values_of(const float *x)
    {
      std::array<float, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = x[d];
      return result;
    }



    template <int dim>
    inline std::array<float, dim>
    difference(const float *x, const std::array<float, dim> &y)
    {
      std::array<float, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = x[d] - y[d];
      return result;
    }



    template <int dim>
    inline float
    component(const FourNumbers<dim> &sum, const unsigned int d)
    {
      return dim == 2 ? sum[d] + sum[2 + d] : sum[d];
    }



    template <int dim>
    inline void
    add(const LevelBlock<dim> &a, const float *r, float *x)
    {
      FourNumbers<dim> sum = {};
      add_product<dim>(a, values_of<dim>(r), sum);
      for (unsigned int d = 0; d < dim; ++d)
        x[d] += component<dim>(sum, d);
    }
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
      questions[std::upper_bound(begins.begin(), begins.end(), node) -
                begins.begin() - 1]
        .push_back(node);
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
        const unsigned int rank =
          std::upper_bound(begins.begin(), begins.end(), node) -
          begins.begin() - 1;
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
    , inverse(n_owned)
  {
    if (!is_serial)
      {
        for (const Node node : matrix.columns)
          if (node < begin || node >= end)
            ghosts.push_back(node);
        std::sort(ghosts.begin(), ghosts.end());
        ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
      }

    // Numbers of this level: owned nodes rank by rank.
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
  void
  MultigridLevel<dim>::set_values(const BlockRows<dim> &matrix)
  {
    rows.clear();
    columns.clear();
    columns.reserve(matrix.columns.size() - n_owned);
    values.clear();
    row_sums.clear();
    struct Entry
    {
      bool            is_upper;
      std::size_t     key;
      unsigned int    column;
      LevelBlock<dim> block;
    };
    std::vector<Entry> row;
    // Rows so far by what their values come to.
    std::unordered_multimap<std::size_t, unsigned int> known;
    for (unsigned int i = 0; i < n_owned; ++i)
      {
        NodeBlock<dim> sum;
        row.clear();
        for (std::size_t e = matrix.begin[i]; e < matrix.begin[i + 1]; ++e)
          {
            const unsigned int column = local_number(matrix.columns[e]);
            sum += matrix.values[e];
            if (column == i)
              continue;
            // To what single precision can tell apart: so rounding does not
            // make rows differ.
            NodeBlock<dim> block   = matrix.values[e];
            double         largest = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                largest = std::max(largest, std::abs(block[c][d]));
            const double unit =
              largest > 0. ? std::ldexp(1., std::ilogb(largest) - 22) : 1.;
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                block[c][d] =
                  unit * std::nearbyint(block[c][d] / unit) + 0.; // no -0
            const LevelBlock<dim> rounded(block);
            row.push_back({column > i, rounded.key(), column, rounded});
          }
        // Neighbors in an order that does not depend on their numbers.
        std::sort(row.begin(), row.end(), [](const Entry &a, const Entry &b) {
          return std::tie(a.is_upper, a.key, a.column) <
                 std::tie(b.is_upper, b.key, b.column);
        });
        Row result{columns.size(), values.size(), 0, 0};
        result.n        = row.size();
        std::size_t key = row.size();
        for (const Entry &entry : row)
          {
            columns.push_back(entry.column);
            result.n_lower += entry.is_upper ? 0 : 1;
            boost::hash_combine(key, entry.key);
          }
        const auto [first, last] = known.equal_range(key);
        const auto same = std::find_if(first, last, [&](const auto &other) {
          const Row &candidate = rows[other.second];
          return candidate.n == result.n &&
                 std::equal(row.begin(),
                            row.end(),
                            values.begin() + candidate.values,
                            [](const Entry &entry, const auto &block) {
                              return entry.block == block;
                            });
        });
        if (same != last)
          result.values = rows[same->second].values;
        else
          {
            known.emplace(key, i);
            for (const Entry &entry : row)
              values.push_back(entry.block);
          }
        rows.push_back(result);
        row_sums.emplace_back(sum);
      }
    values.shrink_to_fit();
  }



  template <int dim>
  void
  MultigridLevel<dim>::set_interpolation(const Interpolation &interpolation,
                                         const MultigridLevel<dim> &coarser)
  {
    parent_begin.assign(interpolation.begin.begin(),
                        interpolation.begin.begin() + n_owned + 1);
    parents.clear();
    weights.clear();
    for (std::size_t e = 0; e < parent_begin.back(); ++e)
      {
        parents.push_back(coarser.local_number(interpolation.parents[e].node));
        weights.push_back(interpolation.parents[e].weight);
      }
  }



  template <int dim>
  NodeBlock<dim>
  MultigridLevel<dim>::row_sum(const unsigned int node) const
  {
    NodeBlock<dim> block;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        block[i][j] = row_sums[node](i, j);
    return block;
  }



  template <int dim>
  NodeBlock<dim>
  MultigridLevel<dim>::smoothing_block(const unsigned int node) const
  {
    // With half the row sums of what couples ranks, Gauss-Seidel in which they
    // do not wait for each other converges as if they did (Baker, Falgout,
    // Kolev, Yang, SISC 33, 2011).
    NodeBlock<dim> block = row_sum(node);
    const Row     &row   = rows[node];
    for (unsigned int e = 0; e < row.n; ++e)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          {
            const double value = values[row.values + e](i, j);
            block[i][j] -= value;
            if (columns[row.columns + e] >= n_owned)
              block[i][i] += 0.5 * std::abs(value);
          }
    return block;
  }



  template <int dim>
  void
  MultigridLevel<dim>::set_row_sum(const unsigned int    node,
                                   const NodeBlock<dim> &block)
  {
    row_sums[node] = LevelBlock<dim>(block);
  }



  template <int dim>
  void
  MultigridLevel<dim>::set_inverse_block(const unsigned int    node,
                                         const NodeBlock<dim> &block)
  {
    inverse[node] = LevelBlock<dim>(block);
  }



  template <int dim>
  inline void
  MultigridLevel<dim>::row_residual(const unsigned int i,
                                    const unsigned int n,
                                    const float       *x,
                                    const float       *b,
                                    float             *rest) const
  {
    // Two sums at a time: a single one waits for each addition, and a sweep for
    // each node.
    const LevelBlock<dim>       *a      = values.data() + rows[i].values;
    const unsigned int          *column = columns.data() + rows[i].columns;
    const std::array<float, dim> here   = values_of<dim>(x + i * dim);
    FourNumbers<dim>             even = {}, odd = {};
    add_product<dim>(row_sums[i], here, odd);
    for (unsigned int e = 0; e + 1 < n; e += 2)
      {
        add_product<dim>(a[e],
                         difference<dim>(x + column[e] * dim, here),
                         even);
        add_product<dim>(a[e + 1],
                         difference<dim>(x + column[e + 1] * dim, here),
                         odd);
      }
    if (n % 2 == 1)
      add_product<dim>(a[n - 1],
                       difference<dim>(x + column[n - 1] * dim, here),
                       even);
    even += odd;
    for (unsigned int d = 0; d < dim; ++d)
      rest[d] = b[i * dim + d] - component<dim>(even, d);
  }



  template <int dim>
  void
  MultigridLevel<dim>::smooth_forward_from_zero(Vector       &x,
                                                const Vector &b) const
  {
    const float *const b_begin = b.begin();
    float *const       x_begin = x.begin();
    for (unsigned int i = 0; i < n_owned; ++i)
      {
        // What comes later is still zero, and so are other ranks' nodes.
        for (unsigned int d = 0; d < dim; ++d)
          x_begin[i * dim + d] = 0.f;
        float rest[dim];
        row_residual(i, rows[i].n_lower, x_begin, b_begin, rest);
        add<dim>(inverse[i], rest, x_begin + i * dim);
      }
  }



  template <int dim>
  void
  MultigridLevel<dim>::smooth_backward(Vector &x, const Vector &b) const
  {
    if (!is_serial)
      x.update_ghost_values();
    const float *const b_begin = b.begin();
    float *const       x_begin = x.begin();
    for (unsigned int i = n_owned; i-- > 0;)
      {
        float rest[dim];
        row_residual(i, rows[i].n, x_begin, b_begin, rest);
        add<dim>(inverse[i], rest, x_begin + i * dim);
      }
    if (!is_serial)
      x.zero_out_ghost_values();
  }



  template <int dim>
  void
  MultigridLevel<dim>::residual(Vector &r, Vector &x, const Vector &b) const
  {
    if (!is_serial)
      x.update_ghost_values();
    const float *const b_begin = b.begin();
    const float *const x_begin = x.begin();
    float *const       r_begin = r.begin();
    for (unsigned int i = 0; i < n_owned; ++i)
      {
        float rest[dim];
        row_residual(i, rows[i].n, x_begin, b_begin, rest);
        for (unsigned int d = 0; d < dim; ++d)
          r_begin[i * dim + d] = rest[d];
      }
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
      for (std::size_t e = parent_begin[i]; e < parent_begin[i + 1]; ++e)
        for (unsigned int d = 0; d < dim; ++d)
          target[parents[e] * dim + d] += weights[e] * f[i * dim + d];
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
        for (std::size_t e = parent_begin[i]; e < parent_begin[i + 1]; ++e)
          for (unsigned int d = 0; d < dim; ++d)
            value[d] += weights[e] * source[parents[e] * dim + d];
        for (unsigned int d = 0; d < dim; ++d)
          f[i * dim + d] = value[d];
      }
    if (!is_serial)
      coarse.zero_out_ghost_values();
  }



  template class MultigridLevel<2>;
  template class MultigridLevel<3>;
} // namespace Viscoplastic
