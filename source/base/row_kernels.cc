// SPDX-License-Identifier: LGPL-2.1-or-later
#include "row_kernels_implementation.h"

namespace Viscoplastic
{
  template <int dim>
  RowKernels<dim>
  portable_row_kernels()
  {
    return kernels_of_this_file<dim>();
  }



  template <int dim>
  RowKernels<dim>
  row_kernels()
  {
#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
      return avx2_row_kernels<dim>();
#endif
    return portable_row_kernels<dim>();
  }



  template RowKernels<2>
  portable_row_kernels();
  template RowKernels<3>
  portable_row_kernels();
  template RowKernels<2>
  row_kernels();
  template RowKernels<3>
  row_kernels();
} // namespace Viscoplastic
