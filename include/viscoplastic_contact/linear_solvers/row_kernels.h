// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>

namespace Viscoplastic
{
  /// A block of a matrix in the registers of any processor: four numbers at a
  /// time, which are a row of a 3 x 3 block and zero, or both rows of a 2 x 2
  /// block.
  template <int dim, typename Number>
  struct PackedBlock
  {
    // Four doubles would be aligned as the options of each file have it.
    using FourNumbers
      __attribute__((vector_size(4 * sizeof(Number)), aligned(16))) = Number;

    static constexpr unsigned int n_parts = dim == 2 ? 1 : dim;

    FourNumbers parts[n_parts];
  };


  /// The data of products with rows of a matrix, as plain pointers: see
  /// SharedRows.
  template <int dim, typename Number>
  struct RowTable
  {
    /// A row without the diagonal: columns of lower owned nodes first, and
    /// where the values begin.
    struct Row
    {
      std::size_t  columns, values;
      unsigned int n_lower, n;
    };

    unsigned int                    n_rows;
    const Row                      *rows;
    const unsigned int             *columns;
    const PackedBlock<dim, Number> *values, *row_sums;
  };


  /// The innermost loops of multigrid, compiled for a kind of processor. See
  /// SharedRows.
  template <int dim, typename Number>
  struct RowKernels
  {
    using Table = RowTable<dim, Number>;
    using Block = PackedBlock<dim, Number>;

    void (*vmult)(const Table &A, Number *y, const Number *x);
    void (*residual)(const Table  &A,
                     Number       *r,
                     const Number *x,
                     const Number *b);
    void (*smooth_forward_from_zero)(const Table  &A,
                                     const Block  *inverse,
                                     Number       *x,
                                     const Number *b);
    void (*smooth_backward)(const Table  &A,
                            const Block  *inverse,
                            Number       *x,
                            const Number *b);
  };

  /// The kernels for any processor that the program runs on.
  template <int dim, typename Number>
  RowKernels<dim, Number>
  portable_row_kernels();

#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS
  /// The kernels for x86 with the extensions AVX2 and FMA (2013 and later).
  template <int dim, typename Number>
  RowKernels<dim, Number>
  avx2_row_kernels();
#endif

  /// Whether the processor at hand multiplies four doubles at a time.
  bool
  has_four_doubles();

  /// The fastest kernels for the processor at hand.
  template <int dim, typename Number>
  RowKernels<dim, Number>
  row_kernels();
} // namespace Viscoplastic
