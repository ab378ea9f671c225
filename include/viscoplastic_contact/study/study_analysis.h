// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/study_runs.h>
#include <viscoplastic_contact/study/tolerance_model.h>

#include <array>

namespace Viscoplastic
{
  // What the runs of a study say together.

  using Records = std::vector<const RunRecord *>;

  /// The error of a quantity of interest, relative to its size (of vectors: to
  /// that of the vector) in the reference; not a number without one.
  double
  quantity_error(const RunRecord   &record,
                 const std::string &quantity,
                 const RunRecord   *reference);

  /**
   * The error of a run in a measure: a column of study.csv that holds errors
   * or estimates, `QUANTITY_error', or `quantities', the largest error of all
   * quantities of interest. Not a number where it is not known.
   */
  double
  error_of(const RunRecord   &record,
           const std::string &measure,
           const RunRecord   *reference);

  /**
   * The best measure that at least @p n_least of the runs have: the estimated
   * error of `Error control/Quantity', the error in the energy norm, the
   * estimate of it, the quantities of interest. Empty if none.
   */
  std::string
  best_measure(const Records     &records,
               const RunRecord   *reference,
               const unsigned int n_least = 3);

  /// A measure in words.
  std::string
  measure_in_words(const std::string &measure);

  /// The records of one method variant.
  Records
  of_variant(const Records &records, const MethodVariant &variant);

  /// The fit of the errors in a measure; that of estimates is by their parts.
  TwoPowers
  fit_measure(const Records     &records,
              const std::string &measure,
              const RunRecord   *reference);

  /// How many steps step control takes to the tolerance TOL, of the records
  /// of one method variant: c TOL^-q + c_0, with q = 1/p for a scheme of order
  /// p where they do not tell.
  TwoPowers
  fit_chosen_steps(const Records &records);

  /// How many steps a run has: those of its phases, or what its tolerance
  /// takes by the records.
  double
  expected_steps(const StudyRuns &runs,
                 const Records   &records,
                 const RunKey    &key);

  /// The fit of seconds and memory.
  CostModel
  cost_of(const Records &records);

  /// All that follows from runs of one method variant, of which there must be
  /// one. Those that are @p timed tell what runs cost. The model uses @p runs.
  WorkPrecisionModel
  fit_work_precision(const StudyRuns   &runs,
                     const Records     &records,
                     const Records     &timed,
                     const std::string &measure,
                     const RunRecord   *reference);

  /// The same of runs to a tolerance.
  ToleranceModel
  fit_tolerance_runs(const StudyRuns   &runs,
                     const Records     &records,
                     const std::string &measure,
                     const RunRecord   *reference);


  /// Richardson extrapolation of three values, on meshes and with steps that
  /// halve each time.
  struct Richardson
  {
    std::string           quantity;
    std::array<double, 3> values;
    double                order, extrapolated;
    /// That of the last value, relative to the size of the quantity.
    double error;
    /// Whether the differences shrink with an order between 1/2 and 3, so that
    /// the last value can serve as a reference.
    bool is_trustworthy;
  };

  /// The extrapolation of every quantity of interest, of runs from coarse to
  /// fine.
  std::vector<Richardson>
  extrapolate(const std::array<const RunRecord *, 3> &runs);

} // namespace Viscoplastic
