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
    /// The columns of sizes and costs in study.csv.
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



    /// The names of the quantities of interest.
    std::vector<std::string>
    quantities(const Study &study)
    {
      std::vector<std::string> result;
      for (const auto &entry : study.records()[0]->quantities)
        result.push_back(entry.first);
      return result;
    }



    std::string
    csv(const Study &study)
    {
      std::ostringstream       text;
      std::vector<std::string> columns = number_columns();
      for (const auto &more : {field_errors,
                               estimate_parts,
                               std::vector<std::string>{"effectivity",
                                                        "effectivity_recovery",
                                                        "estimate_quantity"}})
        columns.insert(columns.end(), more.begin(), more.end());
      text << "run,strategy,scheme,history,solver,ladder,mesh_level,time_level,"
              "tolerance,step_tolerance";
      for (const std::string &column : columns)
        text << ',' << column;
      for (const std::string &name : quantities(study))
        text << ',' << name << ',' << name << "_error";
      text << std::setprecision(12) << '\n';
      for (const Ladder ladder : all_ladders)
        for (const PlannedRun &run : study.plan)
          if (run.record && run.ladders.count(ladder) > 0)
            {
              const RunRecord     &record  = *run.record;
              const MethodVariant &variant = record.key.variant;
              text << record.name << ',' << to_string(variant.strategy) << ','
                   << variant.scheme << ',' << variant.history << ','
                   << to_string(choose_bulk_solver(record.solver_demand)) << ','
                   << to_string(ladder) << ',' << record.key.mesh_level << ','
                   << record.key.time_level << ',' << record.number("tolerance")
                   << ',' << record.number("step_tolerance");
              for (const std::string &column : columns)
                text << ',' << record.number(column);
              for (const std::string &name : quantities(study))
                text << ',' << record.quantity(name) << ','
                     << quantity_error(record, name, study.reference());
              text << '\n';
            }
      return text.str();
    }



    // study.json

    using Json = nlohmann::ordered_json;

    /// Of a method variant, and what there is to say of it.
    Json
    entry(const MethodVariant &variant, const Json &more)
    {
      Json json{{"strategy", to_string(variant.strategy)},
                {"scheme", variant.scheme},
                {"history", variant.history}};
      json.update(more);
      return json;
    }



    void
    add_fits(const Study &study, const VariantResult &result, Json &fits)
    {
      std::vector<std::string> measures = field_errors;
      measures.insert(measures.end(), {"estimate_total", "estimate_quantity"});
      for (const std::string &name : quantities(study))
        measures.push_back(name + "_error");
      for (const std::string &measure : measures)
        {
          const TwoPowers fit =
            fit_measure(result.records, measure, study.reference());
          if (fit.misfit.n_samples >= 3)
            fits.push_back(entry(
              result.variant,
              {{"error", measure},
               {"C_h", fit.c_1},
               {"p", fit.p},
               {"p_is_fitted", fit.p_is_fitted},
               {"C_k", fit.c_2},
               {"q", fit.q},
               {"q_is_fitted", fit.q_is_fitted},
               {"m", fit.m},
               {"rms_of_log", fit.misfit.rms},
               {"worst_factor", fit.misfit.worst_factor},
               {"worst_run", result.records[fit.misfit.worst_sample]->name}}));
        }
    }



    void
    add_cost(const Study &study, const VariantResult &result, Json &costs)
    {
      const CostModel cost  = cost_of(study.timed(result.variant));
      const auto      power = [](const TwoPowers &fit) -> Json {
        return {{"c", fit.c_1},
                {"a", fit.p},
                {"constant", fit.c_2},
                {"rms_of_log", fit.misfit.rms}};
      };
      Json solvers = Json::array();
      for (const auto &[kind, fit] : cost.solvers)
        solvers.push_back({{"solver", to_string(kind)},
                           {"largest_dofs", fit.largest},
                           {"seconds_per_set_up", power(fit.set_up)},
                           {"seconds_per_step", power(fit.step)}});
      costs.push_back(entry(result.variant,
                            {{"solvers", solvers},
                             {"c_dofs_a_steps", power(cost.simple)},
                             {"rms_of_log", cost.misfit.rms},
                             {"worst_factor", cost.misfit.worst_factor},
                             {"memory_rms_of_log", cost.memory_misfit.rms}}));
      if (study.runs.scene.step_control.is_on())
        {
          const TwoPowers steps = fit_chosen_steps(study.timed(result.variant));
          costs.back()["steps"] = {{"c", steps.c_1},
                                   {"q", steps.p},
                                   {"q_is_fitted", steps.p_is_fitted},
                                   {"constant", steps.c_2},
                                   {"rms_of_log", steps.misfit.rms}};
        }
    }



    /// c_1 TOL^p for errors, c_1 TOL^-p + c_2 for costs.
    void
    add_tolerance_fit(const VariantResult &result, Json &fits)
    {
      const ToleranceModel &model = *result.tolerance_model;
      Json                  fit   = entry(result.variant,
                       {{"error", result.measure},
                                           {"C", model.error.c_1},
                                           {"s", model.error.p},
                                           {"s_is_fitted", model.error.p_is_fitted},
                                           {"rms_of_log", model.error.misfit.rms}});
      for (const auto &[name, cost] :
           {std::make_pair("seconds", &model.seconds),
            std::make_pair("cells", &model.cells),
            std::make_pair("dofs", &model.dofs),
            std::make_pair("steps", &model.steps),
            std::make_pair("memory_MB", &model.memory)})
        fit[name] = {{"c", cost->c_1},
                     {"q", cost->p},
                     {"q_is_fitted", cost->p_is_fitted},
                     {"constant", cost->c_2},
                     {"exponent_against_error", model.exponent(*cost)},
                     {"rms_of_log", cost->misfit.rms}};
      fits.push_back(fit);
    }



    void
    add_prices(const VariantResult &result, Json &prices)
    {
      for (const TolerancePrice &price : result.tolerance_prices)
        prices.push_back(entry(result.variant,
                               {{"error", result.measure},
                                {"tolerance", price.error},
                                {"in_budget", price.is_in_budget},
                                {"run_tolerance", price.run.tolerance},
                                {"cells", price.run.cells},
                                {"steps", price.run.steps},
                                {"dofs", price.run.dofs},
                                {"predicted_error", price.run.error},
                                {"seconds", price.run.seconds},
                                {"memory_MB", price.run.memory},
                                {"halving_factor", price.halving}}));
      for (const Price &price : result.prices)
        {
          prices.push_back(entry(result.variant,
                                 {{"error", result.measure},
                                  {"tolerance", price.tolerance},
                                  {"in_budget", price.is_in_budget}}));
          if (price.run)
            prices.back().update(
              {{"h", price.run->h},
               {"mesh_level", price.run->mesh_level},
               {result.model->chosen_steps ? "step_tolerance" : "k",
                price.run->k},
               {"steps", price.run->steps},
               {"dofs", price.run->dofs},
               {"predicted_error", price.run->error},
               {"solver", to_string(price.run->solver)},
               {"seconds", price.run->seconds},
               {"memory_MB", price.run->memory},
               {"halving_factor", price.halving}});
        }
    }



    Json
    json(const Study                      &study,
         const std::vector<VariantResult> &results,
         const Origin                     &origin,
         const bool                        is_finished)
    {
      const std::filesystem::path scene     = study.runs.scene.file;
      const RunRecord            *reference = study.reference();
      Json fits = Json::array(), tolerance_fits = fits, costs = fits,
           prices = fits;
      for (const VariantResult &result : results)
        {
          if (result.tolerance_model)
            add_tolerance_fit(result, tolerance_fits);
          else if (result.variant.strategy != MeshStrategy::tolerance)
            {
              add_fits(study, result, fits);
              add_cost(study, result, costs);
            }
          add_prices(result, prices);
        }
      return {{"scene", scene.stem().string()},
              {"version", origin.program},
              {"ranks", origin.n_ranks},
              {"machine", origin.machine},
              {"date", origin.date},
              {"finished", is_finished},
              {"dimension", study.runs.scene.dimension},
              {"reference", study.has_exact_solution ? "exact" : "finest run"},
              {"reference_run", reference == nullptr ? "" : reference->name},
              {"budget", study.parameters.budget},
              {"fits", fits},
              {"tolerance_fits", tolerance_fits},
              {"costs", costs},
              {"prices", prices}};
    }
  } // namespace



  void
  write_report(const Study &study, const bool is_finished)
  {
    const std::string                directory = study.runs.directory;
    const std::vector<VariantResult> results   = analyze(study);
    const Origin                     origin    = Viscoplastic::origin();
    replace_file(directory + "study.csv", csv(study));
    replace_file(directory + "study.json",
                 json_text(json(study, results, origin, is_finished)));
    replace_file(directory + "study.md",
                 study_as_markdown(study, results, origin, is_finished));
  }
} // namespace Viscoplastic
