// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/row_kernels.h>

// The loops of RowKernels, for files that compile them for a kind of processor
// each. All of it is local to its file and nothing comes from a library: a
// function that two files share would be that of either processor.
//
// Vectors are passed by reference, since conventions for values differ between
// processors.

#define VISCOPLASTIC_CONTACT_INLINE __attribute__((always_inline)) inline

namespace Viscoplastic
{
  namespace
  {
    template <int dim, typename Number>
    using FourNumbers = typename PackedBlock<dim, Number>::FourNumbers;



    /// The components of a node, twice in 2D.
    template <int dim, typename Number>
    VISCOPLASTIC_CONTACT_INLINE void
    load(const Number *const x, FourNumbers<dim, Number> &y)
    {
      if constexpr (dim == 2)
        y = FourNumbers<dim, Number>{x[0], x[1], x[0], x[1]};
      else
        y = FourNumbers<dim, Number>{x[0], x[1], x[2], Number()};
    }



    /// sum := sum + block times y; each component is still to be added up.
    template <int dim, typename Number>
    VISCOPLASTIC_CONTACT_INLINE void
    add_product(const PackedBlock<dim, Number> &a,
                const FourNumbers<dim, Number> &y,
                PackedBlock<dim, Number>       &sum)
    {
      for (unsigned int p = 0; p < a.n_parts; ++p)
        sum.parts[p] += a.parts[p] * y;
    }



    template <int dim, typename Number>
    VISCOPLASTIC_CONTACT_INLINE Number
    component(const PackedBlock<dim, Number> &sum, const unsigned int d)
    {
      if constexpr (dim == 2)
        return sum.parts[0][2 * d] + sum.parts[0][2 * d + 1];
      else
        return sum.parts[d][0] + sum.parts[d][1] + sum.parts[d][2];
    }



    /// product := sum over the diagonal and the first n neighbors of row i.
    template <int dim, typename Number>
    VISCOPLASTIC_CONTACT_INLINE void
    multiply_row(const RowTable<dim, Number> &A,
                 const unsigned int           i,
                 const unsigned int           n,
                 const Number                *x,
                 PackedBlock<dim, Number>    &product)
    {
      // (sum_j A_ij) x_i + sum A_ij (x_j - x_i): of a smooth x the products
      // cancel otherwise, all the more in long thin cells, and with them the
      // digits that single precision has.
      //
      // In 2D two sums at a time: a single one waits for each addition, and a
      // sweep for each node.
      const PackedBlock<dim, Number> *const a = A.values + A.rows[i].values;
      const unsigned int *const column        = A.columns + A.rows[i].columns;
      PackedBlock<dim, Number>  other         = {};
      FourNumbers<dim, Number>  here, there;
      load<dim>(x + i * dim, here);
      product = PackedBlock<dim, Number>{};
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
    template <int dim, typename Number>
    VISCOPLASTIC_CONTACT_INLINE void
    relax(const PackedBlock<dim, Number> &D,
          const Number *const             b,
          const PackedBlock<dim, Number> &product,
          Number *const                   x)
    {
      const Number r0 = b[0] - component(product, 0),
                   r1 = b[1] - component(product, 1);
      FourNumbers<dim, Number> rest;
      if constexpr (dim == 2)
        rest = FourNumbers<dim, Number>{r0, r1, r0, r1};
      else
        rest = FourNumbers<dim, Number>{r0,
                                        r1,
                                        b[2] - component(product, 2),
                                        Number()};
      PackedBlock<dim, Number> sum = {};
      add_product(D, rest, sum);
      for (unsigned int d = 0; d < dim; ++d)
        x[d] += component(sum, d);
    }



    template <int dim, typename Number>
    void
    vmult(const RowTable<dim, Number> &A, Number *y, const Number *x)
    {
      PackedBlock<dim, Number> product;
      for (unsigned int i = 0; i < A.n_rows; ++i)
        {
          multiply_row(A, i, A.rows[i].n, x, product);
          for (unsigned int d = 0; d < dim; ++d)
            y[i * dim + d] = component(product, d);
        }
    }



    template <int dim, typename Number>
    void
    residual(const RowTable<dim, Number> &A,
             Number                      *r,
             const Number                *x,
             const Number                *b)
    {
      PackedBlock<dim, Number> product;
      for (unsigned int i = 0; i < A.n_rows; ++i)
        {
          multiply_row(A, i, A.rows[i].n, x, product);
          for (unsigned int d = 0; d < dim; ++d)
            r[i * dim + d] = b[i * dim + d] - component(product, d);
        }
    }



    template <int dim, typename Number>
    void
    smooth_forward_from_zero(const RowTable<dim, Number>    &A,
                             const PackedBlock<dim, Number> *inverse,
                             Number                         *x,
                             const Number                   *b)
    {
      PackedBlock<dim, Number> product;
      for (unsigned int i = 0; i < A.n_rows; ++i)
        {
          // What comes later is still zero, and so are other ranks' nodes.
          for (unsigned int d = 0; d < dim; ++d)
            x[i * dim + d] = Number();
          multiply_row(A, i, A.rows[i].n_lower, x, product);
          relax(inverse[i], b + i * dim, product, x + i * dim);
        }
    }



    template <int dim, typename Number>
    void
    smooth_backward(const RowTable<dim, Number>    &A,
                    const PackedBlock<dim, Number> *inverse,
                    Number                         *x,
                    const Number                   *b)
    {
      PackedBlock<dim, Number> product;
      for (unsigned int i = A.n_rows; i-- > 0;)
        {
          multiply_row(A, i, A.rows[i].n, x, product);
          relax(inverse[i], b + i * dim, product, x + i * dim);
        }
    }



    template <int dim, typename Number>
    RowKernels<dim, Number>
    kernels_of_this_file()
    {
      return {vmult<dim, Number>,
              residual<dim, Number>,
              smooth_forward_from_zero<dim, Number>,
              smooth_backward<dim, Number>};
    }
  } // namespace
} // namespace Viscoplastic

#undef VISCOPLASTIC_CONTACT_INLINE
