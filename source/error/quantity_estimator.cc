// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/error/error_estimator.h>
#include <viscoplastic_contact/error/quantity_estimator.h>

#include <cmath>

namespace Viscoplastic
{
  template <int dim>
  QuantityEstimator<dim>::QuantityEstimator(
    const Discretization<dim> &discretization,
    const SpaceEstimator<dim> &space_estimator)
    : discretization(discretization)
    , space_estimator(space_estimator)
    , dual_problem(discretization, *discretization.scene().quantity)
  {}



  template <int dim>
  void
  QuantityEstimator<dim>::assess(BulkSolver          &solver,
                                 EvaluatedState<dim> &end) const
  {
    const StressSpace<dim> &stress_space = discretization.stress_space;
    const State<dim>       &state        = end.state;
    const DualSolution<dim> dual = dual_problem.solve(solver, state.friction);
    const auto              products = space_estimator.multiply(state, dual);

    std::vector<double> sums(3, 0.);
    Vector<double>      indicators(products.of_both);
    for (unsigned int c = 0; c < indicators.size(); ++c)
      {
        sums[0] += products.of_both[c];
        sums[1] += products.of_dual[c];
        indicators[c] = std::abs(indicators[c]);
        sums[2] += indicators[c];
      }
    Utilities::MPI::sum(sums, discretization.space.communicator, sums);
    double time = 0.;
    if (discretization.scene().has_viscosity()) // collective
      {
        DistributedVector load = discretization.space.owned_vector();
        add_irreversible_load(stress_space, state.time_error, load);
        time = dual_problem.sign() * (load * dual.w);
      }

    const ErrorEstimate &errors   = end.errors;
    QuantityEstimate    &estimate = end.errors.quantity;
    const double         mesh     = dual_problem.sign() * sums[0];
    estimate.value                = dual_problem.value(state, end.forces);
    estimate.correction           = mesh + time;
    estimate.unsigned_space       = safety * sums[2];
    estimate.dual_norm            = dual.norm;
    estimate.dual_error           = std::sqrt(sums[1]);
    estimate.space                = safety * std::abs(mesh);
    estimate.time                 = std::abs(time);
    estimate.friction             = errors.friction * dual.norm;
    estimate.transfer             = errors.transfer * estimate.dual_error;
    estimate.algebraic            = errors.algebraic * dual.norm;
    estimate.initial              = errors.initial * estimate.dual_error;
    if (end.space_estimate.squared_indicators.size() > 0)
      end.space_estimate.squared_indicators = std::move(indicators);
  }



  template class QuantityEstimator<2>;
  template class QuantityEstimator<3>;
} // namespace Viscoplastic
