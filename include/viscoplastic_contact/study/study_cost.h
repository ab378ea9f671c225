// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/solver_choice.h>
#include <viscoplastic_contact/study/study_fit.h>

#include <map>
#include <vector>

namespace Viscoplastic
{
  // What the runs of a study say of cost: powers of the number of unknowns in
  // seconds and memory, for each linear solver by itself. Pure functions of
  // numbers.

  /// What one run has cost.
  struct CostSample
  {
    SolverDemand demand;
    double       steps, n_set_ups;
    /// Of all set-ups together, and of the whole run.
    double set_up_seconds, seconds;
    double memory; // MB
  };


  /**
   * seconds = n_set_ups s(dofs) + steps r(dofs), where s and r have the form
   * c_1 dofs^a + c_2 and are those of the solver that a run would have. Where
   * the runs do not tell the exponent of that solver, or none has had it, s and
   * r are those of expected_cost() times the factor by which the largest run
   * with it, or the largest of all, differs from them.
   */
  struct CostModel
  {
    struct SolverModel
    {
      TwoPowers set_up, step;
      /// The most unknowns of any run.
      double largest;
    };

    std::map<BulkSolverKind, SolverModel> solvers;
    /// That of the largest run.
    SolverDemand demand;
    /// In MB, what expected_memory() does not know of.
    TwoPowers other_memory;
    /// That of the seconds, of the memory, and of seconds = c dofs^a steps.
    Misfit    misfit, memory_misfit;
    TwoPowers simple;

    /// What would decide on the solver of a run.
    SolverDemand
    demand_at(const double dofs,
              const double steps,
              const double n_set_ups = 1.) const;

    double
    seconds(const double dofs,
            const double steps,
            const double n_set_ups = 1.) const;

    /// In MB.
    double
    memory(const double dofs,
           const double steps,
           const double n_set_ups = 1.) const;
  };

  /// The model of these runs; without any, seconds() and memory() are zero.
  CostModel
  fit_cost(const std::vector<CostSample> &samples);
} // namespace Viscoplastic
