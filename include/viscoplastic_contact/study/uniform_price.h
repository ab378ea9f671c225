// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/study/study_analysis.h>

#include <string>

namespace Viscoplastic
{
  /// What an error costs with given meshes and steps, or why that is not known:
  /// a failure, or the sentence of a signal.
  struct UniformPrice
  {
    std::string        measure;
    WorkPrecisionModel model;
    Price              price;
    std::string        failure, interruption;
  };

  /**
   * The price of the error @p eps of the scene with given meshes and steps, by
   * its own strategy for meshes, from pilot runs: on coarser meshes with longer
   * steps, or, where the scene is small already, on finer ones; four of them, h
   * and k (or the tolerance of the steps) each halved alone and both. A mesh
   * that cannot be made coarser is the only one of two, beside a third run on
   * the next finer mesh where there is time for it. Finished ones are used
   * again. Where the run is worth @p seconds, this one and timing runs take no
   * longer than a share of them, see seconds_for_timing().
   *
   * Prints what it makes and finds. The price keeps a reference to @p runs.
   * Collective.
   */
  UniformPrice
  price_with_given_meshes(StudyRuns   &runs,
                          const double eps,
                          const double seconds,
                          Console     &console);
} // namespace Viscoplastic
