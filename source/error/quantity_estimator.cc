// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/error_decay.h>
#include <viscoplastic_contact/error/error_estimator.h>
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/quantity_estimator.h>

namespace Viscoplastic
{
  template <int dim>
  QuantityEstimator<dim>::QuantityEstimator(
    const Discretization<dim> &discretization,
    const SpaceEstimator<dim> &space_estimator,
    const TangentSolver       &solver_of_tangents)
    : discretization(discretization)
    , space_estimator(space_estimator)
    , solver_of_tangents(solver_of_tangents)
    , dual_problem(discretization, *discretization.scene().quantity)
    , boundary_defects(discretization)
  {
    if (is_of_creep(discretization.scene()))
      tangent = std::make_unique<TangentMatrix<dim>>(discretization.laws,
                                                     discretization.matrix,
                                                     /* has_norms = */ false);
  }



  template <int dim>
  bool
  QuantityEstimator<dim>::is_of_creep(const Scene<dim> &scene)
  {
    return scene.has_viscosity() && scene.quantity;
  }



  template <int dim>
  void
  QuantityEstimator<dim>::renew(BulkSolver                &solver,
                                const DistributedMatrix   &matrix,
                                const EvaluatedState<dim> &end,
                                const CoulombLaw          *law,
                                KeptDual                  &kept) const
  {
    if (!dual_problem.renew(solver,
                            matrix,
                            end.state.contact,
                            law,
                            end.errors.quantity.slip_steps,
                            kept.solution))
      return;
    kept.residuals.reset();
    kept.recovered = {};
    kept.strains.clear();
  }



  template <int dim>
  typename QuantityEstimator<dim>::Memory
  QuantityEstimator<dim>::memory() const
  {
    Memory       result{linearized, {}, {}};
    unsigned int i = 0;
    for (const KeptDual *dual : {&dual_of_step, &dual_of_creep})
      {
        if (dual->solution.w.size() > 0)
          {
            result.w[i] = discretization.space.ghosted_vector();
            result.w[i] = dual->solution.w;
          }
        result.truncations[i++] = dual->solution.truncation;
      }
    return result;
  }



  template <int dim>
  void
  QuantityEstimator<dim>::restore(const State<dim> &accepted,
                                  const Memory     &memory)
  {
    linearized = memory.linearized;
    if (linearized)
      {
        const State<dim> &at = tangent->is_constant ? accepted : *linearized;
        tangent->linearize(at.u,
                           at.z,
                           discretization.laws.at(at.t, at.history),
                           linearized->k);
        solver_of_tangents(*tangent, true);
      }
    const auto restored = [&](const unsigned int       i,
                              const DistributedMatrix &matrix) {
      return memory.w[i].size() == 0 ?
               DualSolution<dim>() :
               dual_problem.restore(memory.w[i], memory.truncations[i], matrix);
    };
    dual_of_step  = {restored(0, discretization.matrix), {}, {}, {}};
    dual_of_creep = {};
    if (linearized)
      dual_of_creep.solution = restored(1, tangent->matrix());
  }



  template <int dim>
  std::optional<CoulombLaw>
  QuantityEstimator<dim>::law_of_step(const State<dim> &old,
                                      const State<dim> &state) const
  {
    const Discretization<dim> &d = discretization;
    if (!d.slipping_face() || !d.face->has_computed_pressure() ||
        d.scene().parameters.solver.coulomb_pressure == CoulombPressure::lagged)
      return {};
    CoulombLaw law;
    law.of_pressure = d.face->bounds_of_pressure(
      state.t, d.face->slip_rates(old.velocity, old.t - old.k, old.t));
    return law;
  }



