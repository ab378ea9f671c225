// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/row_kernels.h>

// The loops of RowKernels, to be included by files that are each compiled for
// one kind of processor. Everything has internal linkage and no library is
// used: of an inline function in two files the linker would keep one copy, for
// either processor.
//
// Vectors are passed by reference, since the calling conventions for vector
// values differ between processors.

#define VISCOPLASTIC_CONTACT_INLINE __attribute__((always_inline)) inline

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    using FourNumbers = typename PackedBlock<dim>::FourNumbers;



    /// Load the components of a node, twice in 2D.
    template <int dim>
    VISCOPLASTIC_CONTACT_INLINE void
    load(const float *const x, FourNumbers<dim> &y)
    {
      if constexpr (dim == 2)
        y = FourNumbers<dim>{x[0], x[1], x[0], x[1]};
      else
        y = FourNumbers<dim>{x[0], x[1], x[2], 0.f};
    }



    /// sum := sum + block times y by entries; component() adds up rows.
    template <int dim>
    VISCOPLASTIC_CONTACT_INLINE void
    add_product(const PackedBlock<dim> &a,
                const FourNumbers<dim> &y,
                PackedBlock<dim>       &sum)
    {
      for (unsigned int p = 0; p < a.n_parts; ++p)
        sum.parts[p] += a.parts[p] * y;
    }



    template <int dim>
    VISCOPLASTIC_CONTACT_INLINE float
    component(const PackedBlock<dim> &sum, const unsigned int d)
    {
      if constexpr (dim == 2)
        return sum.parts[0][2 * d] + sum.parts[0][2 * d + 1];
      else
        return sum.parts[d][0] + sum.parts[d][1] + sum.parts[d][2];
    }



    /// product := product of row i with x, over the diagonal and the first n
    /// neighbors.
    template <int dim>
    VISCOPLASTIC_CONTACT_INLINE void
    multiply_row(const RowTable<dim> &A,
                 const unsigned int   i,
                 const unsigned int   n,
                 const float         *x,
                 PackedBlock<dim>    &product)
    {
      // Compute (sum_j A_ij) x_i + sum_j A_ij (x_j - x_i): for smooth x the
      // products A_ij x_j nearly cancel, especially in long thin cells, which
      // would lose the digits of single precision.
      //
      // In 2D two sums are used, since each addition to a single one would wait
      // for the previous addition.
      const PackedBlock<dim> *const a      = A.values + A.rows[i].values;
      const unsigned int *const     column = A.columns + A.rows[i].columns;
      PackedBlock<dim>              other  = {};
      FourNumbers<dim>              here, there;
      load<dim>(x + i * dim, here);
      product = PackedBlock<dim>{};
      add_product(A.row_sums[i], here, product);
      unsigned int e = 0;
      for (; e + 1 < n; e += 2)
        {
          load<dim>(x + column[e] * dim, there);
          there -= here;
          add_product(a[e], there, dim == 2 ? other : product);
          load<dim>(x + column[e + 1] * dim, there);
          there -= here;
          add_product(a[e + 1], there, product);
        }
      if (e < n)
        {
          load<dim>(x + column[e] * dim, there);
          there -= here;
          add_product(a[e], there, product);
        }
      if (dim == 2)
        product.parts[0] += other.parts[0];
    }



    /// x := x + D (b - product), for the components of a node.
    template <int dim>
    VISCOPLASTIC_CONTACT_INLINE void
    relax(const PackedBlock<dim> &D,
          const float *const      b,
          const PackedBlock<dim> &product,
          float *const            x)
    {
      const float r0 = b[0] - component(product, 0),
                  r1 = b[1] - component(product, 1);
      FourNumbers<dim> rest;
      if constexpr (dim == 2)
        rest = FourNumbers<dim>{r0, r1, r0, r1};
      else
        rest = FourNumbers<dim>{r0, r1, b[2] - component(product, 2), 0.f};
      PackedBlock<dim> sum = {};
      add_product(D, rest, sum);
      for (unsigned int d = 0; d < dim; ++d)
        x[d] += component(sum, d);
    }



    template <int dim>
    void
    residual(const RowTable<dim> &A, float *r, const float *x, const float *b)
    {
      PackedBlock<dim> product;
      for (unsigned int i = 0; i < A.n_rows; ++i)
        {
          multiply_row(A, i, A.rows[i].n, x, product);
          for (unsigned int d = 0; d < dim; ++d)
            r[i * dim + d] = b[i * dim + d] - component(product, d);
        }
    }



    template <int dim>
    void
    smooth_forward_from_zero(const RowTable<dim>    &A,
                             const PackedBlock<dim> *inverse,
                             float                  *x,
                             const float            *b)
    {
      PackedBlock<dim> product;
      for (unsigned int i = 0; i < A.n_rows; ++i)
        {
          // x is still zero at later nodes and ghosts: skip those columns.
          for (unsigned int d = 0; d < dim; ++d)
            x[i * dim + d] = 0.f;
          multiply_row(A, i, A.rows[i].n_lower, x, product);
          relax(inverse[i], b + i * dim, product, x + i * dim);
        }
    }



    template <int dim>
    void
    smooth_backward(const RowTable<dim>    &A,
                    const PackedBlock<dim> *inverse,
                    float                  *x,
                    const float            *b)
    {
      PackedBlock<dim> product;
      for (unsigned int i = A.n_rows; i-- > 0;)
        {
          multiply_row(A, i, A.rows[i].n, x, product);
          relax(inverse[i], b + i * dim, product, x + i * dim);
        }
    }



    /// y := A x: the blocks of a row, and their transposes at owned columns.
    /// Without AVX2, scalar code is faster than vectors of four doubles.
    template <int dim>
    void
    multiply(const SymmetricRows &A,
             double *const __restrict y,
             const double *x)
    {
      for (unsigned int i = 0; i < A.n_rows * dim; ++i)
        y[i] = 0.;
      for (unsigned int i = 0; i < A.n_rows; ++i)
        {
          const double *const of_row = x + i * dim;
          const double       *block = A.values + A.first_block[i] * (dim * dim);
          const std::size_t   begin = A.begin[i], end = A.begin[i + 1];
#ifdef __AVX2__
          using Four __attribute__((vector_size(32), aligned(8))) = double;
          Four sums[dim] = {}, factor[dim];
          for (unsigned int c = 0; c < dim; ++c)
            factor[c] = dim == 2 ?
                          Four{of_row[0], of_row[0], of_row[1], of_row[1]} :
                          Four{of_row[c], of_row[c], of_row[c], 0.};
          for (std::size_t e = begin; e < end; ++e, block += dim * dim)
            {
              const unsigned int j        = A.columns[e];
              const double      *at       = x + j * dim;
              double            *to       = y + j * dim;
              const bool         is_owned = e > begin && j < A.n_rows;
              if constexpr (dim == 2)
                {
                  const Four all{block[0], block[1], block[2], block[3]};
                  sums[0] += all * Four{at[0], at[1], at[0], at[1]};
                  if (!is_owned)
                    continue;
                  const Four products = all * factor[0];
                  to[0] += products[0] + products[2];
                  to[1] += products[1] + products[3];
                }
              else
                {
                  const Four there{at[0], at[1], at[2], 0.};
                  Four       products{};
                  for (unsigned int c = 0; c < dim; ++c)
                    {
                      const Four row{block[3 * c],
                                     block[3 * c + 1],
                                     block[3 * c + 2],
                                     c < 2 ? block[3 * c + 3] : 0.};
                      sums[c] += row * there;
                      products += row * factor[c];
                    }
                  for (unsigned int d = 0; d < dim && is_owned; ++d)
                    to[d] += products[d];
                }
            }
          for (unsigned int c = 0; c < dim; ++c)
            y[i * dim + c] += dim == 2 ?
                                sums[0][2 * c] + sums[0][2 * c + 1] :
                                sums[c][0] + sums[c][1] + sums[c][dim - 1];
#else
          double sum[dim] = {};
          for (std::size_t e = begin; e < end; ++e, block += dim * dim)
            {
              const unsigned int j = A.columns[e];
              for (unsigned int c = 0; c < dim; ++c)
                for (unsigned int d = 0; d < dim; ++d)
                  sum[c] += block[c * dim + d] * x[j * dim + d];
              if (e > begin && j < A.n_rows)
                for (unsigned int c = 0; c < dim; ++c)
                  for (unsigned int d = 0; d < dim; ++d)
                    y[j * dim + d] += block[c * dim + d] * of_row[c];
            }
          for (unsigned int c = 0; c < dim; ++c)
            y[i * dim + c] += sum[c];
#endif
        }
    }



    template <int dim>
    RowKernels<dim>
    kernels_of_this_file()
    {
      return {residual<dim>,
              smooth_forward_from_zero<dim>,
              smooth_backward<dim>,
              multiply<dim>};
    }
  } // namespace
} // namespace Viscoplastic

#undef VISCOPLASTIC_CONTACT_INLINE
