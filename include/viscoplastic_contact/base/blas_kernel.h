// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace Viscoplastic
{
  /**
   * OpenBLAS falls back to kernels without vector instructions on processors
   * younger than itself. What to do about that, or an empty string.
   */
  std::string
  advice_on_blas_kernel();
} // namespace Viscoplastic
