// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/study.h>

namespace Viscoplastic
{
  /**
   * study.csv: a row for each run and ladder; study.json: fits and prices;
   * study.md: the same for people. Each is replaced at once. On one rank, and
   * only if there is a finished run. Throws ExcMessage.
   */
  void
  write_report(const Study &study, const bool is_finished);

  /// The price lists as sentences, one a line.
  std::string
  prices_in_words(const Study &study);


  // The parts of write_report():

  /// What the finished runs of a method variant say: models and prices of
  /// given meshes and steps, or of tolerances. Without a known error there is
  /// neither a model nor a price.
  struct VariantResult
  {
    MethodVariant                     variant;
    Records                           records;
    std::string                       measure;
    std::optional<WorkPrecisionModel> model;
    std::vector<Price>                prices;
    std::optional<ToleranceModel>     tolerance_model;
    std::vector<TolerancePrice>       tolerance_prices;
  };

  /// The results of all method variants.
  std::vector<VariantResult>
  analyze(const Study &study);


  /// Where and when numbers were made.
  struct Origin
  {
    std::string  program, machine, date;
    unsigned int n_ranks;
  };

  /// The origin of numbers that are made here and now.
  Origin
  origin();


  /// The section of study.md on runs to a tolerance: exponents, fits, prices.
  /// Empty without a known error.
  std::string
  tolerance_results_as_markdown(const Study         &study,
                                const VariantResult &result);

  /// The contents of study.md.
  std::string
  study_as_markdown(const Study                      &study,
                    const std::vector<VariantResult> &results,
                    const Origin                     &origin,
                    const bool                        is_finished);
} // namespace Viscoplastic
