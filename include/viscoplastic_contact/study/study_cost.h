// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/study_fit.h>

#include <limits>
#include <vector>

namespace Viscoplastic
{
  // What a ladder of runs says of cost: powers of the number of unknowns in
  // seconds and memory. Pure functions of numbers.

  /// What one run has cost.
  struct CostSample
  {
    double dofs, steps, n_set_ups;
    /// Of all set-ups, and of all.
    double set_up_seconds, seconds;
    double memory; // MB
  };


  /**
   * seconds = n_set_ups s(dofs) + steps r(dofs), memory = m(dofs), where s, r
   * and m have the form c_1 dofs^a + c_2.
   */
  struct CostModel
  {
    TwoPowers set_up, step, memory_model;
    /// seconds = c dofs^a steps, for comparison.
    TwoPowers simple;
    /// Of log(predicted/measured seconds), and the largest factor between.
    double       rms          = std::numeric_limits<double>::quiet_NaN();
    double       worst_factor = 1.;
    unsigned int worst_sample = 0;
    unsigned int n_samples    = 0;

    double
    seconds(const double dofs,
            const double steps,
            const double n_set_ups = 1.) const;

    double
    memory(const double dofs) const
    {
      return memory_model(dofs, 1.);
    }
  };

  /// @p dim decides what is believed of sparse factors: dofs log(dofs) entries
  /// in 2D, dofs^(4/3) in 3D.
  CostModel
  fit_cost(const std::vector<CostSample> &samples, const unsigned int dim);
} // namespace Viscoplastic
