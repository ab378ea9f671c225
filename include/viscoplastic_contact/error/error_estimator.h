// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_event.h>
#include <viscoplastic_contact/contact/contact_report.h>
#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/error/evaluated_state.h>
#include <viscoplastic_contact/error/swing_of_data.h>
#include <viscoplastic_contact/parameters/choices.h>

namespace Viscoplastic
{
  /// What a scheme for z' = G leaves out of the integral of G over a step, to
  /// leading order:
  ///
  ///     first k_n (G_n - G_{n-1}) + second k_n^3 G''.
  ///
  /// Schemes of first order have first != 0 and need no more, but for long
  /// steps of backward Euler under laws that are not linear, whose integral of
  /// G is Simpson's. Those of second order have first = 0.
  struct TimeDefect
  {
    double first, second;
  };

  /// The defect of a scheme.
  TimeDefect
  time_defect(const TimeScheme scheme);



  /// Estimates the error of each state in the energy norm, by its causes, in
  /// scenes with `Error control/Error bar': the mesh, the time steps, the
  /// iterations, the initial data. It keeps nothing of the run; what has added
  /// up is in the states.
  ///
  /// Time: z_n lacks the sum of the defects of all steps. Signed, as tensors at
  /// the samples, they add up to D_n, e.g. for forward Euler
  /// D_n = D_{n-1} + (k_n/2)(G_n - G_{n-1}), and cancel where G returns. Since
  /// a(e_u, v) = -(e_z, eps(v)), the norm (int E^-1 D : D)^{1/2} bounds their
  /// effect on u. That errors of z relax, too, is left out: where the stress
  /// follows from the loads it does not happen. In linear laws that depend on
  /// the strain, what makes no stress fades all the same. What quantities of
  /// interest feel is carried on beside D, with the error of u that it makes
  /// (QuantityEstimator::carry_time_error()). History variables have such a sum
  /// of their own; what becomes of it in a step, and what it does to G
  /// meanwhile, is the difference of two steps at the same stress.
  ///
  /// Friction: slip that turns in a step has the direction of its end. In an
  /// elastic body the error of what is linear between the steps satisfies
  /// a(e, e) <= sum over the steps of rho |s| - lambda . s, with s the slip of
  /// a step and lambda the multiplier at its beginning. Of this sum only what
  /// comes from turning counts (see turning_work()): the slip of a point that
  /// has been at rest, or keeps its direction, is exact at the end of the step.
  ///
  /// Bounds that follow the pressure or the slip rate of the step before: with
  /// bounds that miss Delta rho, (a(e, e)/2)' <= sum Delta rho |s'|, which adds
  /// up.
  ///
  /// Changes of the mesh: what they take from z adds up. So does what cell
  /// means leave out of G.
  template <int dim>
  class ErrorEstimator
  {
  public:
    /// The factor from the work of slip that turns (SlipDefects::work) to its
    /// error in the energy norm, calibrated once for all scenes.
    static constexpr double friction_calibration = 0.4;

    /// Bounds of the relative tolerance of coupled iterations.
    static constexpr double least_tolerance = 1e-10, largest_tolerance = 1e-5;

    explicit ErrorEstimator(const Scene<dim> &scene);

    /// Which of the sample_fields() of a state the scene has.
    static std::array<bool, 7>
    has_sample_fields(const Scene<dim> &scene);

    /// Set the fields of time errors and the estimate of a state that the
    /// projections of the initial data have made. Returns the squares that
    /// active cells contribute to the error of the initial data. Collective.
    Vector<double>
    begin(const StressSpace<dim> &stress_space,
          EvaluatedState<dim>    &initial) const;

    /// Complete the estimate of an initial state that has been brought into
    /// equilibrium.
    void
    assess_equilibrium(const ContactReport &report,
                       EvaluatedState<dim> &initial) const;

    /// Renew what depends on the mesh in the estimate of a state that has moved
    /// to a new one. @p memory_loss: what z has lost in it; @p history: what
    /// refined cells leave in z, squared. Collective.
    void
    change_mesh(const AdmissibleSpace<dim> &space,
                const DistributedMatrix    &matrix,
                const double                memory_loss,
                const double                history,
                EvaluatedState<dim>        &accepted) const;

    /// The relative tolerance for the iterations of the next step: `Algebraic
    /// fraction' of the estimated discretization error of the accepted state,
    /// or a fixed one if the scene gives it or nothing is known yet.
    double
    tolerance(const ErrorEstimate &accepted) const;

    /// Set the fields of time errors of the end of a step, and the estimate but
    /// for assess_space(). Its forces, and with viscosity the rates of both
    /// states, have been evaluated. @p defect: of the scheme of the step. @p
    /// slip_defects, @p slip_begun: of the step, if any; @p missed_work: that
    /// of friction bounds which it has missed (ContactFace::missed_bounds());
    /// @p swing: the swing_of_data() of the step. @p is_fresh: at its beginning
    /// data have a kink, so that G may have one, too. Collective.
    void
    assess(const FlowLaws<dim>       &laws,
           const TimeDefect          &defect,
           const ContactReport       &report,
           const SlipDefects         *slip_defects,
           const double               slip_begun,
           const double               missed_work,
           const Swing               &swing,
           const bool                 is_fresh,
           const EvaluatedState<dim> &accepted,
           const FlowRate            *accepted_rate,
           EvaluatedState<dim>       &end) const;

    /// Take what is of the mesh in the estimate of the end of a step from its
    /// space estimate.
    void
    assess_space(const ErrorEstimate &before, EvaluatedState<dim> &end) const;

  private:
    /// Add the defect of a step to the field of time errors, and put the norms
    /// into the estimate. @p has_slope: whether the slope of G before the step
    /// goes on in it. @p onset: how many times the bend of G after the step
    /// before counts, in which slip has begun. Collective.
    void
    add_defect(const FlowLaws<dim>       &laws,
               const TimeDefect          &defect,
               const bool                 has_slope,
               const double               onset,
               const EvaluatedState<dim> &accepted,
               const FlowRate            &accepted_rate,
               EvaluatedState<dim>       &end) const;

    const Scene<dim>       &scene;
    const SolverParameters &solver;
    const double            algebraic_fraction;
  };
} // namespace Viscoplastic
