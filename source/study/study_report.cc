// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/json_text.h>
#include <viscoplastic_contact/results/run_phases.h>
#include <viscoplastic_contact/study/study_report.h>

#include <nlohmann/json.hpp>

#include <algorithm>
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

    using Json = nlohmann::ordered_json;

    Json
    to_json(const RunKey &way)
    {
      return {{"strategy", way.strategy},
              {"scheme", way.scheme},
              {"history", way.history}};
    }



    Json
    fits(const Study &study, const WayResult &way)
    {
      std::vector<std::string> measures = field_errors;
      measures.push_back("estimate_total");
      for (const std::string &name : quantities(study))
        measures.push_back(name + "_error");
      Json result = Json::array();
      for (const std::string &measure : measures)
        {
          const TwoPowers fit =
            fit_measure(way.records, measure, study.reference());
          if (fit.n_samples < 3)
            continue;
          Json entry = to_json(way.way);
          entry.update({{"error", measure},
                        {"C_h", fit.c_1},
                        {"p", fit.p},
                        {"p_is_fitted", fit.p_is_fitted},
                        {"C_k", fit.c_2},
                        {"q", fit.q},
                        {"q_is_fitted", fit.q_is_fitted},
                        {"m", fit.m},
                        {"rms_of_log", fit.rms},
                        {"worst_factor", fit.worst_factor},
                        {"worst_run", way.records[fit.worst_sample]->name}});
          result.push_back(entry);
        }
      return result;
    }



    Json
    costs(const Study &study, const WayResult &way)
    {
      const CostModel cost  = cost_of(way.records, study.runs.scene.dimension);
      const auto      power = [](const TwoPowers &fit) -> Json {
        return {{"c", fit.c_1},
                {"a", fit.p},
                {"constant", fit.c_2},
                {"rms_of_log", fit.rms}};
      };
      Json result = to_json(way.way);
      result.update({{"seconds_per_set_up", power(cost.set_up)},
                     {"seconds_per_step", power(cost.step)},
                     {"c_dofs_a_steps", power(cost.simple)},
                     {"memory_MB", power(cost.memory_model)},
                     {"rms_of_log", cost.rms},
                     {"worst_factor", cost.worst_factor}});
      return result;
    }



    Json
    prices(const WayResult &way)
    {
      Json result = Json::array();
      for (const Price &price : way.prices)
        {
          Json entry = to_json(way.way);
          entry.update({{"error", way.measure},
                        {"tolerance", price.tolerance},
                        {"in_budget", price.is_in_budget}});
          if (price.offer)
            entry.update({{"h", price.offer->h},
                          {"mesh_level", price.offer->mesh_level},
                          {"k", price.offer->k},
                          {"steps", price.offer->steps},
                          {"dofs", price.offer->dofs},
                          {"predicted_error", price.offer->error},
                          {"seconds", price.offer->seconds},
                          {"memory_MB", price.offer->memory},
                          {"halving_factor", price.halving}});
          result.push_back(entry);
        }
      return result;
    }



    Json
    json(const Study &study, const bool is_finished)
    {
      const Origin                from      = origin();
      const std::filesystem::path scene     = study.runs.scene.file;
      const RunRecord            *reference = study.reference();
      Json                        result{
        {"scene", scene.stem().string()},
        {"version", from.program},
        {"ranks", from.n_ranks},
        {"machine", from.machine},
        {"date", from.date},
        {"finished", is_finished},
        {"dimension", study.runs.scene.dimension},
        {"reference", study.has_exact_solution ? "exact" : "finest run"},
        {"reference_run", reference == nullptr ? "" : reference->name},
        {"budget", study.parameters.budget},
        {"fits", Json::array()},
        {"costs", Json::array()},
        {"prices", Json::array()}};
      for (const WayResult &way : analyse(study))
        {
          for (const Json &fit : fits(study, way))
            result["fits"].push_back(fit);
          result["costs"].push_back(costs(study, way));
          for (const Json &price : prices(way))
            result["prices"].push_back(price);
        }
      return result;
    }
  } // namespace



  void
  write_report(const Study &study, const bool is_finished)
  {
    replace_file(study.runs.directory + "study.csv", csv(study));
    replace_file(study.runs.directory + "study.json",
                 json_text(json(study, is_finished)));
    replace_file(study.runs.directory + "study.md",
                 study_as_markdown(study, is_finished));
  }
} // namespace Viscoplastic
