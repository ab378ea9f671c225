// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/study/study_report.h>

#include <ctime>
#include <fstream>

namespace Viscoplastic
{
  std::vector<VariantResult>
  analyze(const Study &study)
  {
    const std::vector<double> tolerances = Utilities::string_to_double(
      Utilities::split_string_list(study.parameters.target_errors, ','));
    std::vector<VariantResult> results;
    for (const MethodVariant &variant : study.variants())
      {
        VariantResult result;
        result.variant = variant;
        result.records = of_variant(study.records(), variant);
        result.measure = best_measure(result.records, study.reference());
        if (result.measure.empty())
          {}
        else if (variant.strategy == MeshStrategy::tolerance)
          {
            result.tolerance_model = fit_tolerance_runs(study.runs,
                                                        result.records,
                                                        result.measure,
                                                        study.reference());
            for (const double error : tolerances)
              result.tolerance_prices.push_back(price_of(
                *result.tolerance_model, error, study.parameters.budget));
          }
        else
          {
            result.model = fit_work_precision(study.runs,
                                              result.records,
                                              study.timed(variant),
                                              result.measure,
                                              study.reference());
            result.prices =
              list_prices(*result.model, tolerances, study.parameters.budget);
          }
        results.push_back(result);
      }
    return results;
  }



  std::string
  prices_in_words(const Study &study)
  {
    const double budget = study.parameters.budget;
    std::string  text;
    for (const VariantResult &result : analyze(study))
      if (!result.measure.empty())
        {
          text += "Prices (" + result.variant.name() + "), by the " +
                  measure_in_words(result.measure) + ":\n";
          for (const Price &price : result.prices)
            text += "  " + in_words(*result.model, price, budget) + '\n';
          for (const TolerancePrice &price : result.tolerance_prices)
            text +=
              "  " + in_words(*result.tolerance_model, price, budget) + '\n';
        }
    return text;
  }



  Origin
  origin()
  {
    Origin result;
    result.program =
      VISCOPLASTIC_CONTACT_VERSION " (" VISCOPLASTIC_CONTACT_GIT_REVISION ")";
    result.n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);

    result.machine = "unknown machine";
    std::ifstream file("/proc/cpuinfo");
    std::string   line;
    while (std::getline(file, line))
      if (line.compare(0, 10, "model name") == 0)
        result.machine = Utilities::trim(line.substr(line.find(':') + 1));

    const std::time_t now = std::time(nullptr);
    char              text[32];
    std::strftime(text, sizeof(text), "%FT%TZ", std::gmtime(&now));
    result.date = text;
    return result;
  }
} // namespace Viscoplastic
