// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/timer.h>

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/base/progress.h>
#include <viscoplastic_contact/discretization/point_probe.h>
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/error/solution_errors.h>
#include <viscoplastic_contact/results/acting_effects.h>
#include <viscoplastic_contact/results/energy_balance.h>
#include <viscoplastic_contact/results/field_probes.h>
#include <viscoplastic_contact/results/run_summary.h>
#include <viscoplastic_contact/results/statistics.h>
#include <viscoplastic_contact/results/step_quantities.h>

#include <boost/serialization/set.hpp>
#include <boost/serialization/vector.hpp>

#include <memory>

namespace Viscoplastic
{
  /// Keeps the record of a run: evaluates each step, warns of doubtful results,
  /// writes the row of statistics.csv, shows the progress, and summarizes the
  /// run at its end.
  template <int dim>
  class Recorder
  {
  public:
    /// Keeps references to all arguments. @p timer has the seconds by phase, @p
    /// budget is null unless the run has a tolerance.
    Recorder(const Scene<dim>  &scene,
             const StepControl &control,
             Console           &console,
             TimerOutput       &timer,
             const ErrorBudget *budget);

    /// Set the present mesh. Keeps a reference. Collective.
    void
    set_mesh(const Discretization<dim> &discretization);

    /// Stop the clock: the next record gets the present times.
    void
    stop_clock()
    {
      stopped_clock.reset(); // since elapsed() depends on it
      stopped_clock.emplace(
        timer.get_summary_data(TimerOutput::total_wall_time), elapsed());
    }

    /// Write the rows to a table from here on; on rank 0. Without a table they
    /// are not written.
    void
    write_to(std::unique_ptr<TableFile> table)
    {
      statistics = std::move(table);
    }

    /// Flush all rows to disk. On rank 0.
    void
    synchronize()
    {
      statistics->synchronize();
    }

    /// Record a step from @p old; step 0 is the initial state. @p errors: those
    /// against a known solution. Collective.
    void
    record(const EvaluatedState<dim> &old,
           const AcceptedStep<dim>   &step,
           const SolutionErrors      &errors);

    /// Record the initial state, before or after the first step from it.
    /// Collective.
    void
    record_initial_state(TimeStepper<dim>     &time_stepper,
                         const SolutionErrors &errors,
                         EvaluatedState<dim>  &accepted);

    /// Whether a state has been recorded in this process.
    bool
    has_begun() const
    {
      return !run.at_end.empty();
    }

    /// Add a change of mesh or stage between two steps to the energy balance,
    /// see EnergyBalance::add_change().
    void
    record_change(const EnergiesOnMesh &before,
                  const EnergiesOnMesh &after,
                  double EnergyBalance::*beyond)
    {
      balance.add_change(before, after, balance.*beyond);
    }

    /// Continue from a state that earlier parts of the run have reached in @p
    /// seconds.
    void
    resume(const State<dim> &state, const double seconds);

    /// Count the time of an earlier pass as that of a pilot run.
    void
    count_pilot_run(const Recorder<dim> &earlier)
    {
      pilot_seconds   = earlier.elapsed();
      earlier_seconds = earlier.earlier_seconds;
    }

    /// Throws ExcMessage if the largest displacement, force or stress of the
    /// run is so large, or at its end so small, that its square, as in
    /// energies, overflows or underflows.
    void
    check_sizes(const bool at_end) const;

    /// Return remarks that qualify the results of the run, one sentence each.
    /// @p state: at the end of the run. Collective.
    std::vector<std::string>
    remarks(const State<dim> &state) const;

    /// Print the summary of the run without remarks. On all ranks.
    void
    print(std::ostream &out) const;

    const RunSummary<dim> &
    summary() const
    {
      return run;
    }

    /// The largest size of the solution up to now, see ErrorBudget::size().
    double
    size_so_far() const
    {
      return run.controlled_errors().size;
    }

    /// The wall time spent on effects of the scene so far.
    RunBill
    bill() const;

    /// Wall time of this process.
    double
    elapsed() const
    {
      return stopped_clock ? stopped_clock->second :
                             pilot_seconds + clock.wall_time();
    }

    /// Wall time of the whole run, including parts before restarts.
    double
    elapsed_in_all() const
    {
      return earlier_seconds + elapsed();
    }

    /// The estimated error so far for the progress: relative to the energy norm
    /// or, in runs to a tolerance, to the size of the solution. Absent without
    /// an estimate.
    std::optional<double>
    relative_error(const ErrorEstimate &errors) const;

    /// Write or read the data that accumulate over the run.
    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int);

