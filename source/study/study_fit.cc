// SPDX-License-Identifier: LGPL-2.1-or-later
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
    /// Of exponents that are fitted.
    constexpr double smallest_exponent = 0.25, largest_exponent = 5.;
    /// Below this share of every sample a term is not there.
    constexpr double invisible_share = 1e-4;

    /// Unknowns of the fit: logarithms of the coefficients, and exponents.
    using Unknowns = std::array<double, 4>; // log c_1, p, log c_2, q
    using Choice   = std::array<bool, 4>;   // which of them are free



    /// Samples by the logarithms of their coordinates, centred.
    struct Problem
    {
      std::vector<std::array<double, 3>>   samples;
      Prior                                prior;
      std::optional<std::array<double, 2>> finer;
      std::array<double, 2>                finer_m{{1., 1.}};

      struct Term
      {
        double value;
        /// d log(value) / d exponent.
        double slope;
      };

      /// exp(log_c) x^p, minus that of the finer run, at log x = @p l.
      Term
      term(const double log_c,
           const double p,
           const double l,
           const int    coordinate) const
      {
        if (!finer || (*finer)[coordinate] > l - 1e-6)
          return {std::exp(log_c + p * l), l};
        const double m = finer_m[coordinate], f = (*finer)[coordinate],
                     rest = -std::expm1(m * p * (f - l)); // 1 - (x_f/x)^(mp)
        return {std::exp(log_c + p * l) * std::pow(rest, 1. / m),
                (l - (1. - rest) * f) / rest};
      }

      std::array<Term, 2>
      terms(const Unknowns &x, const std::size_t i) const
      {
        std::array<Term, 2> result{{term(x[0], x[1], samples[i][0], 0),
                                    term(x[2], x[3], samples[i][1], 1)}};
        // What both runs have in common is not in their difference.
        for (const int c : {0, 1})
          if (finer && std::abs((*finer)[c] - samples[i][c]) <= 1e-6 &&
              (*finer)[1 - c] < samples[i][1 - c] - 1e-6)
            result[c].value = 0.;
        return result;
      }

      /// log(fit/sample).
      double
      residual(const Unknowns &x, const std::size_t i) const
      {
        const auto t = terms(x, i);
        return std::log(t[0].value + t[1].value) - samples[i][2];
      }

      std::vector<double>
      weights(const Unknowns &x) const
      {
        std::vector<double> sizes;
        for (std::size_t i = 0; i < samples.size(); ++i)
          sizes.push_back(std::abs(residual(x, i)));
        std::vector<double> sorted(sizes);
        std::nth_element(sorted.begin(),
                         sorted.begin() + sorted.size() / 2,
                         sorted.end());
        const double threshold =
          1.5 * std::max(0.02, 1.4826 * sorted[sorted.size() / 2]);
        for (double &size : sizes)
          size = size <= threshold ? 1. : threshold / size;
        return sizes;
      }

      double
      objective(const Unknowns &x, const std::vector<double> &weights) const
      {
        double sum = std::pow(prior.weight * (x[1] - prior.p), 2) +
                     std::pow(prior.weight * (x[3] - prior.q), 2);
        for (std::size_t i = 0; i < samples.size(); ++i)
          sum += weights[i] * std::pow(residual(x, i), 2);
        return sum;
      }

      /// J^T W J and J^T W r, over the free unknowns.
      void
      normal_equations(const Unknowns            &x,
                       const std::vector<double> &weights,
                       const std::vector<int>    &free,
                       FullMatrix<double>        &matrix,
                       Vector<double>            &right_side) const
      {
        matrix         = 0.;
        right_side     = 0.;
        const auto add = [&](const std::array<double, 4> &gradient,
                             const double                 residual,
                             const double                 weight) {
          for (unsigned int a = 0; a < free.size(); ++a)
            {
              right_side[a] += weight * gradient[free[a]] * residual;
              for (unsigned int b = 0; b < free.size(); ++b)
                matrix(a, b) += weight * gradient[free[a]] * gradient[free[b]];
            }
        };
        for (std::size_t i = 0; i < samples.size(); ++i)
          {
            const auto   t     = terms(x, i);
            const double share = t[0].value / (t[0].value + t[1].value);
            add({{share,
                  share * t[0].slope,
                  1. - share,
                  (1. - share) * t[1].slope}},
                residual(x, i),
                weights[i]);
          }
        add({{0., prior.weight, 0., 0.}}, prior.weight * (x[1] - prior.p), 1.);
        add({{0., 0., 0., prior.weight}}, prior.weight * (x[3] - prior.q), 1.);
      }
    };



    std::vector<int>
    indices(const Choice &free)
    {
      std::vector<int> result;
      for (int a = 0; a < 4; ++a)
        if (free[a])
          result.push_back(a);
      return result;
    }



    /// Levenberg-Marquardt with weights that follow the residuals.
    double
    minimise(const Problem &problem, const Choice &choice, Unknowns &x)
    {
      const std::vector<int> free    = indices(choice);
      const unsigned int     n       = free.size();
      double                 damping = 1e-2;
      std::vector<double>    weights = problem.weights(x);
      double                 value   = problem.objective(x, weights);
      for (unsigned int iteration = 0; iteration < 200; ++iteration)
        {
          FullMatrix<double> matrix(n);
          Vector<double>     right_side(n), step(n);
          problem.normal_equations(x, weights, free, matrix, right_side);
          for (unsigned int a = 0; a < n; ++a)
            matrix(a, a) += damping * matrix(a, a) + 1e-12;
          matrix.gauss_jordan();
          matrix.vmult(step, right_side);
          Unknowns candidate = x;
          for (unsigned int a = 0; a < n; ++a)
            candidate[free[a]] -= std::clamp(step[a], -2., 2.);
          for (const int a : {1, 3})
            if (choice[a])
              candidate[a] =
                std::clamp(candidate[a], smallest_exponent, largest_exponent);
          for (const int a : {0, 2})
            candidate[a] = std::clamp(candidate[a], -60., 60.);
          const double new_value = problem.objective(candidate, weights);
          if (!(new_value < value))
            {
              damping *= 4.;
              if (damping > 1e8)
                break;
              continue;
            }
          const bool converged = value - new_value < 1e-9 * value + 1e-15;
          x                    = candidate;
          weights              = problem.weights(x);
          value                = problem.objective(x, weights);
          damping              = std::max(1e-9, damping / 5.);
          if (converged)
            break;
        }
      return value;
    }



    /// The best of several starts: who explains the errors is not known.
    Unknowns
    best_fit(const Problem  &problem,
             const Choice   &choice,
             const Unknowns &fixed)
    {
      Unknowns best{};
      double   lowest = std::numeric_limits<double>::infinity();
      // The coordinates are centred, and so the mean is at 0.
      double mean = 0.;
      for (const auto &sample : problem.samples)
        mean += sample[2] / problem.samples.size();
      for (const double p : {0.5, 1., 2.})
        for (const double q : {0.5, 1., 2.})
          for (const double share : {0.05, 0.5, 0.95})
            {
              Unknowns x = fixed;
              if (choice[0])
                x[0] = mean + std::log(share);
              if (choice[2])
                x[2] = mean + std::log(1. - share);
              if (choice[1])
                x[1] = p;
              if (choice[3])
                x[3] = q;
              const double value = minimise(problem, choice, x);
              if (value < lowest)
                {
                  lowest = value;
                  best   = x;
                }
            }
      return best;
    }



    /// Standard deviation of an unknown, for deviations of at least 1 % in the
    /// samples.
    double
    deviation(const Problem  &problem,
              const Choice   &choice,
              const Unknowns &x,
              const int       which)
    {
      const std::vector<int>    free    = indices(choice);
      const std::vector<double> weights = problem.weights(x);
      FullMatrix<double>        matrix(free.size());
      Vector<double>            right_side(free.size());
      problem.normal_equations(x, weights, free, matrix, right_side);
      double square = 0.;
      for (std::size_t i = 0; i < problem.samples.size(); ++i)
        square += weights[i] * std::pow(problem.residual(x, i), 2);
      const double n_excess =
        std::max<double>(1.,
                         static_cast<double>(problem.samples.size()) -
                           static_cast<double>(free.size()));
      for (unsigned int a = 0; a < free.size(); ++a)
        matrix(a, a) += 1e-12;
      matrix.gauss_jordan();
      const auto position =
        std::find(free.begin(), free.end(), which) - free.begin();
      return std::max(0.01, std::sqrt(square / n_excess)) *
             std::sqrt(std::max(0., matrix(position, position)));
    }



    unsigned int
    n_distinct(const Problem &problem, const unsigned int coordinate)
    {
      std::vector<double> found;
      for (const auto &sample : problem.samples)
        if (std::none_of(found.begin(), found.end(), [&](const double x) {
              return std::abs(x - sample[coordinate]) < 1e-6;
            }))
          found.push_back(sample[coordinate]);
      return found.size();
    }



    /// Whether one coordinate follows from the other; then @p slope is
    /// d log x_2 / d log x_1.
    bool
    is_one_path(const Problem &problem, double &slope)
    {
      double s_11 = 0., s_12 = 0., s_22 = 0.;
      for (const auto &sample : problem.samples) // centred
        {
          s_11 += sample[0] * sample[0];
          s_12 += sample[0] * sample[1];
          s_22 += sample[1] * sample[1];
        }
      if (!(s_11 > 0.) || !(s_22 > 0.) || s_12 * s_12 < 0.998 * s_11 * s_22)
        return false;
      slope = s_12 / s_11;
      return true;
    }
  } // namespace



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

    Problem                   problem{{}, prior, {}, {{1., 1.}}};
    std::vector<unsigned int> index;
    std::array<double, 2>     centre{{0., 0.}};
    for (unsigned int i = 0; i < samples.size(); ++i)
      if (std::isfinite(samples[i].y) && samples[i].y > smallest &&
          samples[i].x_1 > 0. && samples[i].x_2 > 0.)
        {
          problem.samples.push_back({{std::log(samples[i].x_1),
                                      std::log(samples[i].x_2),
                                      std::log(samples[i].y)}});
          index.push_back(i);
        }
    result.n_samples = index.size();
    if (index.empty())
      return result;
    for (const auto &sample : problem.samples)
      for (unsigned int c = 0; c < 2; ++c)
        centre[c] += sample[c] / index.size();
    for (auto &sample : problem.samples)
      for (unsigned int c = 0; c < 2; ++c)
        sample[c] -= centre[c];

    if (finer)
      {
        problem.finer = std::array<double, 2>{
          {std::log(finer->x_1) - centre[0], std::log(finer->x_2) - centre[1]}};
        problem.finer_m = {{finer->m_1, finer->m_2}};
      }

    const unsigned int n_1 = n_distinct(problem, 0),
                       n_2 = n_distinct(problem, 1), n = index.size();
    Unknowns x{{0., prior.p, 0., prior.q}};
    double   slope = 1.;
    if (!prior.is_one_term && n_1 > 1 && n_2 > 1 && is_one_path(problem, slope))
      {
        // Half of one power each: this is all that the samples say.
        result.is_separable = false;
        Choice choice{{true, !prior.p_is_fixed, false, false}};
        x[2] = -60.;
        x    = best_fit(problem, choice, x);
        x[0] -= std::log(2.);
        x[2]               = x[0];
        x[3]               = x[1] / slope;
        result.p_is_fitted = result.q_is_fitted = !prior.p_is_fixed;
      }
    else
      {
        // Something that does not vary is a constant, whose share still shows
        // beside what varies; of two constants only the sum does.
        Choice choice{{true,
                       n_1 > 1 && !prior.p_is_fixed,
                       n_2 > 1 || n_1 > 1,
                       n_2 > 1 && !prior.q_is_fixed}};
        if (prior.is_one_term)
          choice[2] = choice[3] = false;
        if (!choice[2])
          x[2] = -60.;
        const auto n_free = [&choice] {
          return static_cast<unsigned int>(
            std::count(choice.begin(), choice.end(), true));
        };
        if (n_free() > n && choice[3])
          choice[3] = false;
        if (n_free() > n && choice[1])
          choice[1] = false;
        if (n_free() > n && choice[2])
          {
            choice[2] = false;
            x[2]      = -60.;
          }
        Unknowns fixed = x;
        x              = best_fit(problem, choice, fixed);
        // Exponents that could be anything, or want to be nonsense.
        for (const int a : {3, 1})
          if (choice[a] &&
              (deviation(problem, choice, x, a) > 0.3 ||
               x[a] <= smallest_exponent || x[a] >= largest_exponent))
            {
              choice[a] = false;
              x         = best_fit(problem, choice, fixed);
            }
        result.p_is_fitted = choice[1];
        result.q_is_fitted = choice[3];
      }

    // Terms that no sample sees.
    double largest_share = 0., smallest_share = 1.;
    for (unsigned int i = 0; i < n; ++i)
      {
        const auto   t     = problem.terms(x, i);
        const double share = t[0].value / (t[0].value + t[1].value);
        largest_share      = std::max(largest_share, share);
        smallest_share     = std::min(smallest_share, share);
      }
    result.p   = x[1];
    result.q   = x[3];
    result.c_1 = std::exp(x[0] - x[1] * centre[0]);
    result.c_2 = std::exp(x[2] - x[3] * centre[1]);
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

    double              square = 0., worst = -1.;
    std::vector<double> sizes;
    for (unsigned int i = 0; i < n; ++i)
      {
        const double r = problem.residual(x, i);
        square += r * r;
        sizes.push_back(std::abs(r));
        if (std::abs(r) > worst)
          {
            worst               = std::abs(r);
            result.worst_sample = index[i];
          }
      }
    result.rms = std::sqrt(square / n);
    std::nth_element(sizes.begin(), sizes.begin() + n / 2, sizes.end());
    result.median       = sizes[n / 2];
    result.worst_factor = std::exp(worst);
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
        sum.n_samples < 4)
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
    if (!(root.median / 2. < 0.8 * sum.median - 1e-5))
      return sum;
    root.m = 2.;
    root.p /= 2.;
    root.q /= 2.;
    root.c_1          = std::sqrt(root.c_1);
    root.c_2          = std::sqrt(root.c_2);
    root.rms          = root.rms / 2.;
    root.median       = root.median / 2.;
    root.worst_factor = std::sqrt(root.worst_factor);
    return root;
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
    result.n_samples       = 0;
    result.worst_factor    = 1.;
    double square          = 0.;
    for (std::size_t i = 0; i < errors_at_h_and_k.size(); ++i)
      {
        const Sample &sample = errors_at_h_and_k[i];
        const double  r = std::log(result(sample.x_1, sample.x_2) / sample.y);
        if (!std::isfinite(r))
          continue;
        ++result.n_samples;
        square += r * r;
        if (std::exp(std::abs(r)) > result.worst_factor)
          {
            result.worst_factor = std::exp(std::abs(r));
            result.worst_sample = static_cast<unsigned int>(i);
          }
      }
    result.rms = std::sqrt(square / result.n_samples); // nan for none
    return result;
  }
} // namespace Viscoplastic
