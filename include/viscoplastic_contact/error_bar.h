// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact_solver.h>
#include <viscoplastic_contact/error_ledger.h>
#include <viscoplastic_contact/flow_laws.h>
#include <viscoplastic_contact/force_balance.h>
#include <viscoplastic_contact/state.h>

#include <optional>
#include <string>
#include <utility>

namespace Viscoplastic
{
  /**
   * What a scheme for z' = G leaves out of the integral of G over a step, to
   * leading order:
   *
   *     first k_n (G_n - G_{n-1}) + second k_n^3 G''.
   *
   * Schemes of first order have first != 0 and need no more; those of second
   * order have first = 0.
   */
  struct TimeDefect
  {
    double first, second;
  };

  /// Of a value of `Time/Scheme'.
  TimeDefect
  time_defect(const std::string &scheme);



  /**
   * Keeps the ledger of errors of a run, in scenes with `Error control/Error
   * bar'.
   *
   * Time: z_n lacks the sum of the defects of all steps. Signed, as tensors at
   * the samples, they add up to D_n, e.g. for forward Euler
   * D_n = D_{n-1} + (k_n/2)(G_n - G_{n-1}), and cancel where G returns. Since
   * a(e_u, v) = -(e_z, eps(v)), the norm (int E^-1 D : D)^{1/2} bounds their
   * effect on u. That errors of z relax, too, is left out: where the stress
   * follows from the loads it does not happen.
   */
  template <int dim>
  class ErrorBar
  {
  public:
    /**
     * From residual estimator to error in the energy norm: one number for all
     * scenes. How it was found: doc/method.md, section 12.
     */
    static constexpr double space_calibration = 0.3;

    /// Bounds of the relative tolerance of coupled iterations.
    static constexpr double least_tolerance = 1e-10, largest_tolerance = 1e-5;

    explicit ErrorBar(const Scene<dim> &scene);

    /// How many of the sample_fields() of a state the scene has.
    static unsigned int
    n_sample_fields(const Scene<dim> &scene);

    /// Begin at @p state, which the projections of the initial data have made.
    /// Collective.
    void
    begin(const StressSampling<dim> &sampling, State<dim> &state);

    /// If this has been brought into equilibrium: the ledger at t = 0.
    void
    assess_equilibrium(const Forces<dim>   &forces,
                       const ContactReport &report,
                       const double         residual);

    /// G at the accepted state, for the step from there: evaluated once.
    /// Collective.
    const FlowRate &
    rate(const FlowLaws<dim> &laws, const State<dim> &accepted);

    /// G at the end of a step, for its time error and the next step.
    /// Collective.
    void
    evaluate_rate(const FlowLaws<dim> &laws,
                  const State<dim>    &accepted,
                  const State<dim>    &state);

    /// The accepted state has moved to a new mesh. Collective.
    void
    change_mesh(const AdmissibleSpace<dim> &space,
                const DistributedMatrix    &matrix,
                const State<dim>           &state);

    /**
     * The relative tolerance for the iterations of the next step: `Algebraic
     * fraction' of the estimated discretisation error of the accepted state, or
     * a fixed one if the scene gives it or nothing is known yet.
     */
    double
    tolerance() const;

    /**
     * The ledger of a step from the accepted state to @p state, whose fields
     * of time errors it sets; with viscosity after evaluate_rate(). @p defect
     * is that of the scheme of the step; @p residual the residual estimate of
     * @p state. Collective.
     */
    ErrorLedger
    assess(const StressSampling<dim> &sampling,
           const TimeDefect          &defect,
           const State<dim>          &accepted,
           const Forces<dim>         &old_forces,
           const Forces<dim>         &forces,
           const ContactReport       &report,
           const double               residual,
           State<dim>                &state);

    /// The state of the last assess() is the accepted one now.
    void
    accept(const ErrorLedger &ledger, const double t);

    /// Of the accepted state.
    const ErrorLedger &
    ledger() const
    {
      return present;
    }

    const ErrorSummary &
    summary() const
    {
      return run;
    }

    /// Write to, or read from, an archive what assess() does not make anew.
    template <typename Archive>
    void
    exchange(Archive &archive)
    {
      for (ErrorLedger *ledger : {&present, &run.largest})
        archive & ledger->space & ledger->time & ledger->algebraic &
          ledger->initial & ledger->time_indicator &
          ledger->velocity_variation & ledger->energy_norm &
          ledger->velocity_square;
      archive &run.t &run.largest_energy_norm;
    }

  private:
    /// Add the defect of a step to the field of @p state, and put the norms
    /// into the ledger. Collective.
    void
    add_defect(const StressSampling<dim> &sampling,
               const TimeDefect          &defect,
               const State<dim>          &accepted,
               State<dim>                &state,
               ErrorLedger               &ledger) const;

    const Scene<dim>       &scene;
    const SolverParameters &solver;
    const double            algebraic_fraction;
    ErrorLedger             present;
    ErrorSummary            run;
    /// Of the accepted state and the one that was assessed.
    std::optional<FlowRate> accepted_rate, assessed_rate;
  };
} // namespace Viscoplastic