  template <int dim>
  double
  QuantityEstimator<dim>::assess_mesh(const CoulombLaw    *law,
                                      EvaluatedState<dim> &end) const
  {
    const Discretization<dim> &d        = discretization;
    const State<dim>          &state    = end.state;
    const ErrorEstimate       &errors   = end.errors;
    QuantityEstimate          &estimate = end.errors.quantity;
    const QuantityOfInterest  &quantity = *d.scene().quantity;
    const DualSolution<dim>   &dual     = dual_of_step.solution;
    const auto    &triangulation = d.space.dof_handler.get_triangulation();
    Vector<double> sides =
      boundary_defects.missing_sides(state, dual.cartesian);
    const DualSolution<dim> *of_bounds = &dual;
    double                   mesh      = 0.;
    estimate.space_at_least = estimate.unsigned_space = 0.;
    if (dual.norm > 0. || dual_problem.pieces_meet())
      {
        Creep creep{errors.creep_time, 0., 0.};
        if (tangent && end.rate)
          creep = creep_of(state, *end.rate, errors.creep_time);
        if (!dual_of_step.residuals)
          dual_of_step.residuals = space_estimator.residuals_of(dual);
        Vector<double> products = space_estimator.multiply(
          state, end.forces, *dual_of_step.residuals, creep.exponent);
        dual_problem.add_at_meetings(state, products);
        Vector<double> indicators(products);
        const auto     of_products = sum_over_cells(products, triangulation);
        auto           sums        = of_products;
        // Forces relax in creep, but the signs of the rest are unknown.
        if (quantity.is_force() && errors.energy_norm > 0.)
          estimate.space_at_least =
            std::min(1., errors.creep_path / errors.energy_norm) * safety *
            sums[1];
        const double crept  = tangent && end.rate ?
                                end.rate->relaxation_rate * errors.creep_time :
                                0.;
        const bool   creeps = crept > elastic;
        // Residuals lack the pressures that mean dilatation leaves out.
        if (creeps || (d.mean_dilatation && dual.norm > 0.))
          {
            if (creeps)
              {
                indicators = products_of_creep(end, creep, law, sides);
                of_bounds  = &dual_of_creep.solution;
              }
            else
              indicators = space_estimator.multiply_recovered(
                state, dual, nullptr, {1., {}}, dual_of_step.recovered);
            dual_problem.add_at_meetings(state, indicators);
            sums = sum_over_cells(indicators, triangulation);
            if (creeps)
              {
                double least = std::min(1., crept) * least_share * sums[1];
                // What the law takes beyond its tangents is not known well
                // enough to reduce the rest where flow has changed.
                if (const double beyond = dual_of_creep.recovered.in_doubt;
                    beyond != 0.)
                  least =
                    std::max(least,
                             std::abs(sums[0] - beyond) + std::abs(beyond));
                estimate.space_at_least =
                  std::max(estimate.space_at_least, safety * least);
              }
            if (std::abs(of_products[0]) > std::abs(sums[0]))
              {
                indicators = products;
                sums       = of_products;
              }
          }
        for (double &indicator : indicators)
          indicator = safety * std::abs(indicator);
        mesh               = dual_problem.sign() * sums[0];
        estimate.dual_norm = dual.norm;
        estimate.dual_error =
          total_estimate(dual_of_step.residuals->squares, triangulation);
        estimate.unsigned_space = safety * sums[1];
        if (end.space_estimate.squared_indicators.size() > 0)
          end.space_estimate.squared_indicators = std::move(indicators);
      }
    const Vector<double> bounds =
      unresolved_bounds(state, state.contact, *of_bounds, estimate.slip_steps);
    const auto by_bounds = sum_over_cells(bounds, triangulation);
    mesh += dual_problem.sign() * by_bounds[0];
    estimate.unsigned_space += safety * by_bounds[1];
    // The signs of sides may cancel by chance, too.
    const auto [of_sides, size_of_sides] = sum_over_cells(sides, triangulation);
    estimate.of_sides                    = dual_problem.sign() * of_sides;
    estimate.space_at_least =
      std::max(estimate.space_at_least,
               least_share * (size_of_sides + safety * by_bounds[1]));
    estimate.unsigned_space += size_of_sides;
    const Vector<double> held =
      boundary_defects.held_friction(state, quantity, dual.cartesian);
    Vector<double> &indicators = end.space_estimate.squared_indicators;
    if (indicators.size() > 0)
      {
        // Without products, they are still those of the energy norm.
        if (!(dual.norm > 0. || dual_problem.pieces_meet()) &&
            sides.size() + held.size() + bounds.size() > 0)
          indicators = 0.;
        for (const auto &[parts, factor] :
             {std::make_pair(&std::as_const(sides), 1.),
              std::make_pair(&held, 1.),
              std::make_pair(&bounds, safety)})
          for (unsigned int c = 0; c < parts->size(); ++c)
            indicators[c] += factor * std::abs((*parts)[c]);
      }
    const Vector<double> &of_geometry = end.space_estimate.geometry;
    double                geometry    = 0.;
    if (of_geometry.size() > 0) // on all ranks
      {
        geometry = total_estimate(of_geometry, triangulation);
        if (indicators.size() > 0 && geometry > 0.)
          indicators.add(dual.norm / geometry, of_geometry);
      }
    estimate.of_boundary =
      sum_over_cells(held, triangulation)[0] + geometry * estimate.dual_norm;
    return mesh + estimate.of_sides;
  }



