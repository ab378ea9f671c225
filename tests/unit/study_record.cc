// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/results/run_phases.h>
#include <viscoplastic_contact/study/study_record.h>

#include <gtest/gtest.h>

#include <numeric>
#include <set>

namespace
{
  using namespace Viscoplastic;



  /// A table of three rows in which each phase that it may have takes seconds
  /// of its own: powers of two, whose sums are exact and tell who is missing.
  Table
  table_of_all_phases()
  {
    Table      table;
    const auto add = [&](const std::string &name, const double value) {
      table.names.push_back(name);
      table.columns[name] = {value, 2. * value, 4. * value};
    };
    for (const char *name : {"step", "k", "cells", "dofs"})
      add(name, 1.);
    double seconds = 1. / 1024.;
    for (const RunPhase &phase : run_phases)
      if (phase.is_in_statistics)
        add("wall_" + phase.name, seconds *= 8.);
    add("wall_total", seconds *= 8.);
    return table;
  }



  double
  sum(const std::vector<double> &values)
  {
    return std::accumulate(values.begin(), values.end(), 0.);
  }



  TEST(StudyRecord, SecondsOfAllPhasesAndTheRestAreThoseOfTheRun)
  {
    const Table     table = table_of_all_phases();
    RunMeasurements measurements;
    double          outside = 0.;
    for (const RunPhase &phase : run_phases)
      {
        // What the table has counts, not the timer of a resumed run.
        measurements.seconds[phase.name] = phase.is_in_statistics ? 1e6 : 0.25;
        if (!phase.is_cost)
          outside += phase.is_in_statistics ?
                       sum(table.columns.at("wall_" + phase.name)) :
                       0.25;
      }
    const RunRecord record = make_record({}, table, measurements);

    for (const std::string &name : table.names)
      if (name.rfind("wall_", 0) == 0 && name != "wall_total")
        {
          EXPECT_EQ(record.number("seconds_" + name.substr(5)),
                    sum(table.columns.at(name)))
            << name;
        }
    EXPECT_EQ(record.number("seconds_set_up"), 0.5); // of all meshes

    std::set<std::string> columns;
    for (const RunPhase &phase : run_phases)
      columns.insert(phase.study_column);
    double all = 0.;
    for (const std::string &column : columns)
      all += record.number(column);
    const double run = table.columns.at("wall_total").back();
    EXPECT_GT(record.number("seconds_rest"), 0.);
    EXPECT_EQ(all + record.number("seconds_rest"), run);
    EXPECT_EQ(record.number("seconds_total"), run - outside);
  }



  /// Explicit schemes have no tangents, and without an error bar only adaptive
  /// runs estimate.
  TEST(StudyRecord, PhasesThatTheTableLacksAreThoseOfTheTimer)
  {
    Table table = table_of_all_phases();
    for (const char *name : {"wall_tangent", "wall_estimate"})
      table.columns.erase(name);
    RunMeasurements measurements;
    measurements.seconds["estimate"] = 3.;
    const RunRecord record           = make_record({}, table, measurements);
    EXPECT_EQ(record.number("seconds_tangent"), 0.);
    EXPECT_EQ(record.number("seconds_estimate"), 3.);
  }
} // namespace
