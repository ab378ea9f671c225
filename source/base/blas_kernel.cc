// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/blas_kernel.h>

#include <dlfcn.h>

namespace Viscoplastic
{
  std::string
  advice_on_blas_kernel()
  {
#if defined(__x86_64__) && defined(__GNUC__)
    // Asked at run time: which BLAS is linked is the system's choice.
    using GetCoreName        = const char *(*)();
    const auto get_core_name = reinterpret_cast<GetCoreName>(
      dlsym(RTLD_DEFAULT, "openblas_get_corename"));
    if (get_core_name == nullptr || !__builtin_cpu_supports("avx2"))
      return "";
    const std::string kernel = get_core_name();
    if (kernel == "Prescott" || kernel == "Core2" || kernel == "Nehalem")
      return "OpenBLAS does not know this processor and runs its " + kernel +
             " kernels; the environment variable OPENBLAS_CORETYPE=" +
             (__builtin_cpu_supports("avx512vl") ? "SkylakeX" : "Haswell") +
             " makes factorisations several times faster.";
#endif
    return "";
  }
} // namespace Viscoplastic
