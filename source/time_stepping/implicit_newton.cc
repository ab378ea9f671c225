// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/time_stepping/implicit_step.h>
#include <viscoplastic_contact/time_stepping/nonsymmetric_correction.h>

#include <algorithm>
#include <cmath>
#include <limits>

// Newton's method of a step of backward Euler.

namespace Viscoplastic
{
  namespace
  {
    /// sum_s w_s stress_s : eps_s(v) for a ghosted v. Collective.
    template <int dim>
    double
    virtual_work(const StressSpace<dim>   &stress_space,
                 const IrreversibleStress &stress,
                 const DistributedVector  &ghosted_change)
    {
      const unsigned int                 n   = stress_space.n_samples;
      double                             sum = 0.;
      std::vector<SymmetricTensor<2, 3>> strain(n);
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        {
          stress_space.strains(c, ghosted_change.begin(), strain.data());
          for (unsigned int s = 0; s < n; ++s)
            sum += stress_space.weight(c, s) * (stress[c * n + s] * strain[s]);
        }
      return Utilities::MPI::sum(sum, stress_space.space.communicator);
    }



    IrreversibleStress
    difference(const IrreversibleStress &a, const IrreversibleStress &b)
    {
      IrreversibleStress result(a);
      for (std::size_t i = 0; i < a.size(); ++i)
        result[i] -= b[i];
      return result;
    }



    /// An approximate root in (0, 1) of an increasing function with the values
    /// @p f_0 and @p f_1 at the ends, by the Illinois variant of regula falsi.
    /// If the function jumps over zero, the result is near the jump, up to
    /// which the energy decreases. It need not be accurate within Newton's
    /// method.
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



  /// Newton's method of one step.
  template <int dim>
  class ImplicitStep<dim>::Newton
  {
  public:
    Newton(ImplicitStep &method, const StepProblem<dim> &problem);

    StepSolution<dim>
    solve();

  private:
    /// z at the end of the step for the strains of a ghosted displacement, from
    /// a guess of it. Collective.
    IrreversibleStress
    stress(const DistributedVector  &ghosted_u,
           const IrreversibleStress &guess) const;

    /// Take the first tangent at a state extrapolated by the old velocity.
    void
    predict();

    /// Solve for u, sets and multipliers with the present tangent; set z for u.
    void
    solve_with_tangent();

    /// Set the linearization error and the size of the solution, in the norm of
    /// the tangent matrix.
    void
    measure_error();

    void
    give_up() const;

    /// Move the place of the next tangent to the solution, or toward it by the
    /// step length of the line search, which is returned.
    double
    move();

    /// Correct the solution with the tangents that are not symmetric. Returns
    /// the share of the correction that is taken; 0 for none.
    double
    correct();

    /// The step length from base to u: 1 unless the energy of the step
    /// increases on the way.
    double
    step_length() const;

    /// Whether a new tangent costs less than the iterations that the present
    /// one still needs.
    bool
    tangent_is_outdated(const double length, const bool tangent_is_new) const;

    ImplicitStep                        &method;
    const Discretization<dim>           &d;
    const StepProblem<dim>              &problem;
    const typename FlowLaws<dim>::AtTime laws;
    const bool                           tangents_are_symmetric;
    const DistributedVector              zero; // ghosted
    /// z_{n-1}, and what the temperature and a source add to it.
    IrreversibleStress target;

    StepSolution<dim> solution;
    /// The solution in nodal frames.
    DistributedVector u;
    /// The place of the tangent: ghosted u and its z; and u in nodal frames,
    /// empty for the prediction, which need not satisfy the boundary
    /// conditions.
    DistributedVector  at;
    IrreversibleStress z;
    DistributedVector  base;

    /// The tolerance in the energy norm of the present matrix.
    double tolerance = 0.;
    double error = 0., size = 0.,
           last_error = std::numeric_limits<double>::infinity(),
           best_error = std::numeric_limits<double>::infinity();
  };



  template <int dim>
  ImplicitStep<dim>::Newton::Newton(ImplicitStep           &method,
                                    const StepProblem<dim> &problem)
    : method(method)
    , d(method.discretization)
    , problem(problem)
    , laws(d.laws.at(problem.time_step.t, problem.old.state.history))
    , tangents_are_symmetric(
        method.tangent.is_constant ||
        have_symmetric_tangents(d.laws, problem.time_step.t))
    , zero(d.space.ghosted_vector())
    , target(problem.old.state.z)
    , solution(problem)
  {
    if (d.laws.thermal)
      d.laws.thermal->follow(problem.old.state.t, problem.time_step.t, target);
    if (d.laws.source_solution)
      fail_together(d.space.communicator, [&] {
        const unsigned int n = d.stress_space.n_samples;
        for (std::size_t i = 0; i < target.size(); ++i)
          target[i] +=
            problem.time_step.k *
            d.laws.source(laws, i / n, i % n, ExactSolution<dim>::Side::before);
      });
  }



