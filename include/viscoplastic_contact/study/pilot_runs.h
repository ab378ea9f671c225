// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/study/study_analysis.h>

namespace Viscoplastic
{
  /// Short runs before a long one, and why there are not all of them: a failure
  /// of the scene, or the sentence of a signal.
  struct PilotRuns
  {
    std::vector<RunRecord> records;
    std::string            failure, interruption;

    Records
    all() const
    {
      Records result;
      for (const RunRecord &record : records)
        result.push_back(&record);
      return result;
    }

    double
    seconds() const;
  };

  /// Add the run of @p key, which is computed unless it is finished already.
  /// Returns whether there is one. Collective.
  bool
  add_pilot_run(const StudyRuns &runs,
                const RunKey    &key,
                Console         &console,
                PilotRuns       &pilots);

  /// Runs that have been made, a line each. Without a @p measure they have no
  /// error, and only tell what they cost.
  std::string
  in_words(const std::vector<RunRecord> &records, const std::string &measure);

  /// The sentence for pilot runs that do not know what their errors are.
  extern const char *const no_error_to_go_by;
} // namespace Viscoplastic
