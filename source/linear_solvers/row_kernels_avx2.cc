// SPDX-License-Identifier: LGPL-2.1-or-later

// This file alone is compiled for AVX2 and FMA; elsewhere it is empty.

#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS

#  include "row_kernels_implementation.h"

namespace Viscoplastic
{
  template <int dim, typename Number>
  RowKernels<dim, Number>
  avx2_row_kernels()
  {
    return kernels_of_this_file<dim, Number>();
  }



  template RowKernels<2, float>
  avx2_row_kernels();
  template RowKernels<3, float>
  avx2_row_kernels();
  template RowKernels<2, double>
  avx2_row_kernels();
  template RowKernels<3, double>
  avx2_row_kernels();
} // namespace Viscoplastic

#endif
