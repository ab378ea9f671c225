// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/trilinos_vector.h>

#include <viscoplastic_contact/base/distributed_matrix.h>
#include <viscoplastic_contact/base/row_kernels.h>

#include <algorithm>
#include <cstring>

namespace Viscoplastic
{
  namespace
  {
    /// y := y + B x, and below y := y + B^T x, for a block B.
    template <int dim>
    void
    add_product(const double *block, const double *x, double *y)
    {
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          y[c] += block[c * dim + d] * x[d];
    }

    template <int dim>
    void
    add_transposed_product(const double *block, const double *x, double *y)
    {
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          y[d] += block[c * dim + d] * x[c];
    }
  } // namespace



  double
  DistributedMatrix::el(const types::global_dof_index i,
                        const types::global_dof_index j) const
  {
    const unsigned int dim            = pattern->dim;
    const auto        &p              = *pattern;
    const Node         ghost_or_owned = j / dim;
    if ((ghost_or_owned < p.first || ghost_or_owned >= p.first + p.n_owned) &&
        !std::binary_search(p.ghosts.begin(), p.ghosts.end(), ghost_or_owned))
      return 0.;
    const unsigned int row      = p.local_number(i / dim),
                       column   = p.local_number(j / dim);
    const bool        is_stored = p.has(row, column);
    const std::size_t entry =
      is_stored ? p.find(row, column) : p.find(column, row);
    if (entry == no_entry)
      return 0.;
    return is_stored ? block(row, entry)[(i % dim) * dim + j % dim] :
                       block(column, entry)[(j % dim) * dim + i % dim];
  }



  DistributedMatrix::WholeRows
  DistributedMatrix::whole_rows() const
  {
    const unsigned int n = pattern->n_owned;
    WholeRows          result;
    result.begin.assign(n + 1, 0);
    for_each_block([&](const unsigned int i, const unsigned int j, auto) {
      ++result.begin[i + 1];
      if (j < n && j != i)
        ++result.begin[j + 1];
    });
    for (unsigned int i = 0; i < n; ++i)
      result.begin[i + 1] += result.begin[i];
    result.columns.resize(result.begin[n]);
    result.blocks.resize(result.begin[n]);
    // Rows are visited in ascending order: all entries of a lower triangle have
    // been appended when their row is visited, so columns ascend.
    std::vector<std::size_t> next(result.begin.begin(), result.begin.end() - 1);
    const auto               append =
      [&](const unsigned int i, const unsigned int j, const double *block) {
        result.columns[next[i]]  = j;
        result.blocks[next[i]++] = block;
      };
    for_each_block(
      [&](const unsigned int i, const unsigned int j, const double *block) {
        append(i, j, block);
        if (j < n && j != i)
          append(j, i, block);
      });
    return result;
  }



  std::vector<double>
  DistributedMatrix::at_columns(const double *owned) const
  {
    const auto         &partitioner = *pattern->partitioner;
    const std::size_t   n           = partitioner.locally_owned_size();
    const std::size_t   n_ghosts    = partitioner.n_ghost_indices();
    std::vector<double> result(n + n_ghosts);
    std::copy(owned, owned + n, result.begin());
    std::vector<double>      to_send(partitioner.n_import_indices());
    std::vector<MPI_Request> requests;
    const ArrayView<double>  ghosts(result.data() + n, n_ghosts);
    partitioner.export_to_ghosted_array_start(
      0,
      ArrayView<const double>(result.data(), n),
      ArrayView<double>(to_send.data(), to_send.size()),
      ghosts,
      requests);
    partitioner.export_to_ghosted_array_finish(ghosts, requests);
    return result;
  }



  void
  DistributedMatrix::vmult(DistributedVector       &y,
                           const DistributedVector &x) const
  {
    const auto multiply_by = [&](const double *at) {
      static const auto in_2d = row_kernels<2>().multiply,
                        in_3d = row_kernels<3>().multiply;
      (pattern->dim == 2 ? in_2d : in_3d)({pattern->n_owned,
                                           pattern->begin.data(),
                                           first_block().data(),
                                           pattern->columns.data(),
                                           values.data()},
                                          y.begin(),
                                          at);
    };
    if (pattern->partitioner->n_mpi_processes() == 1)
      multiply_by(x.begin());
    else
      multiply_by(at_columns(x.begin()).data());
  }



  std::vector<DistributedMatrix::Place>
  DistributedMatrix::blocks_at(const std::vector<bool> &is_chosen) const
  {
    std::vector<Place> result;
    for (unsigned int i = 0; i < pattern->n_owned; ++i)
      for (std::size_t e = pattern->begin[i]; e < pattern->begin[i + 1]; ++e)
        if (is_chosen[i] || is_chosen[pattern->columns[e]])
          result.push_back(
            {i, is_chosen[i], is_chosen[pattern->columns[e]], e});
    return result;
  }



