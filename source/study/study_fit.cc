// SPDX-License-Identifier: LGPL-2.1-or-later

// These fits are not those of a library (scipy.optimize.least_squares is one)
// because `--price' makes them inside the program, where there may be no
// Python; and the iteration, which is all that a library would take over, is
// the smaller part: weights, priors, differences to a finer run and the choice
// of what the samples determine would remain.

#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/study/study_fit.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// The unknowns of a fit: log c_1, p, log c_2, q.
    using Unknowns = std::array<double, 4>;
    /// Which of them the samples determine.
    using Choice = std::array<bool, 4>;

    /// Their ranges. A coefficient of e^-60 means that the term is not there.
    constexpr Unknowns smallest_value{{-60., 0.25, -60., 0.25}};
    constexpr Unknowns largest_value{{60., 5., 60., 5.}};
    /// Below this share of every sample a term does not show.
    constexpr double invisible_share = 1e-4;
    /// Logarithms of coordinates that are closer are the same.
    constexpr double same = 1e-6;



    /// One equation of the least squares.
    struct Equation
    {
      double residual;
      /// The derivatives of the residual.
      Unknowns gradient;
      double   weight = 1.;
    };



    /// What a fit goes by, in logarithms.
    struct Problem
    {
      /// Those of x_1, x_2 (both with the mean 0) and y.
      std::vector<std::array<double, 3>> samples;
      Prior                              prior;
      /// With x_1 and x_2 like those of the samples.
      std::optional<Finer> finer;

      /// The residual of a sample is log(fit/sample).
      Equation
      equation(const Unknowns &x, const std::array<double, 3> &sample) const
      {
        std::array<double, 2> term, slope; // slope: d log(term) / d exponent
        for (const int c : {0, 1})
          {
            const double p = x[2 * c + 1], l = sample[c];
            term[c]  = std::exp(x[2 * c] + p * l);
            slope[c] = l;
            if (!finer)
              continue;
            const std::array<double, 2> at{{finer->x_1, finer->x_2}};
            const double m = c == 0 ? finer->m_1 : finer->m_2, f = at[c];
            if (f < l - same)
              {
                // 1 - (x_finer/x)^(m p)
                const double rest = -std::expm1(m * p * (f - l));
                term[c] *= std::pow(rest, 1. / m);
                slope[c] = (l - (1. - rest) * f) / rest;
              }
            else if (f < l + same && at[1 - c] < sample[1 - c] - same)
              term[c] = 0.; // in both runs, and not in their difference
          }
        const double sum = term[0] + term[1], share = term[0] / sum;
        return {
          std::log(sum) - sample[2],
          {{share, share * slope[0], 1. - share, (1. - share) * slope[1]}}};
      }

      /// The equations of all samples, with Huber's weights, and two for the
      /// prior.
      std::vector<Equation>
      equations(const Unknowns &x) const
      {
        std::vector<Equation> result;
        std::vector<double>   sizes;
        for (const auto &sample : samples)
          {
            result.push_back(equation(x, sample));
            sizes.push_back(std::abs(result.back().residual));
          }
        const auto middle = sizes.begin() + sizes.size() / 2;
        std::nth_element(sizes.begin(), middle, sizes.end());
        const double threshold = 1.5 * std::max(0.02, 1.4826 * *middle);
        for (Equation &sample : result)
          sample.weight = std::min(1., threshold / std::abs(sample.residual));
        const double w = prior.weight;
        result.push_back({w * (x[1] - prior.p), {{0., w, 0., 0.}}});
        result.push_back({w * (x[3] - prior.q), {{0., 0., 0., w}}});
        return result;
      }
    };



    /// The sum of the squares of residuals, with the weights of other ones.
    double
    sum_of_squares(const std::vector<Equation> &equations,
                   const std::vector<Equation> &weights)
    {
      double sum = 0.;
      for (std::size_t i = 0; i < equations.size(); ++i)
        sum += weights[i].weight * std::pow(equations[i].residual, 2);
      return sum;
    }



    /// The inverse of J^T W J with its diagonal enlarged by @p damping; that of
    /// the identity for unknowns that are not chosen.
    FullMatrix<double>
    inverse(const std::vector<Equation> &equations,
            const Choice                &choice,
            const double                 damping = 0.)
    {
      FullMatrix<double> matrix(4);
      for (const Equation &equation : equations)
        for (const unsigned int a : {0, 1, 2, 3})
          for (const unsigned int b : {0, 1, 2, 3})
            if (choice[a] && choice[b])
              matrix(a, b) +=
                equation.weight * equation.gradient[a] * equation.gradient[b];
      for (const unsigned int a : {0, 1, 2, 3})
        matrix(a, a) = choice[a] ? (1. + damping) * matrix(a, a) + 1e-12 : 1.;
      matrix.gauss_jordan();
      return matrix;
    }



    /// Levenberg-Marquardt with weights that follow the residuals.
    double
    minimize(const Problem &problem, const Choice &choice, Unknowns &x)
    {
      std::vector<Equation> equations = problem.equations(x);
      double value = sum_of_squares(equations, equations), damping = 1e-2;
      for (unsigned int i = 0; i < 200 && damping <= 1e8; ++i)
        {
          Vector<double> right_side(4), step(4);
          for (const Equation &equation : equations)
            for (const unsigned int a : {0, 1, 2, 3})
              right_side[a] +=
                equation.weight * equation.gradient[a] * equation.residual;
          inverse(equations, choice, damping).vmult(step, right_side);
          Unknowns candidate = x;
          for (const unsigned int a : {0, 1, 2, 3})
            if (choice[a])
              candidate[a] = std::clamp(x[a] - std::clamp(step[a], -2., 2.),
                                        smallest_value[a],
                                        largest_value[a]);
          std::vector<Equation> there     = problem.equations(candidate);
          const double          new_value = sum_of_squares(there, equations);
          if (!(new_value < value))
            {
              damping *= 4.;
              continue;
            }
          const bool converged = value - new_value < 1e-9 * value + 1e-15;
          x                    = candidate;
          equations.swap(there);
          value   = sum_of_squares(equations, equations);
          damping = std::max(1e-9, damping / 5.);
          if (converged)
            break;
        }
      return value;
    }



    /// The best of several initial guesses: which term explains the errors is
    /// not known. Unknowns that are not chosen are those of @p fixed.
    Unknowns
    best_fit(const Problem  &problem,
             const Choice   &choice,
             const Unknowns &fixed)
    {
      const auto guesses = [&](const int a) {
        return choice[a] ? std::vector<double>{0.5, 1., 2.} :
                           std::vector<double>{fixed[a]};
      };
      double mean = 0.;
      for (const auto &sample : problem.samples)
        mean += sample[2] / problem.samples.size();
      Unknowns best   = fixed;
      double   lowest = std::numeric_limits<double>::infinity();
      for (const double p : guesses(1))
        for (const double q : guesses(3))
          for (const double share : {0.05, 0.5, 0.95})
            {
              Unknowns x = fixed;
              x[0]       = mean + std::log(share);
              x[1]       = p;
              x[3]       = q;
              if (choice[2])
                x[2] = mean + std::log(1. - share);
              const double value = minimize(problem, choice, x);
              if (value < lowest)
                {
                  lowest = value;
                  best   = x;
                }
            }
      return best;
    }



    unsigned int
    n_chosen(const Choice &choice)
    {
      return std::count(choice.begin(), choice.end(), true);
    }



    /// Standard deviation of the unknown @p which, for deviations of at least
    /// 1 % in the samples.
    double
    deviation(const Problem     &problem,
              const Choice      &choice,
              const Unknowns    &x,
              const unsigned int which)
    {
      std::vector<Equation> equations = problem.equations(x);
      const double          variance = inverse(equations, choice)(which, which);
      equations.resize(problem.samples.size()); // without the prior
      const double n_excess =
        std::max(1., 1. * equations.size() - n_chosen(choice));
      const double square = sum_of_squares(equations, equations) / n_excess;
      return std::sqrt(std::max(1e-4, square) * std::max(0., variance));
    }
  } // namespace



  Misfit
  misfit_of(const std::vector<double> &log_ratios)
  {
    Misfit              result;
    double              square = 0.;
    std::vector<double> sizes;
    for (unsigned int i = 0; i < log_ratios.size(); ++i)
      if (const double size = std::abs(log_ratios[i]); std::isfinite(size))
        {
          sizes.push_back(size);
          square += size * size;
          if (std::exp(size) > result.worst_factor)
            {
              result.worst_factor = std::exp(size);
              result.worst_sample = i;
            }
        }
    result.n_samples = sizes.size();
    if (sizes.empty())
      return result;
    result.rms        = std::sqrt(square / sizes.size());
    const auto middle = sizes.begin() + sizes.size() / 2;
    std::nth_element(sizes.begin(), middle, sizes.end());
    result.median = *middle;
    return result;
  }



  Misfit
  misfit_of(const TwoPowers &fit, const std::vector<Sample> &samples)
  {
    std::vector<double> log_ratios;
    for (const Sample &sample : samples)
      log_ratios.push_back(std::log(fit(sample.x_1, sample.x_2) / sample.y));
    return misfit_of(log_ratios);
  }



  double
  TwoPowers::first(const double x_1) const
  {
    return c_1 > 0. ? c_1 * std::pow(x_1, p) : 0.;
  }



  double
  TwoPowers::second(const double x_2) const
  {
    return c_2 > 0. ? c_2 * std::pow(x_2, q) : 0.;
  }



  double
  TwoPowers::operator()(const double x_1, const double x_2) const
  {
    return m == 1. ? first(x_1) + second(x_2) :
                     std::hypot(first(x_1), second(x_2));
  }



  double
  TwoPowers::rest(const double sum, const double first_part) const
  {
    const double power = std::pow(sum, m) - std::pow(first_part, m);
    return power > 0. ? std::pow(power, 1. / m) : 0.;
  }



  TwoPowers
  fit_two_powers(const std::vector<Sample>  &samples,
                 const Prior                &prior,
                 const double                smallest,
                 const std::optional<Finer> &finer)
  {
    TwoPowers result;
    result.p = prior.p;
    result.q = prior.q;

    Problem                  problem{{}, prior, finer};
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (const auto &[x_1, x_2, y] = samples[i];
          std::isfinite(y) && y > smallest && x_1 > 0. && x_2 > 0.)
        {
          problem.samples.push_back(
            {{std::log(x_1), std::log(x_2), std::log(y)}});
          index.push_back(i);
        }
    if (index.empty())
      return result;
    std::array<double, 2> center{{0., 0.}};
    for (const auto &sample : problem.samples)
      for (const int c : {0, 1})
        center[c] += sample[c] / index.size();
    for (auto &sample : problem.samples)
      for (const int c : {0, 1})
        sample[c] -= center[c];
    if (finer)
      {
        problem.finer->x_1 = std::log(finer->x_1) - center[0];
        problem.finer->x_2 = std::log(finer->x_2) - center[1];
      }

    double s_11 = 0., s_12 = 0., s_22 = 0.;
    for (const auto &sample : problem.samples)
      {
        s_11 += sample[0] * sample[0];
        s_12 += sample[0] * sample[1];
        s_22 += sample[1] * sample[1];
      }
    const bool varies_1 = s_11 > same * same, varies_2 = s_22 > same * same;
    Unknowns   x{{0., prior.p, smallest_value[2], prior.q}};
    if (!prior.is_one_term && varies_1 && varies_2 &&
        s_12 * s_12 >= 0.998 * s_11 * s_22)
      {
        // One coordinate follows from the other.
        // Half of one power each: this is all that the samples say.
        result.is_separable = false;
        result.p_is_fitted = result.q_is_fitted = true;
        x = best_fit(problem, {{true, true, false, false}}, x);
        x[0] -= std::log(2.);
        x[2] = x[0];
        x[3] = x[1] * s_11 / s_12;
      }
    else
      {
        // Something that does not vary is a constant, whose share still shows
        // beside what varies; of two constants only the sum does.
        const bool has_second = !prior.is_one_term && (varies_1 || varies_2);
        Choice     choice{{true, varies_1, has_second, has_second && varies_2}};
        for (const int a : {3, 1, 2})
          if (n_chosen(choice) > index.size())
            choice[a] = false;
        const Unknowns fixed = x;
        x                    = best_fit(problem, choice, fixed);
        // Exponents that could be anything, or want to be nonsense.
        for (const unsigned int a : {3, 1})
          if (choice[a] &&
              (deviation(problem, choice, x, a) > 0.3 ||
               x[a] <= smallest_value[a] || x[a] >= largest_value[a]))
            {
              choice[a] = false;
              x         = best_fit(problem, choice, fixed);
            }
        result.p_is_fitted = choice[1];
        result.q_is_fitted = choice[3];
      }
    result.p   = x[1];
    result.q   = x[3];
    result.c_1 = std::exp(x[0] - x[1] * center[0]);
    result.c_2 = std::exp(x[2] - x[3] * center[1]);

    // Terms that no sample sees.
    double              largest_share = 0., smallest_share = 1.;
    std::vector<double> log_ratios(samples.size(),
                                   std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < index.size(); ++i)
      {
        const Equation equation = problem.equation(x, problem.samples[i]);
        largest_share           = std::max(largest_share, equation.gradient[0]);
        smallest_share       = std::min(smallest_share, equation.gradient[0]);
        log_ratios[index[i]] = equation.residual;
      }
    if (largest_share < invisible_share)
      {
        result.c_1         = 0.;
        result.p           = prior.p;
        result.p_is_fitted = false;
      }
    if (smallest_share > 1. - invisible_share)
      {
        result.c_2         = 0.;
        result.q           = prior.q;
        result.q_is_fitted = false;
      }
    result.misfit = misfit_of(log_ratios);
    return result;
  }



  TwoPowers
  fit_error(const std::vector<Sample>  &errors_at_h_and_k,
            const std::optional<Finer> &finer)
  {
    constexpr double rounding = 1e-13;
    const TwoPowers  sum =
      fit_two_powers(errors_at_h_and_k, Prior(), rounding, finer);
    if (!sum.is_separable || sum.c_1 == 0. || sum.c_2 == 0. ||
        sum.misfit.n_samples < 4)
      return sum;

    // The same for the squares.
    std::vector<Sample> squares = errors_at_h_and_k;
    for (Sample &sample : squares)
      sample.y *= sample.y;
    std::optional<Finer> of_squares = finer;
    if (finer)
      {
        of_squares->m_1 /= 2.;
        of_squares->m_2 /= 2.;
      }
    Prior prior;
    prior.p = prior.q = 2.;
    TwoPowers root =
      fit_two_powers(squares, prior, rounding * rounding, of_squares);
    root.m = 2.;
    root.p /= 2.;
    root.q /= 2.;
    root.c_1 = std::sqrt(root.c_1);
    root.c_2 = std::sqrt(root.c_2);
    root.misfit.rms /= 2.;
    root.misfit.median /= 2.;
    root.misfit.worst_factor = std::sqrt(root.misfit.worst_factor);
    return root.misfit.median < 0.8 * sum.misfit.median - 1e-5 ? root : sum;
  }



  TwoPowers
  fit_error_parts(const std::vector<Sample> &errors_at_h_and_k,
                  const std::vector<double> &parts_of_h,
                  const std::vector<double> &parts_of_k)
  {
    Prior prior;
    prior.is_one_term = true;
    std::vector<Sample> space, time;
    for (std::size_t i = 0; i < errors_at_h_and_k.size(); ++i)
      {
        space.push_back({errors_at_h_and_k[i].x_1, 1., parts_of_h[i]});
        time.push_back({errors_at_h_and_k[i].x_2, 1., parts_of_k[i]});
      }
    TwoPowers       result = fit_two_powers(space, prior, 1e-13);
    const TwoPowers of_k   = fit_two_powers(time, prior, 1e-13);
    result.c_2             = of_k.c_1;
    result.q               = of_k.p;
    result.q_is_fitted     = of_k.p_is_fitted;
    result.misfit          = misfit_of(result, errors_at_h_and_k);
    return result;
  }
} // namespace Viscoplastic