  private:
    /// Return why, and by how much, the tolerance of the run has been missed.
    std::string
    remark_on_tolerance() const;

    /// Warn once of each cause of doubt; throws StepFailure for lost digits.
    void
    judge(const AcceptedStep<dim> &step, const StepQuantities<dim> &quantities);

    void
    sum_up(const AcceptedStep<dim>   &step,
           const StepQuantities<dim> &quantities,
           const SolutionErrors      &errors);

    /// Make the row of statistics.csv of a step. Names and units of quantities,
    /// and when a scene has them, are defined only here.
    TableRow
    row(const AcceptedStep<dim>   &step,
        const StepQuantities<dim> &quantities,
        const SolutionErrors      &errors);

    /// Add the requested values at points and integrals.
    void
    add_asked_for(const StepQuantities<dim> &quantities, TableRow &row) const;

    void
    add_seconds(TableRow &row);

    /// The part of the run that has been made after step n, which ends at t.
    double
    done(const unsigned int n, const double t) const;

    void
    report_progress(const AcceptedStep<dim>   &step,
                    const StepQuantities<dim> &quantities);

    /// Whether steps of this scene may be backward Euler steps.
    bool
    may_be_implicit() const
    {
      return scene.is_implicit() || scene.is_implicit_beyond_the_limit();
    }

    /// The norm of the sum of loads, reactions and friction, which should be
    /// zero, relative to the largest force so far or to a larger scale.
    double
    balance_defect(const StepQuantities<dim> &quantities) const
    {
      const double scale = std::max(largest_force, quantities.force_scale);
      return scale > 0. ? stable_norm(quantities.sum_of_forces) / scale : 0.;
    }

    const Scene<dim>  &scene;
    const StepControl &control;
    Console           &console;
    TimerOutput       &timer;
    const ErrorBudget *budget;
    const bool         has_error_estimate;

    const Discretization<dim>   *discretization = nullptr; // the present one
    std::vector<PointProbe<dim>> probes;
    /// Null unless requested.
    std::unique_ptr<FieldProbes<dim>>    point_fields;
    std::unique_ptr<FieldIntegrals<dim>> integrals;
    /// Sums since t = 0 of those integrals that are summed over the steps.
    std::vector<double> dissipated;

    EnergyBalance balance;
    /// The largest load, reaction or friction force so far: the scale of
    /// balance defects, also in steps in which all forces vanish.
    double       largest_force      = 0.;
    unsigned int contact_iterations = 0, linear_iterations = 0,
                 newton_iterations = 0, implicit_steps = 0;
    RunSummary<dim>    run;
    ActingEffects<dim> effects;
    /// Subjects of warnings about steps, each of which is printed once.
    std::set<std::string> told;

    std::unique_ptr<TableFile> statistics;
    Progress                   progress;
    /// Wall time by phase at the last record, and, for a record that comes
    /// later, at stop_clock(), with the total.
    std::map<std::string, double> last_seconds;
    std::optional<std::pair<std::map<std::string, double>, double>>
      stopped_clock;
    /// Seconds of the solves of this process, and what they would have taken
    /// without friction; see ContactReport.
    double solve_seconds = 0., plain_solve_seconds = 0.;
    /// Seconds of the run before its last restart, and of its pilot run.
    double earlier_seconds = 0., pilot_seconds = 0.;
    Timer  clock;
  };



  template <int dim>
  template <typename Archive>
  void
  Recorder<dim>::serialize(Archive &archive, const unsigned int)
  {
    archive &balance &largest_force &contact_iterations &linear_iterations
      &newton_iterations &implicit_steps &dissipated &effects;
    archive &run.unchanged_steps &run.first_touch &run.first_slip &run
      .friction_area &run.missed_bounds &run.computed_bounds;
    for (Largest<dim> *largest : {&run.displacement,
                                  &run.strain,
                                  &run.von_mises,
                                  &run.pressure,
                                  &run.slip_area,
                                  &run.slip_rate,
                                  &run.capped_volume,
                                  &run.tension_share,
                                  &run.slide,
                                  &run.utilization,
                                  &run.stiffness})
      archive & largest->value & largest->t;
    archive &run.stiffness.position &run.displacement.position &run.von_mises
      .position;
    for (SolutionNorms *norms : {&run.largest_error, &run.largest_exact})
      archive & norms->energy & norms->h1 & norms->stress & norms->multiplier;
    if (run.errors)
      archive &*run.errors &run.quantity_errors &run.has_coarse_curves;
    archive &run.doubtful_steps;
  }
} // namespace Viscoplastic
