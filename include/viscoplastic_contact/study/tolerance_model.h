// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/study_fit.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  // What runs to a tolerance say together: their errors and costs as powers of
  // the tolerance. Pure functions of numbers.

  /// What one run to a tolerance has given and cost.
  struct ToleranceSample
  {
    double tolerance, error;
    /// Cells and unknowns are means over the steps, the memory is in MB.
    double seconds, cells, dofs, steps, memory;
  };


  /// What belongs to a tolerance.
  struct PredictedToleranceRun
  {
    double tolerance = 0., error = 0.;
    double seconds = 0., cells = 0., dofs = 0., steps = 0., memory = 0.;
  };


  /**
   * error = c TOL^s, and of seconds, cells, unknowns, steps and memory each
   * c TOL^-q + c_0. Where the samples do not tell an exponent it is that of a
   * run whose mesh and steps are chosen at the least cost, see ErrorBudget: d
   * of cells, unknowns and memory, 1/p of steps, their sum of seconds, in d
   * dimensions with a scheme of order p.
   */
  struct ToleranceModel
  {
    /// Of TOL.
    TwoPowers error;
    /// Of 1/TOL.
    TwoPowers seconds, cells, dofs, steps, memory;
    /// Whether the errors are the estimates that a run keeps below TOL.
    bool is_kept = false;
    /// The smallest that was measured.
    double smallest_tolerance = 0.;

    /// The run to that tolerance.
    PredictedToleranceRun
    predict(const double tolerance) const;

    /// The tolerance for that error, at most @p largest.
    double
    tolerance_for(const double error, const double largest = 0.5) const;

    /// The tolerance of a run that takes so long; nothing if not even a run
    /// without any cells is that short.
    std::optional<double>
    tolerance_within(const double seconds) const;

    /// How much the seconds, or what else is a power of 1/TOL, grow for half of
    /// the error: the exponent against 1/error.
    double
    exponent(const TwoPowers &cost) const
    {
      return cost.p / error.p;
    }
  };

  /**
   * The model of these runs in @p dim dimensions with a scheme of order
   * @p order. Where their errors are differences to a run of the tolerance
   * @p reference, its own error is subtracted (of norms in squares, otherwise
   * @p m = 1); the model is that of the errors themselves.
   */
  ToleranceModel
  fit_tolerance(const std::vector<ToleranceSample> &samples,
                const unsigned int                  dim,
                const unsigned int                  order,
                const std::optional<double>         reference = {},
                const double                        m         = 2.);


  /// What an error costs by runs to a tolerance.
  struct TolerancePrice
  {
    /// The error that is asked for.
    double                error = 0.;
    PredictedToleranceRun run;
    bool                  is_in_budget = false;
    /// Whether the tolerance is far below those that were measured.
    bool is_far = false;
    /// By which factor the seconds grow for half of the error.
    double halving = std::numeric_limits<double>::quiet_NaN();
  };

  TolerancePrice
  price_of(const ToleranceModel &model,
           const double          error,
           const double          budget);

  /// The price as a sentence.
  std::string
  in_words(const ToleranceModel &model,
           const TolerancePrice &price,
           const double          budget);

  /// What halving the error does to seconds, cells and steps, in a sentence.
  std::string
  exponents_in_words(const ToleranceModel &model);
} // namespace Viscoplastic
