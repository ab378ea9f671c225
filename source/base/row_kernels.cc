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
  SymmetricProduct<dim>
  portable_product()
  {
    return multiply<dim>;
  }



#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS
  namespace
  {
    bool
    has_four_doubles()
    {
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    }
  } // namespace
#endif



  template <int dim>
  RowKernels<dim>
  row_kernels()
  {
#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS
    if (has_four_doubles())
      return avx2_row_kernels<dim>();
#endif
    return portable_row_kernels<dim>();
  }



  template <int dim>
  SymmetricProduct<dim>
  symmetric_product()
  {
#ifdef VISCOPLASTIC_CONTACT_HAS_AVX2_KERNELS
    if (has_four_doubles())
      return avx2_product<dim>();
#endif
    return portable_product<dim>();
  }



  template RowKernels<2>
  portable_row_kernels();
  template RowKernels<3>
  portable_row_kernels();

  template RowKernels<2>
  row_kernels();
  template RowKernels<3>
  row_kernels();

  template SymmetricProduct<2>
  portable_product<2>();
  template SymmetricProduct<3>
  portable_product<3>();

  template SymmetricProduct<2>
  symmetric_product<2>();
  template SymmetricProduct<3>
  symmetric_product<3>();
} // namespace Viscoplastic
