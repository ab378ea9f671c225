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



  SolverDemand
  CostModel::demand_at(const double dofs,
                       const double steps,
                       const double n_set_ups) const
  {
    SolverDemand result = demand;
    result.n_dofs       = std::llround(dofs);
    result.n_solves     = static_cast<unsigned int>(
      std::clamp(demand.solves_per_step * steps / n_set_ups, 1., 1e8));
    // What is finer than a mesh that is not refined is refined from it.
    if (demand.n_first_dofs == 0 && dofs > 1.5 * demand.n_dofs)
      result.n_first_dofs = demand.n_dofs;
    if (demand.n_dofs > 0)
      // A face has one dimension less than its body.
      result.n_face_dofs = std::llround(
        demand.n_face_dofs *
        std::pow(dofs / demand.n_dofs, (demand.dim - 1.) / demand.dim));
    return result;
  }



  double
  CostModel::seconds(const double dofs,
                     const double steps,
                     const double n_set_ups) const
  {
    if (solvers.empty())
      return 0.;
    const SolverDemand   wanted = demand_at(dofs, steps, n_set_ups);
    const BulkSolverKind kind   = choose_bulk_solver(wanted);
    auto                 known  = solvers.find(kind);
    if (known != solvers.end() && known->second.step.p_is_fitted)
      return n_set_ups * known->second.set_up(dofs, 1.) +
             steps * known->second.step(dofs, 1.);

    if (known == solvers.end())
      known = std::max_element(solvers.begin(),
                               solvers.end(),
                               [](const auto &a, const auto &b) {
                                 return a.second.largest < b.second.largest;
                               });
    const auto &[known_kind, fit] = *known;
    const double     n            = fit.largest;
    const SolverCost there        = expected_cost(known_kind,
                                           demand_at(n, steps, n_set_ups)),
                     here         = expected_cost(kind, wanted);
    return n_set_ups * fit.set_up(n, 1.) * here.set_up / there.set_up +
           steps * fit.step(n, 1.) * here.step / there.step;
  }



  double
  CostModel::memory(const double dofs,
                    const double steps,
                    const double n_set_ups) const
  {
    const SolverDemand wanted = demand_at(dofs, steps, n_set_ups);
    return 1e-6 * expected_memory(choose_bulk_solver(wanted), wanted) +
           other_memory(dofs, 1.);
  }



  CostModel
  fit_cost(const std::vector<CostSample> &samples)
  {
    CostModel model;
    if (samples.empty())
      return model;
    for (const CostSample &s : samples)
      if (s.demand.n_dofs >= model.demand.n_dofs)
        model.demand = s.demand;

    struct Samples
    {
      std::vector<Sample> set_up, step;
    };
    std::map<BulkSolverKind, Samples> by_solver;
    std::vector<Sample>               other_memory, simple;
    for (const CostSample &s : samples)
      {
        const double         n    = s.demand.n_dofs;
        const BulkSolverKind kind = choose_bulk_solver(s.demand);
        Samples             &own  = by_solver[kind];
        own.set_up.push_back({n, 1., s.set_up_seconds / s.n_set_ups});
        own.step.push_back({n, 1., (s.seconds - s.set_up_seconds) / s.steps});
        other_memory.push_back(
          {n, 1., s.memory - 1e-6 * expected_memory(kind, s.demand)});
        simple.push_back({n, 1., s.seconds / s.steps});
      }

    // Some 10 % of noise in seconds against exponents known to a few tenths.
    // Solving is nearly linear; assembly is, factorizations n^(3/2) and n^2.
    const bool is_2d = model.demand.dim == 2;
    Prior      linear, solve, factorize;
    linear.weight = solve.weight = factorize.weight = 0.3;
    solve.p                                         = is_2d ? 1. : 4. / 3.;
    factorize.p                                     = is_2d ? 1.2 : 1.7;
    for (const auto &[kind, own] : by_solver)
      {
        const bool             is_direct = kind == BulkSolverKind::direct;
        CostModel::SolverModel fit       = {
                fit_two_powers(own.set_up, is_direct ? factorize : linear),
                fit_two_powers(own.step, is_direct ? solve : linear),
                0.};
        for (const Sample &sample : own.step)
          fit.largest = std::max(fit.largest, sample.x_1);
        model.solvers.emplace(kind, fit);
      }
    // Meshes, spaces and states.
    linear.weight      = 10.;
    model.other_memory = fit_two_powers(other_memory, linear);
    model.simple       = fit_line(simple, solve.p);

    std::vector<double> seconds, memory;
    for (const CostSample &s : samples)
      {
        const double n      = s.demand.n_dofs;
        const auto  &solver = model.solvers.at(choose_bulk_solver(s.demand));
        seconds.push_back(std::log(
          (s.n_set_ups * solver.set_up(n, 1.) + s.steps * solver.step(n, 1.)) /
          s.seconds));
        memory.push_back(std::log(
          (1e-6 * expected_memory(choose_bulk_solver(s.demand), s.demand) +
           model.other_memory(n, 1.)) /
          s.memory));
      }
    model.misfit        = misfit_of(seconds);
    model.memory_misfit = misfit_of(memory);
    return model;
  }

} // namespace Viscoplastic
