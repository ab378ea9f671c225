// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/pilot_runs.h>

#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  const char *const no_error_to_go_by =
    "--price needs an error to go by, but the pilot runs know none: neither an "
    "error bar nor an exact solution has given one.";



  double
  PilotRuns::seconds() const
  {
    double sum = 0.;
    for (const RunRecord &record : records)
      sum += record.number("seconds_total");
    return sum;
  }



  bool
  add_pilot_run(const StudyRuns &runs,
                const RunKey    &key,
                Console         &console,
                PilotRuns       &pilots)
  {
    StudyRuns::Outcome outcome;
    outcome.record = runs.find(key);
    if (!outcome.record)
      {
        console.show_status("Pilot run " + runs.name(key));
        outcome = runs.make(key);
      }
    pilots.failure      = outcome.failure;
    pilots.interruption = outcome.interruption;
    if (!outcome.record)
      return false;
    pilots.records.push_back(*outcome.record);
    return true;
  }



  std::string
  in_words(const std::vector<RunRecord> &records, const std::string &measure)
  {
    std::ostringstream text;
    for (const RunRecord &record : records)
      {
        text << "  " << record.name << ": "
             << std::lround(record.number("cells")) << " cells, "
             << record.number("steps") << " steps, ";
        if (!measure.empty())
          text << "error " << digits(error_of(record, measure, nullptr))
               << ", ";
        text << seconds_in_words(record.number("seconds_total"))
             << (measure.empty() ? ", for its cost alone\n" : "\n");
      }
    return text.str();
  }
} // namespace Viscoplastic
