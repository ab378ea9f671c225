// SPDX-License-Identifier: LGPL-2.1-or-later
#include "folder.h"
#include <viscoplastic_contact/results/run_phases.h>
#include <viscoplastic_contact/results/statistics.h>
#include <viscoplastic_contact/study/study_record.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace
{
  using namespace Viscoplastic;



  /// A table of three rows in which each phase that it may have takes seconds
  /// of its own: powers of two, whose sums are exact and tell who is missing.
  Viscoplastic::Table
  table_of_all_phases()
  {
    Viscoplastic::Table table;
    const auto          add = [&](const std::string &name, const double value) {
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
    const auto      table = table_of_all_phases();
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
    // The pilot run, the first mesh, later ones.
    EXPECT_EQ(record.number("seconds_set_up"), 0.75);

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
    auto table = table_of_all_phases();
    for (const char *name : {"wall_tangent", "wall_estimate"})
      table.columns.erase(name);
    RunMeasurements measurements;
    measurements.seconds["estimate"] = 3.;
    const RunRecord record           = make_record({}, table, measurements);
    EXPECT_EQ(record.number("seconds_tangent"), 0.);
    EXPECT_EQ(record.number("seconds_estimate"), 3.);
  }



  RunRecord
  record_of_any_numbers()
  {
    RunRecord record;
    record.name    = "a \"run\"";
    record.key     = {{MeshStrategy::adaptive, "backward Euler", "cell means"},
                      -1,
                      2};
    record.stamp   = {{"ranks", "2"}, {"scene", "17"}};
    record.numbers = {{"h", 1. / 3.},
                      {"steps", 12.},
                      {"error_h1", std::nan("")},
                      {"step_limit", std::numeric_limits<double>::infinity()}};
    // In this order, which is not that of the alphabet.
    record.quantities = {{"slip_area", 1e-300}, {"point0_x", -M_PI}};
    return record;
  }



  TEST(StudyRecord, TextHasAllDigitsAndTheOrderOfQuantities)
  {
    const RunRecord record = record_of_any_numbers();
    const RunRecord found  = from_json(to_json(record), "result.json");
    EXPECT_EQ(found.name, record.name);
    EXPECT_TRUE(found.key == record.key);
    EXPECT_EQ(found.stamp, record.stamp);
    EXPECT_EQ(found.quantities, record.quantities);
    EXPECT_EQ(found.numbers.size(), record.numbers.size());
    EXPECT_EQ(found.number("h"), 1. / 3.);
    EXPECT_EQ(found.number("steps"), 12.);
    // JSON has no other numbers than finite ones.
    EXPECT_TRUE(std::isnan(found.number("error_h1")));
    EXPECT_TRUE(std::isnan(found.number("step_limit")));
  }



  TEST(StudyRecord, OtherTextIsRefusedByTheNameOfItsFile)
  {
    const std::string text = to_json(record_of_any_numbers());
    const auto        with = [&text](const std::string &what,
                              const std::string &instead) {
      std::string other = text;
      return other.replace(other.find(what), what.size(), instead);
    };
    for (const std::string &other : {std::string(),
                                     std::string("[1, 2]"),
                                     text.substr(0, text.size() / 2),
                                     with("\"mesh_level\"", "\"level\""),
                                     with("-1", "\"one\""),
                                     with("12.0", "true"),
                                     with("\"17\"", "17"),
                                     with("adaptive", "adoptive"),
                                     with("12.0", "1e999")})
      try
        {
          from_json(other, "place/result.json");
          ADD_FAILURE() << "was accepted:\n" << other;
        }
      catch (const std::exception &exception)
        {
          EXPECT_NE(std::string(exception.what())
                      .find("'place/result.json' is no record"),
                    std::string::npos)
            << exception.what();
        }
  }



  /// A table of a scene with units is read, and goes on, by the names of its
  /// columns.
  TEST(StudyRecord, TablesWithUnits)
  {
    const Testing::Folder folder;
    const std::string     file = folder.add("statistics.csv", "");
    {
      Statistics table(file, [](const std::string &column) {
        return column == "t" ? " [day]" : "";
      });
      for (const int n : {0, 1})
        {
          table.add("step", n);
          table.add("t", 2. * n);
          table.end_row();
        }
    }
    {
      Statistics table(file, /* last_step = */ 1);
      table.add("step", 2);
      table.add("t", 5.);
      table.end_row();
      table.add("step", 3);
      table.add("k", 5.);
      EXPECT_THROW(table.end_row(), std::exception); // another column
    }
    const Viscoplastic::Table table = read_table(file);
    EXPECT_EQ(table.names, (std::vector<std::string>{"step", "t"}));
    EXPECT_EQ(table.columns.at("t"), (std::vector<double>{0., 2., 5.}));
    std::string header;
    std::getline(std::ifstream(file) >> std::ws, header);
    EXPECT_EQ(header, "step,t [day]");
  }
} // namespace