  template <int dim>
  StepSolution<dim>
  ImplicitStep<dim>::Newton::solve()
  {
    const TimeStep    &step           = problem.time_step;
    const unsigned int max_iterations = problem.parameters.maximal_iterations;
    predict();
    bool is_outdated = true;
    for (solution.newton_iterations = 1;; ++solution.newton_iterations)
      {
        if (is_outdated)
          method.linearize(at, z, laws, step.k);
        const bool tangent_is_new = is_outdated;
        solve_with_tangent();
        measure_error();
        if (error <= tolerance * size)
          break;
        best_error = std::min(best_error, error / size);
        if (solution.newton_iterations == max_iterations)
          give_up();
        const double length = move();
        is_outdated         = tangent_is_outdated(length, tangent_is_new);
        last_error          = error;
      }

    const double ratio = method.tangent.norm_ratio();
    if (size > 0.)
      solution.report.relative_error += error / size;
    solution.report.error     = ratio * (solution.report.error + error);
    solution.report.tolerance = 2. * tolerance;

    TimerOutput::Scope phase(method.timer, "rate");
    advance_history<dim>(laws, d.stress_space, step.k, solution.state);
    solution.end_rate = evaluate_flow(d.laws, solution.state, step.t);
    solution.note(*solution.end_rate);
    return std::move(solution);
  }



  template <int dim>
  IrreversibleStress
  ImplicitStep<dim>::Newton::stress(const DistributedVector  &ghosted_u,
                                    const IrreversibleStress &guess) const
  {
    TimerOutput::Scope phase(method.timer, "rate");
    return implicit_irreversible_stress<dim>(
      laws, d.stress_space, ghosted_u, target, problem.time_step.k, guess);
  }



  template <int dim>
  void
  ImplicitStep<dim>::Newton::predict()
  {
    const State<dim> &old = problem.old.state;
    u = method.solver.initial_guess(problem, old, solution.state.contact);
    DistributedVector ahead(problem.old_u());
    d.space.to_frames(old.velocity, ahead);
    ahead.sadd(problem.time_ahead(old), 1., problem.old_u());
    at = zero;
    d.space.to_cartesian(ahead, at);
    z = stress(at, target);
  }



  template <int dim>
  void
  ImplicitStep<dim>::Newton::solve_with_tangent()
  {
    // The tolerance is for the energy norm of a(.,.), which may be norm_ratio()
    // times that of the tangent; rounding allows no less than 1e-10. Half of it
    // is for friction, half for z.
    tolerance = 0.5 * std::max(problem.tolerance / method.tangent.norm_ratio(),
                               std::min(problem.tolerance, 1e-10));
    {
      TimerOutput::Scope phase(method.timer, "contact");
      DistributedVector  right_side(problem.load.values);
      add_irreversible_load(d.stress_space,
                            method.tangent.extrapolate(z, at, zero),
                            right_side);
      ContactReport report = method.solver.solve(
        problem, right_side, tolerance, u, solution.state.contact);
      report.add_earlier(solution.report);
      solution.report = report;
      method.solver.set_displacement(problem, u, solution.state);
    }
    solution.state.z = stress(solution.state.u, z);
  }



  template <int dim>
  void
  ImplicitStep<dim>::Newton::measure_error()
  {
    const TangentMatrix<dim> &tangent = method.tangent;
    const State<dim>         &state   = solution.state;
    error =
      tangent.norm(difference(state.z, tangent.extrapolate(z, at, state.u)));
    if (!std::isfinite(error))
      refuse("Newton's method met a value that is not finite.");
    DistributedVector product(u);
    tangent.matrix().vmult(product, u);
    // Rounding of stresses does not vanish with u.
    const double rounding =
      std::max(solution.report.rounding_error, 1e-13 * tangent.norm(state.z));
    size = std::max(std::sqrt(std::max(0., u * product)), rounding / tolerance);
  }



  template <int dim>
  void
  ImplicitStep<dim>::Newton::give_up() const
  {
    refuse("Newton's method for backward Euler did not converge in " +
           as_text(solution.newton_iterations) +
           " iterations: the relative error is " + as_text(best_error) +
           " at best, and the tolerance is " + as_text(tolerance) +
           " ('Solver/Contact tolerance'); take more steps in 'Time/Phases'.");
  }



  template <int dim>
  double
  ImplicitStep<dim>::Newton::move()
  {
    if (!tangents_are_symmetric)
      if (const double share = correct(); share > 0.)
        return share;
    const double length = base.size() > 0 ? step_length() : 1.;
    if (length == 1.)
      {
        base = u;
        at   = solution.state.u;
        z    = solution.state.z;
      }
    else
      {
        base.sadd(1. - length, length, u);
        d.space.to_cartesian(base, at);
        z = stress(at, z);
      }
    return length;
  }



