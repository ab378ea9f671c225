// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/markdown_table.h>
#include <viscoplastic_contact/study/study_report.h>

#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// Exponents of costs against the error, between neighbors.
    std::string
    exponents_table(const Study &study, const VariantResult &result)
    {
      std::string text =
        table_head({"from", "to", "seconds", "cells", "steps"});
      for (std::size_t i = 1; i < result.records.size(); ++i)
        {
          const RunRecord &from = *result.records[i - 1],
                          &to   = *result.records[i];
          const double of_error =
            std::log(error_of(from, result.measure, study.reference()) /
                     error_of(to, result.measure, study.reference()));
          if (!std::isfinite(of_error))
            continue;
          std::vector<std::string> row{'`' + from.name + '`',
                                       '`' + to.name + '`'};
          for (const char *column : {"seconds_total", "cells", "steps"})
            row.push_back(number_or_dash(
              std::log(to.number(column) / from.number(column)) / of_error));
          text += table_row(row);
        }
      return text;
    }



    std::string
    tolerance_fits_in_words(const VariantResult &result)
    {
      const ToleranceModel &model = *result.tolerance_model;
      std::ostringstream    text;
      text << "Fits to the " << measure_in_words(result.measure)
           << ", relative, and to what the runs cost:\n\n    error   = "
           << digits(model.error.c_1) << " tolerance^" << digits(model.error.p)
           << '\n';
      for (const auto &[name, fit] : {std::make_pair("seconds", &model.seconds),
                                      std::make_pair("cells  ", &model.cells),
                                      std::make_pair("steps  ", &model.steps)})
        {
          text << "    " << name << " = " << digits(fit->c_1) << " tolerance^-"
               << digits(fit->p);
          if (fit->c_2 > 0.)
            text << " + " << digits(fit->c_2);
          text << '\n';
        }
      text << '\n' << exponents_in_words(model);
      if (!model.error.p_is_fitted)
        text << " The exponent of the error does not show in these runs and is "
                "taken for 1.";
      if (!model.seconds.p_is_fitted)
        text << " That of the seconds does not show either and is the "
                "theoretical one.";
      const auto missed = [&](const Misfit &misfit) {
        return digits(std::exp(misfit.rms), 3) + " and " +
               digits(misfit.worst_factor, 3) + " (`" +
               result.records[misfit.worst_sample]->name + "`)";
      };
      text << " The fits miss the runs by factors (root mean square and worst) "
              "of "
           << missed(model.error.misfit) << " in the error and "
           << missed(model.seconds.misfit) << " in the seconds.\n\n";
      return text.str();
    }



    std::string
    tolerance_prices_table(const Study &study, const VariantResult &result)
    {
      const double budget = study.parameters.budget;
      std::string  text   = table_head({"error",
                                        "tolerance",
                                        "cells",
                                        "unknowns",
                                        "steps",
                                        "seconds",
                                        "MB",
                                        "half the error costs"}),
                  beyond;
      for (const TolerancePrice &price : result.tolerance_prices)
        {
          const PredictedToleranceRun &run = price.run;
          if (price.is_in_budget)
            text +=
              table_row({digits(price.error),
                         digits(run.tolerance) + (price.is_far ? " (far)" : ""),
                         digits(run.cells),
                         digits(run.dofs),
                         digits(run.steps),
                         digits(run.seconds, 2),
                         digits(run.memory, 2),
                         digits(price.halving, 2) + " times"});
          else
            beyond +=
              "- " + in_words(*result.tolerance_model, price, budget) + '\n';
        }
      return text + '\n' + beyond;
    }
  } // namespace



  std::string
  tolerance_results_as_markdown(const Study &study, const VariantResult &result)
  {
    if (!result.tolerance_model)
      return "";
    return "Observed exponents against 1/error between neighbours:\n\n" +
           exponents_table(study, result) + '\n' +
           tolerance_fits_in_words(result) + "### Price list\n\n" +
           tolerance_prices_table(study, result);
  }
} // namespace Viscoplastic