  template <int dim>
  void
  QuantityEstimator<dim>::carry_time_error(BulkSolver          &solver,
                                           const CoulombLaw    *law,
                                           const State<dim>    &old,
                                           EvaluatedState<dim> &end) const
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    State<dim>                 &state = end.state;
    DistributedVector           u     = space.owned_vector();
    const auto                  solve = [&](const ContactState       &contact,
                           const IrreversibleStress &error) {
      DistributedVector load = space.owned_vector();
      add_irreversible_load(discretization.stress_space, error, load);
      dual_problem.solve_linearized(solver, contact, law, load, u);
    };
    if (old.carried_error_of_u.size() > 0)
      {
        space.to_frames(old.carried_error_of_u, u);
        // Points that come to rest keep the error of u at their last slip: with
        // the error of z as relaxed since, and the former sets.
        bool rests = false;
        if (discretization.slipping_face())
          for (const unsigned int p :
               discretization.face->layout().friction_points())
            {
              const auto &point = discretization.face->layout().points[p];
              rests |=
                state.contact.holds(point, p) && !old.contact.holds(point, p);
            }
        if (discretization.slipping_face() &&
            discretization.face->layout().any(rests))
          solve(old.contact, old.carried_error);
      }
    solve(state.contact, state.carried_error);
    state.carried_error_of_u = space.ghosted_vector();
    space.to_cartesian(u, state.carried_error_of_u);
    relax_carried_error(discretization.laws, old, end);
  }



  template <int dim>
  double
  QuantityEstimator<dim>::time_error(const State<dim> &state) const
  {
    const Discretization<dim> &d       = discretization;
    const StressSpace<dim>    &space   = d.stress_space;
    const bool                 is_sum  = d.scene().quantity->is_sum();
    const DualSolution<dim>   &dual    = dual_of_step.solution;
    IrreversibleStress        &strains = dual_of_step.strains;
    double                     error   = 0.;
    if (dual.norm > 0.) // on all ranks
      {
        if (strains.empty())
          {
            strains.resize(state.z.size());
            for (std::size_t c = 0; c < space.n_cells(); ++c)
              {
                auto *of_cell = &strains[c * space.n_samples];
                space.strains(c, dual.cartesian.begin(), of_cell);
                for (unsigned int s = 0; s < space.n_samples; ++s)
                  of_cell[s] *= space.weight(c, s);
              }
          }
        for (std::size_t i = 0; i < strains.size(); ++i)
          error -= (is_sum ? state.time_error_at(i) : state.carried_error[i]) *
                   strains[i];
        error = Utilities::MPI::sum(error, d.space.communicator);
      }
    if (!is_sum && d.slipping_face())
      {
        DistributedVector u = d.space.owned_vector();
        d.space.to_frames(state.carried_error_of_u, u);
        const ContactLayout &face = d.face->layout();
        Vector<double> moves = d.face->restriction().gather(u), free = moves;
        dual.truncation.project(face, free);
        double held = 0.;
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          held +=
            face.node_values(dual.force, node) *
            (face.node_values(moves, node) - face.node_values(free, node));
        error += face.sum(held);
      }
    return dual_problem.sign() * error;
  }



  template <int dim>
  void
  QuantityEstimator<dim>::assess(BulkSolver                  &solver,
                                 const SlipDefects           *slip_defects,
                                 const std::optional<double> &growth,
                                 const EvaluatedState<dim>   &accepted,
                                 const FlowRate              *old_rate,
                                 EvaluatedState<dim>         &end) const
  {
    const Discretization<dim> &d        = discretization;
    const State<dim>          &state    = end.state;
    const ErrorEstimate       &errors   = end.errors;
    const QuantityEstimate    &before   = accepted.errors.quantity;
    QuantityEstimate          &estimate = end.errors.quantity;
    const QuantityOfInterest  &quantity = *d.scene().quantity;
    const bool                 is_sum   = quantity.is_sum();
    estimate.value                      = dual_problem.value(state, end.forces);
    const std::optional<CoulombLaw> law = law_of_step(accepted.state, state);
    const CoulombLaw *const         linearized = law ? &*law : nullptr;
    if (is_sum)
      {
        estimate.value += before.value;
        // While nothing slips, the dual solution of the last slip is used.
        estimate.dual_norm  = before.dual_norm;
        estimate.dual_error = before.dual_error;
        settle(solver, linearized, accepted, old_rate, state.contact, estimate);
      }

    const bool carries =
      !is_sum && d.scene().has_viscosity() && state.k > 0.; // collective
    if (carries)
      carry_time_error(solver, linearized, accepted.state, end);
    if (!is_sum && d.slipping_face())
      hold(solver, accepted, state.contact, linearized, end.errors);
    renew(solver, d.matrix, end, linearized, dual_of_step);
    const DualSolution<dim> &dual = dual_of_step.solution;
    // |J| <= a(w, w)^{1/2} a(u, u)^{1/2}; for a force that statics determines w
    // is a rigid motion, and the bound zero. What vanishes by symmetry alone,
    // iterations leave larger than rounding.
    const double largest = dual.norm * errors.energy_norm,
                 parts   = dual_problem.size_of_parts(state, end.forces),
                 least =
                   quantity.is_force() ? std::min(largest, parts) : largest;
    if (!is_sum &&
        std::abs(estimate.value) <
          std::max(rounding * std::max(largest, parts), nothing * least))
      estimate.value = 0.;
    // A state that has hardly changed keeps the estimate of the one before, in
    // proportion.
    double mesh = 0., time = 0.;
    if (growth)
      {
        mesh = *growth * (before.space_correction - before.settled_space);
        estimate.space_at_least = *growth * before.space_at_least;
        estimate.unsigned_space = *growth * before.unsigned_space;
        estimate.of_sides       = *growth * before.of_sides;
        estimate.of_boundary    = *growth * before.of_boundary;
        estimate.dual_norm      = dual.norm;
        estimate.dual_error     = before.dual_error;
      }
    else
      mesh = assess_mesh(linearized, end);
    if (carries || (is_sum && d.scene().has_viscosity()))
      time = time_error(state);
    estimate.space_correction = estimate.settled_space + mesh;
    estimate.time_correction  = estimate.settled_time + time;
    // A cancellation of settled and present errors at one time is not trusted.
    const auto size_with = [&](const double settled, const double now) {
      return std::max(std::abs(settled + now), is_sum ? 0. : std::abs(now));
    };
    const double settled = estimate.settled_space;
    estimate.space =
      std::max({with_safety(settled + mesh, estimate.of_sides),
                is_sum ? 0. : with_safety(mesh, estimate.of_sides),
                estimate.space_at_least}) +
      estimate.of_boundary;
    // A relative change of all forces changes J by the same share, even if the
    // dual solution is zero because all points slip.
    const auto of_swing = [&](const double energy_norm, const double share) {
      return std::max(energy_norm * estimate.dual_norm,
                      share * std::abs(estimate.value));
    };
    estimate.time = size_with(estimate.settled_time, time) +
                    of_swing(errors.swing, errors.swing_share);
    // The bound in the energy norm, and its increment in the step.
    const double bound = errors.friction * estimate.dual_norm,
                 added = (errors.friction - accepted.errors.friction) *
                         estimate.dual_norm;
    estimate.friction           = bound;
    estimate.friction_indicator = added;
    // For the work of friction under computed pressures: turns hardly change
    // the pressures that multiply past slip.
    if ((!is_sum || linearized != nullptr) &&
        !d.scene().has_bounds_of_step_before())
      {
        estimate.turning = before.turning;
        estimate.resting = before.resting;
        if (slip_defects != nullptr && slip_defects->work > 0.)
          add_slip_defects(
            solver, *slip_defects, state.contact, linearized, dual, estimate);
        // The error of a force by displaced points relaxes as stress does.
        const double left =
          quantity.is_force() && errors.remembered_gain == 0. ?
            errors.remembered_share :
            1.;
        estimate.turning *= left;
        estimate.resting *= left;
        estimate.friction =
          std::min(estimate.turning, bound) + estimate.resting;
        estimate.friction_indicator =
          std::min(estimate.turning - left * before.turning, added) +
          estimate.resting - left * before.resting;
      }
    estimate.friction_indicator +=
      of_swing(errors.swing, errors.swing_share) -
      of_swing(accepted.errors.swing, accepted.errors.swing_share);
    // With history at points, the history error stems from refined cells, and
    // its product with that of w is unknown.
    if (!d.scene().keeps_history_at_points())
      estimate.history = errors.history * estimate.dual_error;
    else if (!d.mean_dilatation && tangent && !is_sum &&
             errors.energy_norm > 0.)
      // A locking body is too stiff as a whole, and so is its dual solution.
      estimate.history =
        errors.history / errors.energy_norm * std::abs(estimate.value);
    estimate.transfer  = errors.transfer * estimate.dual_error;
    estimate.algebraic = errors.algebraic * estimate.dual_norm;
    estimate.initial   = errors.initial * estimate.dual_error;
    if (is_sum)
      // These parts have no known signs: their largest values count.
      for (const auto part : {&ErrorParts::space,
                              &ErrorParts::history,
                              &ErrorParts::friction,
                              &ErrorParts::transfer,
                              &ErrorParts::algebraic,
                              &ErrorParts::initial})
        estimate.*part = std::max(before.*part, estimate.*part);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(QuantityEstimator);
} // namespace Viscoplastic
