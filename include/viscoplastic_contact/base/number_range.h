// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/messages.h>

/// Energies, norms and estimates of errors are made of squares, which leave the
/// range of floating-point numbers long before the numbers themselves do: the
/// square of 1e-170 is zero. A run whose largest displacement, stress or force
/// is that small would report energies of zero, and one of 1e170 infinite ones.
/// Such runs are refused, but not a few small steps in an ordinary run.
namespace Viscoplastic
{
  /// The permitted size of the solution (displacement, force, stress). Squares
  /// of errors that are 1e-10 of it are still normal numbers.
  constexpr double least_size = 1e-120, largest_size = 1e120;
  /// Elastic moduli: cubes of matrix entries are still normal numbers.
  constexpr double least_modulus = 1e-70, largest_modulus = 1e70;
  /// The sizes of the body and of its cells, and times and time steps.
  constexpr double least_length = 1e-30, largest_length = 1e30;
  constexpr double least_time = 1e-30, largest_time = 1e30;


  /// Throw ExcMessage unless a value lies in a range.
  inline void
  require_in_range(const std::string &what,
                   const double       value,
                   const double       least,
                   const double       largest)
  {
    if (!(value >= least && value <= largest))
      refuse(what + " is " + as_text(value) + "; it must lie between " +
             as_text(least) + " and " + as_text(largest) +
             ", where squares stay within the range of floating-point "
             "numbers; choose other units or look for a datum that is too "
             "large or too small.");
  }


  /// Return the norm of a tensor or vector even if squares of its entries
  /// overflow or underflow; otherwise the result is norm(), bit by bit.
  template <typename TensorType>
  double
  stable_norm(const TensorType &tensor)
  {
    const double norm = tensor.norm();
    if (norm > 1e-140 && norm < 1e140)
      return norm;
    // Scaling by a power of two changes no digit.
    constexpr double factor = 0x1p+600;
    return norm < 1. ? (tensor * factor).norm() / factor :
                       (tensor / factor).norm() * factor;
  }
} // namespace Viscoplastic
