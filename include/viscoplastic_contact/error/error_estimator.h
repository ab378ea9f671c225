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
  /// The leading order of the defect of a scheme for z' = G, the integral of G
  /// over a step minus its approximation:
  ///
  ///     first k_n (G_n - G_{n-1}) + second k_n^3 G''.
  ///
  /// Schemes of first order have first != 0 and need no second, except for long
  /// steps of backward Euler under nonlinear laws, where the integral of G is
  /// Simpson's. Those of second order have first = 0.
  struct TimeDefect
  {
    double first, second;
  };

  /// Return the defect of a scheme.
  TimeDefect
  time_defect(const TimeScheme scheme);



  /// Estimates the error of each state in the energy norm, by its causes, in
  /// scenes with `Error control/Error bar': the mesh, the time steps, the
  /// iterations, the initial data. It keeps nothing of the run; sums over steps
  /// are stored in the states.
  ///
  /// Time: the error of z_n is the sum of the defects of all steps. Signed, as
  /// tensors at the samples, they add up to D_n, e.g. for forward Euler D_n =
  /// D_{n-1} + (k_n/2)(G_n - G_{n-1}), and cancel if G returns to a value.
  /// Since a(e_u, v) = -(e_z, eps(v)), the norm (int E^-1 D : D)^{1/2} bounds
  /// their effect on u. The relaxation of errors of z is neglected: it does not
  /// occur where loads determine the stress. In linear laws that depend on the
  /// strain, errors of z that make no stress fade nevertheless. For quantities
  /// of interest a second error of z, which relaxes, is carried beside D with
  /// the error of u that it makes (QuantityEstimator::carry_time_error()).
  /// History variables have their own sum of defects; its evolution in a step,
  /// and its effect on G, is the difference of two steps at the same stress.
  ///
  /// Friction: slip that turns in a step has the direction of its end. In an
  /// elastic body under loads linear in each step, the error satisfies a(e, e)
  /// <= sum over the steps of rho |s| - lambda . s, with s the slip of a step
  /// and lambda the multiplier at its beginning. Only the part of this sum due
  /// to turning counts (see turning_work()): the slip of a point that has been
  /// at rest, or keeps its direction, is exact at the end of the step.
  ///
  /// Bounds that follow the pressure or the slip rate of the step before: for
  /// an error Delta rho of the bounds, (a(e, e)/2)' <= sum Delta rho |s'|,
  /// which is summed over the steps.
  ///
  /// Changes of the mesh: the norms of the losses of z are summed. So are the
  /// defects of G at cell means.
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

    /// Return which fields of for_each_sample_field() the scene has.
    static std::array<bool, n_sample_fields>
    has_sample_fields(const Scene<dim> &scene);

    /// Initialize the fields of time errors, and the estimate of a state that
    /// holds projections of the initial data. Returns the squared errors of the
    /// initial data by active cell. Collective.
    Vector<double>
    begin(const StressSpace<dim> &stress_space,
          EvaluatedState<dim>    &initial) const;

    /// Complete the estimate of an initial state that has been brought into
    /// equilibrium.
    void
    assess_equilibrium(EvaluatedState<dim> &initial) const;

    /// Update the mesh-dependent part of the estimate of a state that has been
    /// transferred to a new mesh. @p memory_loss: norm of the loss of z; @p
    /// history: squared error that refined cells leave in z. Collective.
    void
    change_mesh(const AdmissibleSpace<dim> &space,
                const DistributedMatrix    &matrix,
                const double                memory_loss,
                const double                history,
                EvaluatedState<dim>        &accepted) const;

    /// Return the relative tolerance for the iterations of the next step:
    /// `Algebraic fraction' of the estimated discretization error of the
    /// accepted state, or a fixed one if the scene gives it or no estimate
    /// exists.
    double
    tolerance(const ErrorEstimate &accepted) const;

    /// Set the parts of the estimate that do not need the rate at the end of a
    /// step: the size of the solution, its change in the step and the error of
    /// iterations. Forces must be known. Collective.
    void
    assess_change(const StressSpace<dim>    &stress_space,
                  const EvaluatedState<dim> &accepted,
                  EvaluatedState<dim>       &end) const;

    /// Set the fields of time errors at the end of a step, and the other parts
    /// of the estimate except for assess_space(). With viscosity the rates of
    /// both states must be known. @p defect: of the scheme. @p slip_defects, @p
    /// slip_begun: of the step, if any; @p missed_work: by the error of
    /// friction bounds in it (ContactFace::missed_bounds()); @p swing:
    /// swing_of_data() of the step. @p is_fresh: whether data, and so G, may
    /// have a kink at its beginning. Collective.
    void
    assess(const FlowLaws<dim>       &laws,
           const TimeDefect          &defect,
           const SlipDefects         *slip_defects,
           const double               slip_begun,
           const double               missed_work,
           const Swing               &swing,
           const bool                 is_fresh,
           const EvaluatedState<dim> &accepted,
           const FlowRate            *accepted_rate,
           EvaluatedState<dim>       &end) const;

    /// Set the mesh part of the estimate of a step from its space estimate.
    void
    assess_space(const ErrorEstimate &before, EvaluatedState<dim> &end) const;

  private:
    /// Add the defect of a step to the field of time errors, and set the norms
    /// in the estimate. @p has_slope: whether the slope of G before the step
    /// continues in it. @p onset: the factor of the change of slope after the
    /// step before, if slip has begun in that one. Collective.
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
