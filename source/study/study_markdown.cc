// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/markdown_table.h>
#include <viscoplastic_contact/study/study_report.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// Errors to show: those of the fields or estimates that are known, or
    /// else quantities.
    std::vector<std::string>
    shown_measures(const Study &study)
    {
      std::vector<std::string> result;
      const auto               is_known = [&](const std::string &measure) {
        for (const RunRecord *record : study.records())
          if (std::isfinite(error_of(*record, measure, study.reference())))
            return true;
        return false;
      };
      for (const std::string &measure : field_errors)
        if (is_known(measure))
          result.push_back(measure);
      for (const std::string measure : {"estimate_total", "estimate_quantity"})
        if (is_known(measure))
          result.push_back(measure);
      if (result.empty() || !study.has_exact_solution)
        result.push_back("quantities");
      return result;
    }



    std::string
    runs_table(const Study &study, const VariantResult &result)
    {
      std::vector<std::string> columns{"h", "k"}, head{"run", "h", "k"},
        more = shown_measures(study);
      if (result.variant.strategy == MeshStrategy::tolerance)
        {
          columns = {"tolerance"};
          head    = {"run", "tolerance"};
        }
      else if (study.runs.scene.step_control.is_on())
        {
          columns = {"h", "step_tolerance", "k"};
          head    = {"run", "h", "TOL", "k"};
        }
      for (const auto &[column, title] :
           {std::make_pair("cells", "cells"),
            std::make_pair("dofs", "unknowns"),
            std::make_pair("steps", "steps"),
            std::make_pair("seconds_total", "seconds"),
            std::make_pair("peak_memory_MB", "MB")})
        {
          columns.push_back(column);
          head.push_back(title);
        }
      for (const char *column : {"effectivity", "effectivity_recovery"})
        if (std::isfinite(result.records[0]->number(column)))
          more.push_back(column);
      columns.insert(columns.end(), more.begin(), more.end());
      head.insert(head.end(), more.begin(), more.end());
      std::string text = table_head(head);
      for (const RunRecord *record : result.records)
        {
          std::vector<std::string> row{'`' + record->name + '`'};
          for (const std::string &column : columns)
            row.push_back(
              number_or_dash(error_of(*record, column, study.reference())));
          text += table_row(row);
        }
      return text;
    }



    /// The finished runs of a method variant in a ladder, the coarsest first.
    Records
    runs_of(const Study         &study,
            const MethodVariant &variant,
            const Ladder         ladder)
    {
      Records result;
      for (const PlannedRun &run : study.plan)
        if (run.record && run.key.variant == variant &&
            run.ladders.count(ladder) > 0)
          result.push_back(&*run.record);
      return result;
    }



    /// Orders between neighbors of each ladder.
    std::string
    orders_table(const Study &study, const VariantResult &result)
    {
      const auto               measures = shown_measures(study);
      std::vector<std::string> head{"ladder", "from", "to"};
      head.insert(head.end(), measures.begin(), measures.end());
      std::string text = table_head(head);
      for (const Ladder ladder : all_ladders)
        {
          const auto size = [ladder](const RunRecord &record) {
            return ladder == Ladder::time ? record.step_measure() :
                                            record.number("h");
          };
          const Records runs = runs_of(study, result.variant, ladder);
          for (std::size_t i = 1; i < runs.size(); ++i)
            {
              const RunRecord         &from = *runs[i - 1], &to = *runs[i];
              std::vector<std::string> row{to_string(ladder),
                                           '`' + from.name + '`',
                                           '`' + to.name + '`'};
              bool                     is_known = false;
              for (const std::string &measure : measures)
                {
                  const double order =
                    std::log(error_of(from, measure, study.reference()) /
                             error_of(to, measure, study.reference())) /
                    std::log(size(from) / size(to));
                  row.push_back(number_or_dash(order));
                  is_known |= std::isfinite(order);
                }
              if (is_known)
                text += table_row(row);
            }
        }
      return text;
    }



    std::string
    fits_in_words(const Study &study, const VariantResult &result)
    {
      std::ostringstream text;
      const TwoPowers   &error = result.model->error;
      const CostModel   &cost  = result.model->cost;
      const Records      timed = study.timed(result.variant);
      // What stands for the time steps in the law.
      const std::string k = result.model->chosen_steps ? "TOL" : "k";
      text << "Fit to the " << measure_in_words(result.measure)
           << ", relative:\n\n    error = ";
      if (error.m == 1.)
        text << digits(error.c_1) << " h^" << digits(error.p) << " + "
             << digits(error.c_2) << ' ' << k << '^' << digits(error.q)
             << "\n\n";
      else
        text << "((" << digits(error.c_1) << " h^" << digits(error.p)
             << ")^2 + (" << digits(error.c_2) << ' ' << k << '^'
             << digits(error.q)
             << ")^2)^(1/2)\n\nThe parts add up in squares, as orthogonal "
                "ones do: this fits better than their sum. ";
      if (!error.is_separable)
        text << "The runs refine h and " << k
             << " together, so that their parts cannot "
                "be told apart; half of the error is given to each. ";
      for (const auto &[is_fitted, name] :
           {std::make_pair(error.p_is_fitted, std::string("p, that of h,")),
            std::make_pair(error.q_is_fitted, "q, that of " + k + ',')})
        if (!is_fitted)
          text << "The exponent " << name
               << " does not show in these runs and is the theoretical 1. ";
      if (result.records[0]->numbers.count("is_difference") > 0 &&
          result.measure.compare(0, 6, "error_") == 0)
        text << "This is the law of the errors themselves; what was measured "
                "are differences to the reference, whose own error the fit "
                "subtracts. ";
      text << "The fit misses " << error.misfit.n_samples
           << " runs by a factor of " << digits(std::exp(error.misfit.rms), 3)
           << " (root mean square) and " << digits(error.misfit.worst_factor, 3)
           << " at worst (`" << result.records[error.misfit.worst_sample]->name
           << "`).\n";
      const RunRecord *finest  = result.records.back();
      const double     of_mesh = error.first(finest->number("h")),
                   of_steps    = error.second(finest->step_measure());
      text << "At the finest run `" << finest->name << "` the mesh has "
           << std::lround(100. * of_mesh / (of_mesh + of_steps))
           << " % of the sum of both parts, the steps have the rest.\n\n";
      const auto power = [](const TwoPowers &fit) {
        std::string formula = digits(fit.c_1) + " dofs^" + digits(fit.p, 3);
        if (fit.c_2 > 0.)
          formula += " + " + digits(fit.c_2);
        return formula;
      };
      if (const auto &steps = result.model->chosen_steps)
        text << "The number of steps to their tolerance:\n\n    steps = "
             << digits(steps->c_1) << " TOL^-" << digits(steps->p) << " + "
             << digits(steps->c_2) << "\n\nwhich misses by a factor of "
             << digits(std::exp(steps->misfit.rms)) << " and "
             << digits(steps->misfit.worst_factor) << " at worst.\n\n";
      for (const auto &[kind, fit] : cost.solvers)
        text << "With "
             << (kind == BulkSolverKind::direct ? "the direct solver" :
                                                  to_string(kind))
             << ", measured up to " << digits(fit.largest)
             << " unknowns:\n\n    seconds = "
             << (result.variant.strategy == MeshStrategy::adaptive ? "meshes" :
                                                                     "1")
             << " (" << power(fit.set_up) << ")\n            + steps ("
             << power(fit.step) << ")\n\n";
      text << "The seconds miss " << cost.misfit.n_samples
           << " runs by a factor of " << digits(std::exp(cost.misfit.rms), 3)
           << " (root mean square) and " << digits(cost.misfit.worst_factor, 3)
           << " at worst (`" << timed[cost.misfit.worst_sample]->name
           << "`), the memory by "
           << digits(std::exp(cost.memory_misfit.rms), 3)
           << ". One power alone, seconds = " << digits(cost.simple.c_1)
           << " dofs^" << digits(cost.simple.p, 3) << " steps, misses by "
           << digits(std::exp(cost.simple.misfit.rms), 3) << " and "
           << digits(cost.simple.misfit.worst_factor, 3) << " at worst.\n";
      std::string list;
      for (const RunRecord *record : timed)
        if (record->key.is_timing)
          list += (list.empty() ? "" : ", ") + ('`' + record->name + "` (") +
                  digits(record->number("dofs")) + " unknowns, " +
                  to_string(choose_bulk_solver(record->solver_demand)) + ", " +
                  seconds_in_words(record->number("seconds_total")) + ")";
      if (!list.empty())
        text << "Runs that only tell what they cost: " << list << ".\n";
      return text.str();
    }



    std::string
    prices_table(const Study &study, const VariantResult &result)
    {
      std::ostringstream text;
      const double       budget = study.parameters.budget;
      text << table_head({"error",
                          "mesh level",
                          "h",
                          "steps",
                          result.model->chosen_steps ? "TOL" : "k",
                          "unknowns",
                          "solver",
                          "seconds",
                          "MB",
                          "half the error costs"});
      std::string beyond;
      for (const Price &price : result.prices)
        {
          if (!price.is_in_budget)
            {
              beyond += "- " + in_words(*result.model, price, budget) + '\n';
              continue;
            }
          const PredictedRun &run = *price.run;
          text << table_row(
            {digits(price.tolerance),
             std::to_string(run.mesh_level) + (run.is_far ? " (far)" : ""),
             digits(run.h),
             std::to_string(run.steps),
             digits(run.k),
             digits(run.dofs),
             to_string(run.solver),
             digits(run.seconds, 2),
             digits(run.memory, 2),
             digits(price.halving, 2) + " times"});
        }
      text << '\n';
      if (!beyond.empty())
        text << beyond << '\n';
      text << next_refinement(*result.model) << '\n';
      return text.str();
    }



    std::string
    reference_in_words(const Study &study)
    {
      std::ostringstream text;
      const RunRecord   *reference = study.reference();
      if (study.has_exact_solution)
        text << "Errors of fields are those to the exact solution of the "
                "scene. ";
      else if (study.runs.reference)
        text << "Errors of fields are differences to those of the run `"
             << study.runs.name(*study.runs.reference)
             << "` at the ends of the phases of time; its own error, unknown, "
                "is part of them. ";
      if (!study.has_exact_solution && study.runs.reference &&
          reference != nullptr &&
          study.reference_strategy == MeshStrategy::tolerance)
        text << "The error bar of that run itself is "
             << number_or_dash(reference->number("estimate_total")) << ". ";
      if (reference != nullptr)
        text << "Quantities of interest are compared with those of the run `"
             << reference->name << "`.\n";
      for (const PlannedRun &run : study.plan)
        if (run.is_reference && !run.record)
          text << "\nThe reference run `" << study.runs.name(run.key)
               << "` is missing: " << run.skipped
               << ". The finest run there is has taken its place, and errors "
                  "near it are too small.\n";

      // Halved tolerances leave the order of neighbors to chance.
      if (study.reference_strategy == MeshStrategy::tolerance)
        return text.str();

      // The finest three of those with equal levels.
      const MethodVariant &last = study.plan.back().key.variant;
      const Records        diagonal =
        runs_of(study,
                {MeshStrategy::uniform, last.scheme, last.history},
                Ladder::both);
      if (diagonal.size() < 3)
        return text.str();
      const std::size_t n = diagonal.size();
      text << "\nRichardson check of the quantities at the end, in the runs `"
           << diagonal[n - 3]->name << "`, `" << diagonal[n - 2]->name
           << "` and `" << diagonal[n - 1]->name << "`:\n\n"
           << table_head({"quantity",
                          "values",
                          "order",
                          "extrapolated",
                          "error of the last",
                          "as a reference"});
      for (const Richardson &r :
           extrapolate({{diagonal[n - 3], diagonal[n - 2], diagonal[n - 1]}}))
        text << table_row({r.quantity,
                           digits(r.values[0], 5) + ", " +
                             digits(r.values[1], 5) + ", " +
                             digits(r.values[2], 5),
                           number_or_dash(r.order),
                           number_or_dash(r.extrapolated, 5),
                           number_or_dash(r.error, 2),
                           r.is_trustworthy ? "good" : "not to be trusted"});
      return text.str();
    }
  } // namespace



  std::string
  study_as_markdown(const Study                      &study,
                    const std::vector<VariantResult> &results,
                    const Origin                     &origin,
                    const bool                        is_finished)
  {
    std::ostringstream text;
    text << "# Study of " << study.runs.scene.file << "\n\n"
         << (is_finished ? "" : "**Not finished yet.** ")
         << "viscoplastic_contact " << origin.program << ", " << origin.n_ranks
         << " MPI rank(s), " << origin.machine << ", " << origin.date
         << ".\n\nThe ladder `space` refines the mesh with the steps of the "
            "finest level of the study, `time` the steps on its finest mesh, "
            "`both` both, which share the finest run: what a ladder leaves "
            "alone is as good as the study has it, and its part of the error "
            "is named below. Errors are relative to the largest norm over "
            "all times. In adaptive runs, h is the width of a uniform mesh "
            "with as many cells. Runs to a tolerance choose meshes and steps "
            "themselves: their cells and unknowns are means over the steps.\n";
    if (study.runs.scene.step_control.is_on())
      text << "\nThe steps are chosen by their error, to the tolerance TOL, "
              "`Step control/Tolerance`: the ladder `time` divides it by 2 (by "
              "4 with Heun's method), so that steps are half as long; its "
              "orders are against TOL, and k is the longest step of a run.\n";
    for (const VariantResult &result : results)
      {
        text << "\n## " << result.variant.name() << "\n\n"
             << runs_table(study, result) << '\n';
        if (result.variant.strategy == MeshStrategy::tolerance)
          text << tolerance_results_as_markdown(study, result);
        else
          text << "Observed orders between neighbours:\n\n"
               << orders_table(study, result) << '\n';
        if (result.model)
          text << fits_in_words(study, result) << "\n### Price list\n\n"
               << prices_table(study, result);
        else if (!result.tolerance_model)
          text << "No price list: the error is known of fewer than three "
                  "runs.\n";
      }
    text << "\n## Reference\n\n" << reference_in_words(study);
    std::string skipped;
    for (const PlannedRun &run : study.plan)
      if (!run.skipped.empty())
        skipped +=
          "- `" + study.runs.name(run.key) + "`: " + run.skipped + ".\n";
    const std::string fewer = study.levels_in_words();
    if (!fewer.empty())
      skipped = fewer + (skipped.empty() ? "\n" : "\n\n") + skipped;
    text << "\n## Left out\n\n"
         << (skipped.empty() ? "Nothing.\n" : skipped) << "\n## Pictures\n\n"
         << "    contrib/plot " << study.runs.directory << "\n";
    std::error_code          error;
    std::vector<std::string> pictures;
    for (const auto &file :
         std::filesystem::directory_iterator(study.runs.directory, error))
      if (file.path().extension() == ".png")
        pictures.push_back(file.path().filename().string());
    std::sort(pictures.begin(), pictures.end());
    for (const std::string &name : pictures)
      text << "\n![" << std::filesystem::path(name).stem().string() << "]("
           << name << ")\n";
    return text.str();
  }
} // namespace Viscoplastic
