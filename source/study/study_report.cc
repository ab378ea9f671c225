// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/results/run_phases.h>
#include <viscoplastic_contact/study/study_report.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// Of sizes and cost.
    std::vector<std::string>
    number_columns()
    {
      std::vector<std::string> columns{
        "h", "k", "cells", "dofs", "steps", "seconds_total"};
      for (const RunPhase &phase : run_phases)
        if (std::find(columns.begin(), columns.end(), phase.study_column) ==
            columns.end())
          columns.push_back(phase.study_column);
      for (const char *column : {"seconds_rest",
                                 "peak_memory_MB",
                                 "contact_iterations",
                                 "linear_iterations"})
        columns.push_back(column);
      return columns;
    }



    std::string
    kind_of_reference(const Study &study)
    {
      return study.has_exact_solution ? "exact" : "finest run";
    }



    /// Names of the quantities of interest.
    std::vector<std::string>
    quantities(const Study &study)
    {
      std::vector<std::string> result;
      for (const auto &entry : study.records()[0]->quantities)
        result.push_back(entry.first);
      return result;
    }



    // ----------------------------------------------------------------- csv

    std::string
    csv(const Study &study)
    {
      std::ostringstream       text;
      std::vector<std::string> columns = number_columns();
      columns.insert(columns.end(), field_errors.begin(), field_errors.end());
      columns.insert(columns.end(),
                     estimate_parts.begin(),
                     estimate_parts.end());
      columns.push_back("effectivity");
      text << "run,strategy,scheme,history,ladder,mesh_level,time_level";
      for (const std::string &column : columns)
        text << ',' << column;
      for (const std::string &name : quantities(study))
        text << ',' << name << ',' << name << "_error";
      text << std::setprecision(12) << '\n';
      for (const std::string ladder : {"space", "time", "both"})
        for (const PlannedRun &run : study.plan)
          if (run.record && run.ladders.count(ladder) > 0)
            {
              const RunRecord &record = *run.record;
              text << record.name << ',' << record.key.strategy << ','
                   << record.key.scheme << ',' << record.key.history << ','
                   << ladder << ',' << record.key.mesh_level << ','
                   << record.key.time_level;
              for (const std::string &column : columns)
                text << ',' << record.number(column);
              for (const std::string &name : quantities(study))
                text << ',' << record.quantity(name) << ','
                     << quantity_error(record, name, study.reference());
              text << '\n';
            }
      return text.str();
    }



    // ---------------------------------------------------------------- json

    std::string
    way_json(const RunKey &way)
    {
      std::ostringstream text;
      text << "{\"strategy\": " << std::quoted(way.strategy)
           << ", \"scheme\": " << std::quoted(way.scheme)
           << ", \"history\": " << std::quoted(way.history);
      return text.str();
    }



    std::string
    json(const Study &study, const bool is_finished)
    {
      std::ostringstream text;
      const Origin       from      = origin();
      const char        *separator = "";
      text << "{\n  \"scene\": "
           << std::quoted(
                std::filesystem::path(study.runs.scene.file).stem().string())
           << ",\n  \"version\": " << std::quoted(from.program)
           << ",\n  \"ranks\": " << from.n_ranks
           << ",\n  \"machine\": " << std::quoted(from.machine)
           << ",\n  \"date\": " << std::quoted(from.date)
           << ",\n  \"finished\": " << (is_finished ? "true" : "false")
           << ",\n  \"dimension\": " << study.runs.scene.dimension
           << ",\n  \"reference\": " << std::quoted(kind_of_reference(study))
           << ",\n  \"reference_run\": "
           << std::quoted(study.reference() ? study.reference()->name : "")
           << ",\n  \"budget\": " << json_number(study.parameters.budget)
           << ",\n  \"fits\": [";
      const auto ways = analyse(study);
      for (const WayResult &way : ways)
        {
          std::vector<std::string> measures = field_errors;
          measures.push_back("estimate_total");
          for (const std::string &name : quantities(study))
            measures.push_back(name + "_error");
          for (const std::string &measure : measures)
            {
              const TwoPowers fit =
                fit_measure(way.records, measure, study.reference());
              if (fit.n_samples < 3)
                continue;
              text << separator << "\n    " << way_json(way.way)
                   << ", \"error\": " << std::quoted(measure)
                   << ", \"C_h\": " << json_number(fit.c_1)
                   << ", \"p\": " << json_number(fit.p) << ", \"p_is_fitted\": "
                   << (fit.p_is_fitted ? "true" : "false")
                   << ", \"C_k\": " << json_number(fit.c_2)
                   << ", \"q\": " << json_number(fit.q) << ", \"q_is_fitted\": "
                   << (fit.q_is_fitted ? "true" : "false")
                   << ", \"m\": " << json_number(fit.m)
                   << ", \"rms_of_log\": " << json_number(fit.rms)
                   << ", \"worst_factor\": " << json_number(fit.worst_factor)
                   << ", \"worst_run\": "
                   << std::quoted(way.records[fit.worst_sample]->name) << '}';
              separator = ",";
            }
        }
      text << "\n  ],\n  \"costs\": [";
      separator = "";
      for (const WayResult &way : ways)
        {
          const CostModel cost =
            cost_of(way.records, study.runs.scene.dimension);
          const auto power = [](const TwoPowers &fit) {
            return "{\"c\": " + json_number(fit.c_1) +
                   ", \"a\": " + json_number(fit.p) +
                   ", \"constant\": " + json_number(fit.c_2) +
                   ", \"rms_of_log\": " + json_number(fit.rms) + '}';
          };
          text << separator << "\n    " << way_json(way.way)
               << ", \"seconds_per_set_up\": " << power(cost.set_up)
               << ", \"seconds_per_step\": " << power(cost.step)
               << ", \"c_dofs_a_steps\": " << power(cost.simple)
               << ", \"memory_MB\": " << power(cost.memory_model)
               << ", \"rms_of_log\": " << json_number(cost.rms)
               << ", \"worst_factor\": " << json_number(cost.worst_factor)
               << '}';
          separator = ",";
        }
      text << "\n  ],\n  \"prices\": [";
      separator = "";
      for (const WayResult &way : ways)
        for (const Price &price : way.prices)
          {
            text << separator << "\n    " << way_json(way.way)
                 << ", \"error\": " << std::quoted(way.measure)
                 << ", \"tolerance\": " << json_number(price.tolerance)
                 << ", \"in_budget\": "
                 << (price.is_in_budget ? "true" : "false");
            if (price.offer)
              text << ", \"h\": " << json_number(price.offer->h)
                   << ", \"mesh_level\": " << price.offer->mesh_level
                   << ", \"k\": " << json_number(price.offer->k)
                   << ", \"steps\": " << price.offer->steps
                   << ", \"dofs\": " << json_number(price.offer->dofs)
                   << ", \"predicted_error\": "
                   << json_number(price.offer->error)
                   << ", \"seconds\": " << json_number(price.offer->seconds)
                   << ", \"memory_MB\": " << json_number(price.offer->memory)
                   << ", \"halving_factor\": " << json_number(price.halving);
            text << '}';
            separator = ",";
          }
      text << "\n  ]\n}\n";
      return text.str();
    }
  } // namespace



  void
  write_report(const Study &study, const bool is_finished)
  {
    replace_file(study.runs.directory + "study.csv", csv(study));
    replace_file(study.runs.directory + "study.json", json(study, is_finished));
    replace_file(study.runs.directory + "study.md",
                 study_as_markdown(study, is_finished));
  }
} // namespace Viscoplastic