  void
  DistributedMatrix::vmult_add(DistributedVector        &y,
                               const DistributedVector  &x,
                               const std::vector<Place> &places) const
  {
    const unsigned int  dim = pattern->dim;
    std::vector<double> with_ghosts;
    const double       *at = x.begin();
    if (pattern->partitioner->n_mpi_processes() > 1)
      {
        with_ghosts = at_columns(x.begin());
        at          = with_ghosts.data();
      }
    for (const auto &[i, row_is_chosen, column_is_chosen, entry] : places)
      {
        const unsigned int j      = pattern->columns[entry];
        const double      *values = block(i, entry);
        if (column_is_chosen)
          (dim == 2 ? add_product<2> : add_product<3>)(values,
                                                       &at[j * dim],
                                                       y.begin() + i * dim);
        if (row_is_chosen && j != i && j < pattern->n_owned)
          (dim == 2 ? add_transposed_product<2> :
                      add_transposed_product<3>)(values,
                                                 &at[i * dim],
                                                 y.begin() + j * dim);
      }
  }



  void
  DistributedMatrix::add(const std::vector<types::global_dof_index> &dofs,
                         const FullMatrix<double>                   &matrix)
  {
    take_apart();
    const unsigned int        dim = pattern->dim;
    std::vector<unsigned int> numbers;
    for (std::size_t a = 0; a < dofs.size(); a += dim)
      numbers.push_back(pattern->local_number(dofs[a] / dim));
    for (unsigned int a = 0; a < numbers.size(); ++a)
      for (unsigned int b = 0; b < numbers.size(); ++b)
        {
          if (!pattern->has(numbers[a], numbers[b]))
            continue;
          const std::size_t entry = pattern->find(numbers[a], numbers[b]);
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim; ++d)
              {
                const double value = matrix(a * dim + c, b * dim + d);
                if (entry != no_entry)
                  values[entry * n_entries_of_block() + c * dim + d] += value;
                else
                  Assert(value == 0., ExcInternalError());
              }
        }
  }



  void
  DistributedMatrix::add_to_diagonal(const std::size_t i, const double value)
  {
    take_apart();
    const unsigned int dim = pattern->dim;
    values[pattern->begin[i / dim] * n_entries_of_block() +
           (i % dim) * (dim + 1)] += value;
  }



  void
  DistributedMatrix::share_rows()
  {
    take_apart();
    const std::size_t        size = n_entries_of_block();
    std::vector<std::size_t> first;
    std::vector<double>      shared;
    first.reserve(pattern->n_owned);
    // The stored rows, by a hash of their values.
    std::unordered_multimap<std::uint64_t, unsigned int> known;
    for (unsigned int i = 0; i < pattern->n_owned; ++i)
      {
        const double *row = &values[pattern->begin[i] * size];
        const auto    n   = [&](const unsigned int of_row) {
          return (pattern->begin[of_row + 1] - pattern->begin[of_row]) * size;
        };
        std::uint64_t key = n(i);
        for (std::size_t e = 0; e < n(i); ++e)
          {
            std::uint64_t bits;
            std::memcpy(&bits, row + e, sizeof(bits));
            key = (key ^ bits) * 0x9E3779B97F4A7C15U + (key >> 29);
          }
        const auto [begin, end] = known.equal_range(key);
        const auto same = std::find_if(begin, end, [&](const auto &other) {
          return n(other.second) == n(i) &&
                 std::memcmp(&shared[first[other.second] * size],
                             row,
                             n(i) * sizeof(double)) == 0;
        });
        if (same != end)
          {
            first.push_back(first[same->second]);
            continue;
          }
        known.emplace(key, i);
        first.push_back(shared.size() / size);
        shared.insert(shared.end(), row, row + n(i));
        if (shared.size() > values.size() / 2)
          return;
      }
    shared.shrink_to_fit();
    values.swap(shared);
    shared_block.swap(first);
  }



  void
  DistributedMatrix::take_apart()
  {
    if (shared_block.empty())
      return;
    const std::size_t   size = n_entries_of_block();
    std::vector<double> all(pattern->columns.size() * size, 0.);
    for (unsigned int i = 0; i < pattern->n_owned; ++i)
      std::copy_n(block(i, pattern->begin[i]),
                  (pattern->begin[i + 1] - pattern->begin[i]) * size,
                  &all[pattern->begin[i] * size]);
    values.swap(all);
    shared_block.clear();
  }



  void
  DistributedMatrix::compress()
  {
    if (pattern->partitioner->n_mpi_processes() == 1)
      return;
    take_apart();
    const std::size_t                           size = n_entries_of_block();
    std::map<unsigned int, std::vector<double>> messages;
    for (const auto &[rank, range] : pattern->to_send)
      messages[rank].assign(values.begin() + range.first * size,
                            values.begin() + range.second * size);
    std::fill(values.begin() + pattern->begin[pattern->n_owned] * size,
              values.end(),
              0.);
    for (const auto &[rank, received] :
         Utilities::MPI::some_to_some(get_mpi_communicator(), messages))
      {
        const std::vector<std::size_t> &entries = pattern->to_receive.at(rank);
        for (std::size_t k = 0; k < received.size(); ++k)
          values[entries[k / size] * size + k % size] += received[k];
      }
  }
} // namespace Viscoplastic
