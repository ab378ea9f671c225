// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <optional>
#include <vector>

namespace Viscoplastic
{
  // What the runs of a study say of errors: powers of the mesh width h and the
  // time step k. Pure functions of numbers.

  /// How far a fit is from the samples that it was made from.
  struct Misfit
  {
    /// The root mean square of log(fit/sample) and, which outliers do not move,
    /// the median of its absolute value.
    double rms    = std::numeric_limits<double>::quiet_NaN();
    double median = std::numeric_limits<double>::quiet_NaN();
    /// The largest of fit/sample and sample/fit, and the index of that sample.
    double       worst_factor = 1.;
    unsigned int worst_sample = 0;
    /// How many samples count; without any there is no fit.
    unsigned int n_samples = 0;
  };

  /// The misfit where log(fit/sample) of each sample is given; samples for
  /// which that is not finite do not count.
  Misfit
  misfit_of(const std::vector<double> &log_ratios);


  /// A value y that was found at x_1 and x_2.
  struct Sample
  {
    double x_1, x_2, y;
  };


  /// The law y(x_1, x_2)^m = (c_1 x_1^p)^m + (c_2 x_2^q)^m with c_1, c_2 >= 0.
  struct TwoPowers
  {
    double c_1 = 0., p = 1., c_2 = 0., q = 1.;
    /// 1, or 2 for two parts of an error that are orthogonal to each other.
    double m = 1.;
    /// Whether the exponents come from the samples, not from theory.
    bool p_is_fitted = false, q_is_fitted = false;
    /// Whether the samples can tell the two terms apart: otherwise each has
    /// half of the sum.
    bool   is_separable = true;
    Misfit misfit;

    double
    first(const double x_1) const;

    double
    second(const double x_2) const;

    double
    operator()(const double x_1, const double x_2) const;

    /// What the second term may be where the first one is @p first_part and
    /// both together are @p sum; 0 if nothing is left.
    double
    rest(const double sum, const double first_part) const;
  };

  Misfit
  misfit_of(const TwoPowers &fit, const std::vector<Sample> &samples);


  /**
   * The run that has been taken for the truth, so that samples are differences
   * to it. Where its errors are orthogonal to these differences, as those of
   * Galerkin methods are in their norm, squares subtract (2), otherwise the
   * errors themselves (1).
   */
  struct Finer
  {
    double x_1, x_2;
    double m_1 = 1., m_2 = 1.;
  };


  /// What is believed of the exponents without samples.
  struct Prior
  {
    double p = 1., q = 1.;
    /// The residual of a deviation of 1 from these exponents, next to the
    /// residuals of log y: small values leave all to the samples, and decide
    /// where these say nothing.
    double weight = 1e-3;
    /// Whether there is no second term.
    bool is_one_term = false;
  };


  /**
   * Robust (Huber) least squares for log y: samples within some 1.5 median
   * deviations count in full, outliers by their sign. Samples that are not
   * finite, or not above @p smallest, are left out. An exponent that the
   * samples do not determine to 0.3 (one standard deviation) has the value of
   * the prior. With @p finer the terms are those of both runs subtracted; the
   * result is the law of the errors themselves.
   */
  TwoPowers
  fit_two_powers(const std::vector<Sample>  &samples,
                 const Prior                &prior    = Prior(),
                 const double                smallest = 0.,
                 const std::optional<Finer> &finer    = {});


  /// Relative errors: C_h h^p + C_k k^q, or the root of the sum of squares if
  /// that fits better; where nothing else is known p = q = 1 as in (5.14) and
  /// (5.20). What is below 1e-13 is rounding.
  TwoPowers
  fit_error(const std::vector<Sample>  &errors_at_h_and_k,
            const std::optional<Finer> &finer = {});


  /**
   * The same where each part is known by itself, as those of an error estimate
   * are: two fits of one power each. The misfit is that of the sum to the
   * samples.
   */
  TwoPowers
  fit_error_parts(const std::vector<Sample> &errors_at_h_and_k,
                  const std::vector<double> &parts_of_h,
                  const std::vector<double> &parts_of_k);
} // namespace Viscoplastic
