// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/shared_rows.h>

#include <boost/functional/hash.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <tuple>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;

    /// The precision by which blocks are compared: relative to their largest
    /// entry, and to that of the row, below which entries are rounding.
    constexpr double of_block = 0x1p-22, of_row = 0x1p-46;



    template <int dim>
    PackedBlock<dim>
    packed(const NodeBlock<dim> &block)
    {
      PackedBlock<dim> result = {};
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          if (dim == 2)
            result.parts[0][i * dim + j] = block[i][j];
          else
            result.parts[i][j] = block[i][j];
      return result;
    }



    template <int dim>
    NodeBlock<dim>
    unpacked(const PackedBlock<dim> &block)
    {
      NodeBlock<dim> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i][j] =
            dim == 2 ? block.parts[0][i * dim + j] : block.parts[i][j];
      return result;
    }



    template <int dim>
    bool
    are_equal(const PackedBlock<dim> &a, const PackedBlock<dim> &b)
    {
      return std::memcmp(a.parts, b.parts, sizeof(a.parts)) == 0;
    }



    /// Return a hash, the same for equal blocks.
    template <int dim>
    std::size_t
    key(const PackedBlock<dim> &block)
    {
      std::uint32_t bits[sizeof(block.parts) / 4];
      std::memcpy(bits, block.parts, sizeof(block.parts));
      std::size_t result = 0;
      for (const std::uint32_t part : bits)
        result = (result ^ part) * 0x9E3779B97F4A7C15U + (result >> 29);
      return result;
    }



    template <int dim>
    double
    largest_entry(const NodeBlock<dim> &block)
    {
      double result = 0.;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result = std::max(result, std::abs(block[i][j]));
      return result;
    }



    /// Return the largest power of two up to a positive number, without the
    /// function calls of std::ilogb() and std::ldexp().
    double
    power_of_two(double x)
    {
      std::uint64_t bits;
      std::memcpy(&bits, &x, sizeof(x));
      bits &= ~std::uint64_t(0) << 52;
      std::memcpy(&x, &bits, sizeof(x));
      return x;
    }



    /// Round to multiples of @p unit, a power of two, at least 2^-51 of the
    /// entries.
    template <int dim>
    NodeBlock<dim>
    rounded(const NodeBlock<dim> &block, const double unit)
    {
      // Numbers near this one are multiples of the unit. (std::nearbyint is a
      // function call per entry unless the processor is known to round.)
      const double   large = 0x1.8p52 * unit;
      NodeBlock<dim> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i][j] = (block[i][j] + large) - large;
      return result;
    }
  } // namespace



  template <int dim>
  void
  SharedRows<dim>::set_values(const BlockRows<dim>            &matrix,
                              const std::vector<unsigned int> &local_columns)
  {
    AssertDimension(local_columns.size(), matrix.columns.size());
    rows.clear();
    columns.clear();
    values.clear();
    row_sums.clear();
    rows.reserve(matrix.n_rows());
    row_sums.reserve(matrix.n_rows());
    columns.reserve(matrix.columns.size());
    struct Neighbor
    {
      bool         is_upper;
      std::size_t  key;
      unsigned int column;
      unsigned int block;
    };
    std::vector<Neighbor> neighbors;
    std::vector<Block>    blocks;
    // The distinct rows so far, by hash of their values.
    std::unordered_multimap<std::size_t, unsigned int> known;
    for (unsigned int i = 0; i < matrix.n_rows(); ++i)
      {
        const std::size_t begin   = matrix.begin[i];
        const std::size_t end     = matrix.begin[i + 1];
        double            largest = 0.;
        for (std::size_t e = begin; e < end; ++e)
          largest = std::max(largest, largest_entry<dim>(matrix.values[e]));
        const double   least = power_of_two(largest) * of_row;
        NodeBlock<dim> sum;
        neighbors.clear();
        blocks.clear();
        for (std::size_t e = begin; e < end; ++e)
          {
            const unsigned int column = local_columns[e];
            sum += matrix.values[e];
            if (column == i)
              continue;
            const double size = largest_entry<dim>(matrix.values[e]);
            blocks.push_back(packed<dim>(
              size > 0. ?
                rounded<dim>(matrix.values[e],
                             std::max(power_of_two(size) * of_block, least)) :
                NodeBlock<dim>()));
            neighbors.push_back({column > i,
                                 key(blocks.back()),
                                 column,
                                 static_cast<unsigned int>(blocks.size() - 1)});
          }
        // Sort neighbors independently of their numbers.
        std::sort(neighbors.begin(),
                  neighbors.end(),
                  [](const Neighbor &a, const Neighbor &b) {
                    return std::tie(a.is_upper, a.key, a.column) <
                           std::tie(b.is_upper, b.key, b.column);
                  });
        Row row{columns.size(), values.size(), 0, 0};
        row.n               = neighbors.size();
        std::size_t row_key = row.n;
        for (const Neighbor &neighbor : neighbors)
          {
            columns.push_back(neighbor.column);
            row.n_lower += neighbor.is_upper ? 0 : 1;
            boost::hash_combine(row_key, neighbor.key);
          }
        const auto [first, last] = known.equal_range(row_key);
        const auto same = std::find_if(first, last, [&](const auto &other) {
          const Row &candidate = rows[other.second];
          return candidate.n == row.n &&
                 std::equal(neighbors.begin(),
                            neighbors.end(),
                            values.begin() + candidate.values,
                            [&](const Neighbor &neighbor, const auto &block) {
                              return are_equal(blocks[neighbor.block], block);
                            });
        });
        if (same != last)
          row.values = rows[same->second].values;
        else
          {
            known.emplace(row_key, i);
            for (const Neighbor &neighbor : neighbors)
              values.push_back(blocks[neighbor.block]);
          }
        rows.push_back(row);
        row_sums.push_back(packed<dim>(sum));
      }
    values.shrink_to_fit();
  }



  template <int dim>
  NodeBlock<dim>
  SharedRows<dim>::row_sum(const unsigned int node) const
  {
    return unpacked(row_sums[node]);
  }



  template <int dim>
  void
  SharedRows<dim>::set_row_sum(const unsigned int    node,
                               const NodeBlock<dim> &block)
  {
    row_sums[node] = packed<dim>(block);
  }



  template <int dim>
  std::pair<NodeBlock<dim>, Tensor<1, dim>>
  SharedRows<dim>::diagonal_block(const unsigned int node) const
  {
    const Row                                &row = rows[node];
    std::pair<NodeBlock<dim>, Tensor<1, dim>> result{row_sum(node), {}};
    for (unsigned int e = 0; e < row.n; ++e)
      {
        const NodeBlock<dim> block = unpacked(values[row.values + e]);
        result.first -= block;
        if (columns[row.columns + e] >= rows.size())
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              result.second[i] += std::abs(block[i][j]);
      }
    return result;
  }



  template <int dim>
  RowTable<dim>
  SharedRows<dim>::table() const
  {
    return {static_cast<unsigned int>(rows.size()),
            rows.data(),
            columns.data(),
            values.data(),
            row_sums.data()};
  }



  template <int dim>
  void
  SharedRows<dim>::residual(float *r, const float *x, const float *b) const
  {
    kernels.residual(table(), r, x, b);
  }



  template <int dim>
  void
  SharedRows<dim>::set_inverse_block(const unsigned int    node,
                                     const NodeBlock<dim> &block)
  {
    inverse.resize(rows.size());
    inverse[node] = packed<dim>(block);
  }



  template <int dim>
  void
  SharedRows<dim>::smooth_forward_from_zero(float *x, const float *b) const
  {
    kernels.smooth_forward_from_zero(table(), inverse.data(), x, b);
  }



  template <int dim>
  void
  SharedRows<dim>::smooth_backward(float *x, const float *b) const
  {
    kernels.smooth_backward(table(), inverse.data(), x, b);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(SharedRows);
} // namespace Viscoplastic
