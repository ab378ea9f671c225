// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/timing_runs.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  double
  affordable_memory()
  {
    return 0.5e-6 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<double>(sysconf(_SC_PAGESIZE));
  }



  TimingRuns
  make_timing_runs(const StudyRuns &runs,
                   const Records   &records,
                   const int        mesh_level,
                   const double     seconds,
                   Console         &console)
  {
    TimingRuns result;
    RunKey     key   = records.front()->key;
    key.is_timing    = true;
    int fewest_steps = key.time_level, most_steps = key.time_level;
    for (const RunRecord *record : records)
      {
        key.mesh_level = std::max(key.mesh_level, record->key.mesh_level);
        fewest_steps   = std::min(fewest_steps, record->key.time_level);
        most_steps     = std::max(most_steps, record->key.time_level);
      }

    Records known = records;
    result.records.reserve(std::max(0, mesh_level - key.mesh_level));
    double left = seconds;
    while (++key.mesh_level <= mesh_level)
      {
        const CostModel cost = cost_of(known);
        const double    dofs = std::pow(2., runs.scene.dimension) *
                            static_cast<double>(cost.demand.n_dofs);
        StudyRuns::Outcome outcome;
        double             expected = 0., memory = 0.;
        // As many steps as half of the seconds allow: long steps take more
        // iterations than those of the run that is priced.
        for (key.time_level = most_steps;; --key.time_level)
          {
            const double steps = expected_steps(runs, known, key);
            const double n_set_ups =
              runs.n_set_ups(key.variant.strategy,
                             steps,
                             n_steps(runs.phases_of(key)));
            expected       = cost.seconds(dofs, steps, n_set_ups);
            memory         = cost.memory(dofs, steps, n_set_ups);
            outcome.record = runs.find(key);
            if (outcome.record || expected <= 0.5 * left ||
                key.time_level == fewest_steps)
              break;
          }
        if (!outcome.record)
          {
            if (expected > left || memory > affordable_memory())
              break;
            console.show_status("Timing run " + runs.name(key) + ", about " +
                                seconds_in_words(expected));
            outcome = runs.make(key);
          }
        result.interruption = outcome.interruption;
        if (!outcome.record) // what fails tells nothing
          break;
        left -= outcome.record->number("seconds_total");
        result.records.push_back(*outcome.record);
        known.push_back(&result.records.back());
      }
    return result;
  }
} // namespace Viscoplastic
