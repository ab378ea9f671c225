// SPDX-License-Identifier: LGPL-2.1-or-later
#include "row_kernels_implementation.h"

namespace Viscoplastic
{
  template <int dim, typename Number>
  RowKernels<dim, Number>
  portable_row_kernels()
  {
    return kernels_of_this_file<dim, Number>();
  }



  bool
  has_four_doubles()
  {
#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
  }



  template <int dim, typename Number>
  RowKernels<dim, Number>
  row_kernels()
  {
#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS
    if (has_four_doubles())
      return avx2_row_kernels<dim, Number>();
#endif
    return portable_row_kernels<dim, Number>();
  }



  template RowKernels<2, float>
  portable_row_kernels();
  template RowKernels<3, float>
  portable_row_kernels();
  template RowKernels<2, double>
  portable_row_kernels();
  template RowKernels<3, double>
  portable_row_kernels();

  template RowKernels<2, float>
  row_kernels();
  template RowKernels<3, float>
  row_kernels();
  template RowKernels<2, double>
  row_kernels();
  template RowKernels<3, double>
  row_kernels();
} // namespace Viscoplastic
