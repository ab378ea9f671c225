// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/row_kernels.h>
#include <viscoplastic_contact/linear_solvers/block_rows.h>

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  /// The rows of a matrix for products with vectors: those with the same
  /// values, of which uniform meshes have many, share them. What is read is
  /// what a product costs. Nodes have local numbers, the owned ones first.
  ///
  /// Values are rounded to what makes rows of equal cells equal: to the last
  /// digit but one of single precision.
  template <int dim>
  class SharedRows
  {
  public:
    using Block = PackedBlock<dim>;

    /// @p local_columns: the local numbers of the columns of @p matrix.
    void
    set_values(const BlockRows<dim>            &matrix,
               const std::vector<unsigned int> &local_columns);

    /// The number of blocks of the matrix, and of those that differ.
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

    /// The sum of the blocks of a row; springs at a node change it.
    NodeBlock<dim>
    row_sum(const unsigned int node) const;
    void
    set_row_sum(const unsigned int node, const NodeBlock<dim> &block);

    /// The block on the diagonal, and for each component the sum of absolute
    /// values of a row in columns of nodes that are not owned.
    std::pair<NodeBlock<dim>, Tensor<1, dim>>
    diagonal_block(const unsigned int node) const;

    /// r := b - A x.
    void
    residual(float *r, const float *x, const float *b) const;

    /// Set the inverse of a node's diagonal block, by which Gauss-Seidel
    /// multiplies residuals.
    void
    set_inverse_block(const unsigned int node, const NodeBlock<dim> &block);

    /// One sweep of Gauss-Seidel for A x = b: forward from x = 0, or backward.
    /// Values of nodes that are not owned do not change; forward they count as
    /// zero.
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
