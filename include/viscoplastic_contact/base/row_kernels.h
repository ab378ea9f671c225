// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>

namespace Viscoplastic
{
  /// A dim x dim block in vectors of four numbers: each row of a 3 x 3 block
  /// padded by zero, or both rows of a 2 x 2 block.
  template <int dim>
  struct PackedBlock
  {
    using FourNumbers
      __attribute__((vector_size(4 * sizeof(float)), aligned(16))) = float;

    static constexpr unsigned int n_parts = dim == 2 ? 1 : dim;

    FourNumbers parts[n_parts];
  };


  /// The data of a matrix for products with its rows, as plain pointers; see
  /// SharedRows.
  template <int dim>
  struct RowTable
  {
    /// A row without the diagonal: where its columns and values begin, the
    /// number of its columns that are owned nodes before it, which come first,
    /// and the number of all columns.
    struct Row
    {
      std::size_t  columns, values;
      unsigned int n_lower, n;
    };

    unsigned int            n_rows;
    const Row              *rows;
    const unsigned int     *columns;
    const PackedBlock<dim> *values, *row_sums;
  };


  /// The rows of a symmetric matrix in double precision: diagonal and upper
  /// triangle. `first_block` is the index of the first block of each row.
  struct SymmetricRows
  {
    unsigned int        n_rows;
    const std::size_t  *begin, *first_block;
    const unsigned int *columns;
    const double       *values;
  };



  /// The innermost loops of multigrid, see SharedRows, and of products with a
  /// DistributedMatrix, compiled for one kind of processor.
  template <int dim>
  struct RowKernels
  {
    using Table = RowTable<dim>;
    using Block = PackedBlock<dim>;

    void (*residual)(const Table &A, float *r, const float *x, const float *b);
    void (*smooth_forward_from_zero)(const Table &A,
                                     const Block *inverse,
                                     float       *x,
                                     const float *b);
    void (*smooth_backward)(const Table &A,
                            const Block *inverse,
                            float       *x,
                            const float *b);
    /// y := A x.
    void (*multiply)(const SymmetricRows &A, double *y, const double *x);
  };



  /// The kernels for any processor that the program runs on.
  template <int dim>
  RowKernels<dim>
  portable_row_kernels();

#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS
  /// The kernels for x86 with the extensions AVX2 and FMA (2013 and later).
  template <int dim>
  RowKernels<dim>
  avx2_row_kernels();
#endif

  /// The fastest kernels for the processor at hand.
  template <int dim>
  RowKernels<dim>
  row_kernels();
} // namespace Viscoplastic
