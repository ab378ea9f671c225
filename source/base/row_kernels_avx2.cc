// SPDX-License-Identifier: LGPL-2.1-or-later

// This file alone is compiled for AVX2 and FMA; elsewhere it is empty.

#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS

#  include "row_kernels_implementation.h"

namespace Viscoplastic
{
  template <int dim>
  RowKernels<dim>
  avx2_row_kernels()
  {
    return kernels_of_this_file<dim>();
  }



  template <int dim>
  SymmetricProduct<dim>
  avx2_product()
  {
    return multiply<dim>;
  }



  template RowKernels<2>
  avx2_row_kernels();
  template RowKernels<3>
  avx2_row_kernels();

  template SymmetricProduct<2>
  avx2_product<2>();
  template SymmetricProduct<3>
  avx2_product<3>();
} // namespace Viscoplastic

#endif