  template <int dim>
  double
  ImplicitStep<dim>::Newton::correct()
  {
    State<dim>        &state = solution.state;
    NewtonIterate<dim> iterate{u, state.u, state.z, state.contact};
    const NonsymmetricCorrection<dim> newton(d, problem, method.solver.bulk());
    const auto                        correction = newton.correct(
      std::max(0.1 * tolerance * size / error, std::min(1e-2, error / size)),
      [this](const DistributedVector  &ghosted_u,
             const IrreversibleStress &guess) {
        return stress(ghosted_u, guess);
      },
      iterate);
    solution.report.linear_iterations += correction.iterations;
    if (correction.share > 0.)
      {
        u = base      = iterate.u;
        at            = iterate.ghosted_u;
        z             = iterate.z;
        state.contact = iterate.contact;
      }
    return correction.share;
  }



  template <int dim>
  double
  ImplicitStep<dim>::Newton::step_length() const
  {
    // J' d at base + s d: linear in s but for friction and z.
    DistributedVector change(u), product(u);
    change -= base;
    d.matrix.vmult(product, change);
    const double curvature = change * product;
    d.matrix.vmult(product, base);
    product -= problem.load.values;
    const double slope = change * product;

    DistributedVector ghosted_change = d.space.ghosted_vector();
    d.space.to_cartesian(change, ghosted_change);
    const std::vector<double> &bounds = solution.state.contact.bound;
    std::vector<Tensor<1, 2>>  slips, slip_changes;
    if (d.face)
      {
        DistributedVector increment(base);
        increment -= problem.old_u();
        slips        = d.face->slips(increment, problem.foundation_step);
        slip_changes = d.face->slips(change);
      }
    const auto derivative = [&](const double              s,
                                const IrreversibleStress &z_there) {
      double     contact = 0.;
      const auto at      = [&](const unsigned int p) {
        return slips[p] + s * slip_changes[p];
      };
      for (unsigned int n = 0; d.face && n < d.face->layout().n_nodes(); ++n)
        {
          const ContactLayout &layout = d.face->layout();
          for (const unsigned int p : layout.friction_points(n))
            if (const double rest = slip_changes[p].norm();
                rest > 0. && std::isfinite(bounds[p]))
              contact +=
                bounds[p] * (at(p).norm() > 1e-14 * rest ?
                               (at(p) * slip_changes[p]) / at(p).norm() :
                               (s < 0.5 ? rest : -rest));
          for (const unsigned int o : layout.compliant(layout.obstacles(n)))
            contact += layout.points[o].compliance.force(at(o)[0] - bounds[o]) *
                       slip_changes[o][0];
        }
      return slope + s * curvature +
             Utilities::MPI::sum(contact, d.space.communicator) +
             virtual_work(d.stress_space, z_there, ghosted_change);
    };

    const double at_0 = derivative(0., z),
                 at_1 = derivative(1., solution.state.z);
    if (!(at_0 < 0.) || at_1 <= 0.5 * std::fabs(at_0))
      return 1.;
    DistributedVector  there = d.space.ghosted_vector();
    IrreversibleStress z_there(z);
    return find_root(
      [&](const double s) {
        DistributedVector between(base);
        between.add(s, change);
        d.space.to_cartesian(between, there);
        z_there = stress(there, z_there);
        return derivative(s, z_there);
      },
      at_0,
      at_1);
  }



  template <int dim>
  bool
  ImplicitStep<dim>::Newton::tangent_is_outdated(
    const double length,
    const bool   tangent_is_new) const
  {
    const double iterations_left =
      error < last_error ?
        std::log(tolerance * size / error) / std::log(error / last_error) :
        std::numeric_limits<double>::infinity();
    // The price of a new tangent, in iterations with the present one: low for a
    // preconditioner, high for factors.
    const bool   is_iterative = !method.solver.bulk().is_exact();
    const double price        = is_iterative ? 1. : dim == 2 ? 5. : 12.;
    if (length < 1.)
      return true;
    // One iteration does not show the rate of convergence.
    if (tangent_is_new && solution.newton_iterations == 1)
      return is_iterative;
    return iterations_left > price;
  }



  template <int dim>
  StepSolution<dim>
  ImplicitStep<dim>::advance(const StepProblem<dim> &problem)
  {
    if (auto solution = rest(problem))
      return std::move(*solution);
    StepSolution<dim> solution = Newton(*this, problem).solve();
    solution.is_implicit       = true;
    return solution;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(ImplicitStep, advance);
} // namespace Viscoplastic
