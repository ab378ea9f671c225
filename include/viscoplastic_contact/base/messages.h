// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>

#include <exception>
#include <functional>
#include <set>
#include <string>

namespace Viscoplastic
{
  /// The message of an exception for the user, as one line, without the place
  /// in the code where it was thrown.
  std::string
  reason(const std::exception &exception);


  /// The message of the exception that is being handled, of whatever type: laws
  /// of shared libraries may throw anything. For use in `catch (...)'.
  std::string
  reason_of_current_exception();


  /// Do @p work, which is not collective, and throw on all ranks if it fails on
  /// some, with the reason() of the first of them: the ranks stay together, and
  /// a step can be tried again. Collective; throws ExcMessage.
  void
  fail_together(const MPI_Comm communicator, const std::function<void()> &work);


  /// Ids of boundaries or materials, separated by commas.
  std::string
  list(const std::set<unsigned int> &ids);

  /// A number for people, of at most so many digits.
  std::string
  number(const double value, const int digits = 5);
} // namespace Viscoplastic
