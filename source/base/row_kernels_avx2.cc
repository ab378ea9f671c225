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



  template RowKernels<2>
  avx2_row_kernels();
  template RowKernels<3>
  avx2_row_kernels();

} // namespace Viscoplastic

#endif
