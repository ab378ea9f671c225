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
    fit_line(const std::vector<Sample> &samples, const double prior_p)
    {
      double n = 0., x = 0., y = 0., xx = 0., xy = 0.;
      for (const Sample &sample : samples)
        if (sample.y > 0.)
          {
            const double lx = std::log(sample.x_1), ly = std::log(sample.y);
            n += 1.;
            x += lx;
            y += ly;
            xx += lx * lx;
            xy += lx * ly;
          }
      TwoPowers result;
      if (n == 0.)
        return result;
      const double spread = xx - x * x / n;
      result.p_is_fitted  = spread > 1e-12;
      result.p      = result.p_is_fitted ? (xy - x * y / n) / spread : prior_p;
      result.c_1    = std::exp((y - result.p * x) / n);
      result.misfit = misfit_of(result, samples);
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
    // Solving is nearly linear; assembly is, factorizations n^(3/2) and n^2.
    Prior solve, factorize;
    solve.weight = factorize.weight = 0.3;
    solve.p                         = dim == 2 ? 1. : 4. / 3.;
    factorize.p                     = dim == 2 ? 1.2 : 1.7;
    CostModel model;
    model.set_up       = fit_two_powers(set_up, factorize);
    model.step         = fit_two_powers(step, solve);
    model.memory_model = fit_two_powers(memory, solve);
    model.simple       = fit_line(simple, solve.p);

    std::vector<double> log_ratios;
    for (const CostSample &s : samples)
      log_ratios.push_back(
        std::log(model.seconds(s.dofs, s.steps, s.n_set_ups) / s.seconds));
    model.misfit = misfit_of(log_ratios);
    return model;
  }



  double
  number_of_set_ups(const double steps, const double steps_per_mesh)
  {
    return steps_per_mesh > 0. ?
             std::max(1., std::ceil(steps / steps_per_mesh)) :
             1.;
  }
} // namespace Viscoplastic
