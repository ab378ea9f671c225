// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/study_fit.h>

#include <vector>

namespace Viscoplastic
{
  // What the runs of a study say of cost: powers of the number of unknowns in
  // seconds and memory. Pure functions of numbers.

  /// What one run has cost.
  struct CostSample
  {
    double dofs, steps, n_set_ups;
    /// Of all set-ups together, and of the whole run.
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
    /// That of the seconds.
    Misfit misfit;

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

  /// How often a run of @p steps is set up, once for each of its meshes: there
  /// is a new one after @p steps_per_mesh, or never if that is 0.
  double
  number_of_set_ups(const double steps, const double steps_per_mesh);
} // namespace Viscoplastic
