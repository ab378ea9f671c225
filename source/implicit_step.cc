// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/backward_euler.h>
#include <viscoplastic_contact/messages.h>
#include <viscoplastic_contact/nonsymmetric_correction.h>
#include <viscoplastic_contact/viscoplastic_contact.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// sum_s w_s stress : eps_s(change).
    template <int dim>
    double
    virtual_work(const StressSampling<dim> &sampling,
                 const IrreversibleStress  &stress,
                 const DistributedVector   &ghosted_change)
    {
      const unsigned int                 n   = sampling.n_samples;
      double                             sum = 0.;
      std::vector<SymmetricTensor<2, 3>> strain(n);
      for (std::size_t c = 0; c < sampling.n_cells(); ++c)
        {
          sampling.strains(c, ghosted_change.begin(), strain.data());
          for (unsigned int s = 0; s < n; ++s)
            sum += sampling.weight(c, s) * (stress[c * n + s] * strain[s]);
        }
      return Utilities::MPI::sum(sum, sampling.space.communicator);
    }



    IrreversibleStress
    difference(const IrreversibleStress &a, const IrreversibleStress &b)
    {
      IrreversibleStress result(a);
      for (std::size_t i = 0; i < a.size(); ++i)
        result[i] -= b[i];
      return result;
    }



    /// Where an increasing function is near zero in (0, 1), given its values at
    /// the ends, by regula falsi in the manner of Illinois.
    template <typename Function>
    double
    find_root(const Function &f, const double f_0, const double f_1)
    {
      double left = 0., right = 1., f_left = f_0, f_right = f_1, s = 1.;
      int    side = 0;
      for (unsigned int i = 0; i < 20; ++i)
        {
          s = (left * f_right - right * f_left) / (f_right - f_left);
          const double value = f(s);
          if (std::fabs(value) <= 0.2 * std::fabs(f_0))
            break;
          if (value < 0.)
            {
              left   = s;
              f_left = value;
              if (side == -1)
                f_right *= 0.5;
              side = -1;
            }
          else
            {
              right   = s;
              f_right = value;
              if (side == 1)
                f_left *= 0.5;
              side = 1;
            }
        }
      return s;
    }
  } // namespace



  template <int dim>
  void
  ViscoplasticContact<dim>::linearise(const DistributedVector  &ghosted_u,
                                      const IrreversibleStress &z,
                                      const double              t,
                                      const double              k)
  {
    TimerOutput::Scope  phase(timer, "tangent");
    Discretisation     &d      = *discretisation;
    TangentMatrix<dim> &matrix = *d.tangent;
    const bool          is_new = matrix.linearise(ghosted_u, z, t, k);
    // A preconditioner that has seen other solves is not a function of what
    // is given; only that of constant tangents goes from step to step, where
    // no steps of other schemes are between.
    const bool stays = matrix.is_constant && !changes_scheme();
    if (is_new || !d.solver || !(stays || d.solver->is_exact()))
      {
        d.make_solver(matrix.matrix(), matrix.max_poissons_ratio());
        announce_solver();
      }
  }



  /*
   * Newton's method for the bulk around the contact solver. In each iteration,
   * z(eps) is replaced by its tangent at the last strain, or by one from before
   * if that does as well, and friction is solved with that matrix:
   *
   *     a(u, v) + (z_m + C (eps(u) - eps(u_m)), eps(v)) + friction = L(v).
   *
   * With a potential this is one convex minimisation, J(u) -> min, and a step
   * along d = u - u_m is shortened where J' d = 0 if the whole one overshoots,
   * which J' tells without J; then J decreases always. Without one, the same
   * rule looks for a zero of the residual along d.
   *
   * The iteration ends when (u, z(eps(u))) satisfies the equations to the
   * contact tolerance: what the tangent has missed, dz, is a residual whose
   * dual norm is at most that of dz.
   */
  template <int dim>
  void
  ViscoplasticContact<dim>::advance_implicitly(const State<dim>  &old_state,
                                               const Forces<dim> &old_forces,
                                               const Load<dim>   &load,
                                               const TimeStep    &time_step,
                                               Step              &step)
  {
    Discretisation             &d        = *discretisation;
    const AdmissibleSpace<dim> &space    = d.space;
    const StressSampling<dim>  &sampling = d.sampling;
    const double                k        = time_step.k;
    if (!d.tangent)
      d.tangent = std::make_unique<TangentMatrix<dim>>(d.laws, d.matrix);
    const auto  laws  = d.laws.at(time_step.t);
    State<dim> &state = step.state;
    // A source is known.
    IrreversibleStress target = old_state.z;
    if (d.laws.source_solution)
      fail_together(space.communicator, [&] {
        for (std::size_t i = 0; i < target.size(); ++i)
          target[i] += k * d.laws.source(laws,
                                         i / sampling.n_samples,
                                         i % sampling.n_samples,
                                         ExactSolution<dim>::Side::before);
      });
    const bool is_symmetric =
      d.tangent->is_constant || have_symmetric_tangents(d.laws, time_step.t);
    const auto z_for = [&](const DistributedVector  &ghosted_u,
                           const IrreversibleStress &guess) {
      TimerOutput::Scope phase(timer, "rate");
      return implicit_irreversible_stress<dim>(
        laws, sampling, ghosted_u, target, k, guess);
    };

    DistributedVector u =
      start(old_state, old_forces, step.foundation_step, state);

    // The first tangent is that of a body that goes on as it did. No start of
    // a line search: it need not satisfy the boundary conditions.
    const DistributedVector zero = space.ghosted_vector();
    DistributedVector       at   = space.ghosted_vector(), ahead(old_forces.u);
    space.to_frames(old_state.velocity, ahead);
    ahead.sadd(std::min(k, old_state.k), 1., old_forces.u);
    space.to_cartesian(ahead, at);
    IrreversibleStress z           = z_for(at, old_state.z);
    bool               is_outdated = true;
    double             last_error  = std::numeric_limits<double>::infinity(),
           best_error              = last_error;
    DistributedVector base; // u at which the tangent is, in frames
    for (step.newton_iterations = 1;; ++step.newton_iterations)
      {
        if (is_outdated)
          linearise(at, z, time_step.t, k);
        const bool tangent_is_new = is_outdated;
        is_outdated               = false;
        // In the energy norm of a(.,.), which may be as much larger; but not
        // beyond what rounding allows. Half of it for friction, half for z.
        const double ratio = d.tangent->norm_ratio();
        const double tolerance =
          0.5 *
          std::max(step_tolerance() / ratio, std::min(step_tolerance(), 1e-10));
        {
          TimerOutput::Scope phase(timer, "contact");
          DistributedVector  right_side(load.values);
          add_irreversible_load(sampling,
                                d.tangent->extrapolate(z, at, zero),
                                right_side);
          const unsigned int iterations        = step.report.iterations,
                             linear_iterations = step.report.linear_iterations;
          step.report                          = solve_from(old_forces,
                                   load,
                                   right_side,
                                   step.bounds,
                                   step.foundation_step,
                                   tolerance,
                                   u,
                                   state.friction);
          step.report.iterations += iterations;
          step.report.linear_iterations += linear_iterations;
          set_displacement(u, old_forces, state);
        }
        state.z = z_for(state.u, z);

        // What the tangent has missed.
        const double error = d.tangent->norm(
          difference(state.z, d.tangent->extrapolate(z, at, state.u)));
        AssertThrow(std::isfinite(error),
                    ExcMessage("Newton's method met a value that is not "
                               "finite."));
        DistributedVector product(u);
        d.tangent->matrix().vmult(product, u);
        // Rounding of stresses does not vanish with u.
        const double rounding = std::max(d.solver->rounding_error(),
                                         1e-13 * d.tangent->norm(state.z));
        const double size =
          std::max(std::sqrt(std::max(0., u * product)), rounding / tolerance);
        if (error <= tolerance * size)
          {
            if (size > 0.)
              step.report.relative_error += error / size;
            step.report.error     = ratio * (step.report.error + error);
            step.report.tolerance = 2. * tolerance;
            break;
          }
        best_error = std::min(best_error, error / size);
        if (step.newton_iterations == parameters.solver.maximal_iterations)
          {
            std::ostringstream message;
            message << "Newton's method for backward Euler did not converge in "
                    << step.newton_iterations
                    << " iterations: the relative error is " << best_error
                    << " at best, and the tolerance is " << tolerance
                    << " ('Solver/Contact tolerance'); take more steps in "
                       "'Time/Phases'.";
            AssertThrow(false, ExcMessage(message.str()));
          }

        // What the matrix misses of the tangents may be all that matters.
        double length = 0.;
        if (!is_symmetric)
          {
            NewtonIterate<dim> iterate{u, state.u, state.z, state.friction};
            const auto         correction =
              NonsymmetricCorrection<dim>(d.laws,
                                          d.matrix,
                                          *d.solver,
                                          d.slipping_face(),
                                          load.values,
                                          old_forces.u,
                                          step.bounds,
                                          step.foundation_step)
                .correct(time_step.t,
                         k,
                         std::max(0.1 * tolerance * size / error,
                                  std::min(1e-2, error / size)),
                         z_for,
                         iterate);
            step.report.linear_iterations += correction.iterations;
            length = correction.share;
            if (length > 0.)
              {
                u = base       = iterate.u;
                at             = iterate.ghosted_u;
                z              = iterate.z;
                state.friction = iterate.friction;
              }
          }
        // Else go there, or as far as J decreases.
        if (length == 0.)
          {
            length = 1.;
            if (base.size() > 0)
              length = step_length(old_forces, load, step, base, z, u, z_for);
            if (length == 1.)
              {
                base = u;
                at   = state.u;
                z    = state.z;
              }
            else
              {
                base.sadd(1. - length, length, u);
                space.to_cartesian(base, at);
                z = z_for(at, z);
              }
          }

        // A tangent serves while the iterations left cost less than a new one.
        const double left =
          error < last_error ?
            std::log(tolerance * size / error) / std::log(error / last_error) :
            std::numeric_limits<double>::infinity();
        const double price = !d.solver->is_exact() ? 1. : dim == 2 ? 5. : 12.;
        is_outdated =
          length < 1. ||
          (tangent_is_new && step.newton_iterations == 1 ? price == 1. :
                                                           left > price);
        last_error = error;
      }

    TimerOutput::Scope phase(timer, "rate");
    const FlowRate end = evaluate_flow(d.laws, state.u, state.z, time_step.t);
    step.capped_volume = end.capped_volume;
    if (end.relaxation_rate > 0.)
      {
        step.step_limit        = 2. / end.relaxation_rate;
        step.critical_position = end.critical_position;
      }
  }



  template <int dim>
  double
  ViscoplasticContact<dim>::step_length(const Forces<dim>        &old_forces,
                                        const Load<dim>          &load,
                                        const Step               &step,
                                        const DistributedVector  &base,
                                        const IrreversibleStress &z,
                                        const DistributedVector  &u,
                                        const StressForStrain    &z_for) const
  {
    const Discretisation       &d     = *discretisation;
    const AdmissibleSpace<dim> &space = d.space;
    // J' d at base + s d: linear in s but for friction and z.
    DistributedVector change(u), product(u);
    change -= base;
    d.matrix.vmult(product, change);
    const double curvature = change * product;
    d.matrix.vmult(product, base);
    product -= load.values;
    const double slope = change * product;

    DistributedVector ghosted_change = space.ghosted_vector();
    space.to_cartesian(change, ghosted_change);
    std::vector<Tensor<1, 2>> slips, slip_changes;
    if (d.face)
      {
        DistributedVector increment(base);
        increment -= old_forces.u;
        slips        = d.face->slips(increment, step.foundation_step);
        slip_changes = d.face->slips(change, {});
      }
    const auto derivative = [&](const double              s,
                                const IrreversibleStress &z_there) {
      double friction = 0.;
      for (unsigned int p = 0; p < slips.size(); ++p)
        {
          const Tensor<1, 2> slip = slips[p] + s * slip_changes[p];
          const double       norm = slip.norm(), rest = slip_changes[p].norm();
          if (rest > 0. && std::isfinite(step.bounds[p]))
            friction += step.bounds[p] * (norm > 1e-14 * rest ?
                                            (slip * slip_changes[p]) / norm :
                                            (s < 0.5 ? rest : -rest));
        }
      return slope + s * curvature + friction +
             virtual_work(d.sampling, z_there, ghosted_change);
    };

    const double at_0 = derivative(0., z), at_1 = derivative(1., step.state.z);
    if (!(at_0 < 0.) || at_1 <= 0.5 * std::fabs(at_0))
      return 1.;
    DistributedVector  there = space.ghosted_vector();
    IrreversibleStress z_there(z);
    return find_root(
      [&](const double s) {
        DistributedVector between(base);
        between.add(s, change);
        space.to_cartesian(between, there);
        z_there = z_for(there, z_there);
        return derivative(s, z_there);
      },
      at_0,
      at_1);
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
