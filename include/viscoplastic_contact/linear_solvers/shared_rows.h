// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/row_kernels.h>
#include <viscoplastic_contact/linear_solvers/block_rows.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  /// The rows of a matrix for products with vectors, whose cost is that of
  /// reading them: rows with the same values, frequent on uniform meshes, share
  /// them. Nodes have local numbers, the owned ones first.
  ///
  /// Values are rounded to all but the last binary digit of single precision,
  /// so that rows of equal cells are equal.
  template <int dim>
  class SharedRows
  {
  public:
    using Block = PackedBlock<dim>;

    /// Set values; @p local_columns: local numbers of the columns of @p matrix.
    void
    set_values(const BlockRows<dim>            &matrix,
               const std::vector<unsigned int> &local_columns);

    /// Return the number of off-diagonal blocks, and of those stored.
    std::size_t
    n_blocks() const
    {
      return columns.size();
    }
    std::size_t
    n_stored_blocks() const
    {
      return values.size();
    }

    /// Return or set the sum of the blocks of a row, which springs change.
    NodeBlock<dim>
    row_sum(const unsigned int node) const;
    void
    set_row_sum(const unsigned int node, const NodeBlock<dim> &block);

    /// Return the diagonal block, and for each component the sum of absolute
    /// values of its row in columns of nodes that are not owned.
    std::pair<NodeBlock<dim>, Tensor<1, dim>>
    diagonal_block(const unsigned int node) const;

    /// r := b - A x.
    void
    residual(float *r, const float *x, const float *b) const;

    /// Set the inverse of a node's diagonal block for Gauss-Seidel.
    void
    set_inverse_block(const unsigned int node, const NodeBlock<dim> &block);

    /// Apply one sweep of Gauss-Seidel to A x = b: forward from x = 0, or
    /// backward. Values of nodes that are not owned do not change; forward they
    /// count as zero.
    void
    smooth_forward_from_zero(float *x, const float *b) const;
    void
    smooth_backward(float *x, const float *b) const;

  private:
    using Row = typename RowTable<dim>::Row;

    RowTable<dim>
    table() const;

    const RowKernels<dim> kernels = row_kernels<dim>();

    std::vector<Row>          rows;
    std::vector<unsigned int> columns;
    std::vector<Block>        values, row_sums, inverse;
  };
} // namespace Viscoplastic
