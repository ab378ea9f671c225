// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_report.h>
#include <viscoplastic_contact/discretization/loads.h>
#include <viscoplastic_contact/error/evaluated_state.h>
#include <viscoplastic_contact/parameters/parameters.h>
#include <viscoplastic_contact/parameters/time_schedule.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace Viscoplastic
{
  /// The data of one step from t_{n-1} to t_n: all that (3.20) needs besides
  /// the form a(.,.) and the irreversible stress z_n. In total form, with Delta
  /// u = u_n - u_{n-1}:
  ///
  ///     a(u_n, v - Delta u) + (z_n, eps(v - Delta u)) + j_n(v) - j_n(Delta u)
  ///       >= L(t_n; v - Delta u)   for all admissible v.
  template <int dim>
  struct StepProblem
  {
    TimeStep time_step;
    /// The load L(t_n, .) in nodal frames.
    Load<dim> load;
    /// rho_c(t_n) of each friction point, which make j_n, and the distance d_c
    /// to each obstacle.
    std::vector<double> bounds;
    /// The increment of the foundation's displacement at each point, see
    /// ContactState::foundation_step; empty if no foundation moves.
    std::vector<Tensor<1, 2>> foundation_step;
    /// The error at which iterations stop, relative to the solution.
    double                  tolerance;
    const SolverParameters &parameters;
    /// The state at t_{n-1}, and G there (null if the step does not need it).
    const EvaluatedState<dim> &old;
    const FlowRate            *old_rate;

    /// Whether u_{n-1} and its multipliers solve (3.20) of this step, too,
    /// unless z changes: loads, prescribed displacements and foundations are
    /// unchanged, no bound is below a multiplier, and the tolerance allows
    /// their error. The same on all ranks.
    bool data_are_unchanged = false;

    /// Whether some friction bounds follow the pressure of this step, and the
    /// part of all bounds that does not depend on it.
    bool                bounds_follow_pressure = false;
    std::vector<double> given_bounds           = {};
    /// Slip rates at t_{n-1}, on which friction bounds depend; empty if none
    /// does.
    std::vector<double> slip_rates = {};

    /// The time for which to extrapolate with the velocity of @p state: this
    /// step, but at most twice the step of that velocity, which may be a jump
    /// in a tiny step.
    double
    time_ahead(const State<dim> &state) const
    {
      return std::min(time_step.k, 2. * state.k);
    }

    /// The energy norm of u_{n-1}, see SolutionScale.
    double
    former_size() const
    {
      return std::sqrt(2. * std::max(0., old.forces.strain_energy));
    }

    /// u_{n-1} in nodal frames.
    const DistributedVector &
    old_u() const
    {
      return old.forces.u;
    }
  };



  /// The report of a step method on a step, besides its end state.
  struct StepOutcome
  {
    ContactReport report;
    /// The stability limit 2/r; infinite without viscosity. Backward Euler,
    /// which may exceed it, reports the limit at the end of the step.
    double step_limit = std::numeric_limits<double>::infinity();
    /// The place where r is largest; the origin where r is zero.
    Point<3> critical_position;
    /// The volume in which stresses are beyond the cap of their law.
    double capped_volume = 0.;
    /// Whether the step is one of backward Euler, and its Newton iterations.
    bool         is_implicit       = false;
    unsigned int newton_iterations = 0;
    /// Whether the state of the step before was taken over without a solve.
    bool is_unchanged = false;

    /// Take stability limit and capped volume from G within the step.
    void
    note(const FlowRate &rate)
    {
      if (rate.relaxation_rate > 0. && 2. / rate.relaxation_rate < step_limit)
        {
          step_limit        = 2. / rate.relaxation_rate;
          critical_position = rate.critical_position;
        }
      capped_volume = std::max(capped_volume, rate.capped_volume);
    }
  };



  /// The solution of a StepProblem by a time scheme.
  template <int dim>
  struct StepSolution : public StepOutcome
  {
    State<dim> state;
    /// irreversible_forces() of the state, if the scheme has computed them.
    DistributedVector irreversible;
    /// G at the end of the step, if the scheme has evaluated it.
    std::optional<FlowRate> end_rate;

    explicit StepSolution(const StepProblem<dim> &problem)
    {
      state.n         = problem.time_step.n;
      state.t         = problem.time_step.t;
      state.k         = problem.time_step.k;
      state.initial_u = problem.old.state.initial_u;
      state.history   = problem.old.state.history;
    }

    /// Set the state to the old one with zero velocity, but keep z.
    void
    stay(const StepProblem<dim>     &problem,
         const AdmissibleSpace<dim> &space,
         const ContactFace<dim>     *face);
  };
} // namespace Viscoplastic
