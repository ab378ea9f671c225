// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/study_cost.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// c_1 x_1^p: a line in logarithms, by least squares. The exponent of
    /// samples with one x_1 is @p prior_p.
    TwoPowers
    fit_line(const std::vector<Sample> &simple, const double prior_p)
    {
      TwoPowers result;
      double    n = 0., x = 0., y = 0., xx = 0., xy = 0.;
      for (const Sample &s : simple)
        if (s.y > 0.)
          {
            const double lx = std::log(s.x_1), ly = std::log(s.y);
            n += 1.;
            x += lx;
            y += ly;
            xx += lx * lx;
            xy += lx * ly;
          }
      const double spread = xx - x * x / std::max(n, 1.);
      result.p           = spread > 1e-12 ? (xy - x * y / n) / spread : prior_p;
      result.p_is_fitted = spread > 1e-12;
      result.n_samples   = static_cast<unsigned int>(n);
      if (n > 0.)
        result.c_1 = std::exp((y - result.p * x) / n);
      double square = 0.;
      for (unsigned int i = 0; i < simple.size(); ++i)
        if (simple[i].y > 0.)
          {
            const double r =
              std::log(result.first(simple[i].x_1) / simple[i].y);
            square += r * r;
            if (std::exp(std::abs(r)) > result.worst_factor)
              {
                result.worst_factor = std::exp(std::abs(r));
                result.worst_sample = i;
              }
          }
      result.rms = std::sqrt(square / std::max(n, 1.));
      return result;
    }
  } // namespace



  double
  CostModel::seconds(const double dofs,
                     const double steps,
                     const double n_set_ups) const
  {
    return n_set_ups * set_up(dofs, 1.) + steps * step(dofs, 1.);
  }



  CostModel
  fit_cost(const std::vector<CostSample> &samples, const unsigned int dim)
  {
    std::vector<Sample> set_up, step, memory, simple;
    for (const CostSample &s : samples)
      {
        set_up.push_back({s.dofs, 1., s.set_up_seconds / s.n_set_ups});
        step.push_back({s.dofs, 1., (s.seconds - s.set_up_seconds) / s.steps});
        memory.push_back({s.dofs, 1., s.memory});
        simple.push_back({s.dofs, 1., s.seconds / s.steps});
      }
    // Some 10 % of noise in seconds against exponents known to a few tenths.
    Prior solve;
    solve.p          = dim == 2 ? 1. : 4. / 3.;
    solve.q          = 0.;
    solve.weight     = 0.3;
    solve.q_is_fixed = true;
    CostModel model;
    // Assembly is linear, factorisations n^(3/2) and n^2.
    Prior factorise    = solve;
    factorise.p        = dim == 2 ? 1.2 : 1.7;
    model.set_up       = fit_two_powers(set_up, factorise);
    model.step         = fit_two_powers(step, solve);
    model.memory_model = fit_two_powers(memory, solve);

    model.simple = fit_line(simple, solve.p);

    double square = 0.;
    for (unsigned int i = 0; i < samples.size(); ++i)
      {
        const CostSample &s = samples[i];
        const double      r =
          std::log(model.seconds(s.dofs, s.steps, s.n_set_ups) / s.seconds);
        if (!std::isfinite(r))
          continue;
        ++model.n_samples;
        square += r * r;
        if (std::exp(std::abs(r)) > model.worst_factor)
          {
            model.worst_factor = std::exp(std::abs(r));
            model.worst_sample = i;
          }
      }
    if (model.n_samples > 0)
      model.rms = std::sqrt(square / model.n_samples);
    return model;
  }
} // namespace Viscoplastic
