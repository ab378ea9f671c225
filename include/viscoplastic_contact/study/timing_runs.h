// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/study/study_analysis.h>

#include <algorithm>

namespace Viscoplastic
{
  /// Runs that only tell what they cost, and the sentence of a signal that has
  /// ended them, if one has.
  struct TimingRuns
  {
    std::vector<RunRecord> records;
    std::string            interruption;
  };

  /**
   * Time runs of one method variant on meshes that are finer than those of its
   * @p records, of which there must be one: each with half of the mesh width of
   * the one before, up to @p mesh_level, and with as many steps as a record has
   * and half of the seconds left allow. Prices of long runs go by these instead
   * of by extrapolation, and learn of solvers that small meshes do not have.
   * They end where the next one would take more than is left of @p seconds, or
   * half of the memory of this machine. Collective.
   */
  TimingRuns
  make_timing_runs(const StudyRuns &runs,
                   const Records   &records,
                   const int        mesh_level,
                   const double     seconds,
                   Console         &console);

  /// In MB, half of the memory of this machine.
  double
  affordable_memory();

  /// The seconds for make_timing_runs(): as many as the runs have taken that
  /// there are, or a tenth of those of the run that is to be priced, but one at
  /// least.
  inline double
  seconds_for_timing(const double spent, const double price)
  {
    return std::max({1., spent, price / 10.});
  }
} // namespace Viscoplastic
