// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>

#include <exception>
#include <set>
#include <string>

namespace Viscoplastic
{
  /**
   * What an exception says to the user as one line, without the place in the
   * code where it was thrown.
   */
  std::string
  reason(const std::exception &exception);


  /**
   * Throw on all ranks what some rank has met alone, so that they stay together
   * and a step can be tried again. @p failure is empty where all is well; the
   * first rank that has one speaks. Collective; throws ExcMessage.
   */
  void
  agree_on_failure(const std::string &failure, const MPI_Comm communicator);


  /// Ids of boundaries or materials, separated by commas.
  std::string
  list(const std::set<unsigned int> &ids);
} // namespace Viscoplastic
