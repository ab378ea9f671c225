// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/parameters/parameters.h>
#include <viscoplastic_contact/parameters/time_schedule.h>

#include <algorithm>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace Viscoplastic
{
  class ErrorBudget;
  class Parameters;

  /// A step could not be made; a shorter one may succeed.
  struct StepFailure : public std::runtime_error
  {
    /// Step @p n to time @p t, and why as a sentence.
    StepFailure(const unsigned int n, const double t, const std::string &why);
  };


  /// A step beyond the stability limit of its scheme.
  struct StepBeyondStability : public StepFailure
  {
    using StepFailure::StepFailure;
  };


  /// Return the result of @p work, and turn its exceptions into the failure of
  /// step @p n to time @p t, except std::bad_alloc.
  template <typename Work>
  auto
  as_part_of_step(const unsigned int n, const double t, const Work &work)
  {
    try
      {
        return work();
      }
    catch (const std::bad_alloc &)
      {
        throw;
      }
    catch (const StepFailure &)
      {
        throw; // which names the step
      }
    catch (...)
      {
        throw StepFailure(n, t, reason_of_current_exception());
      }
  }


  /// The error measures by which a tried step is accepted or rejected.
  struct StepErrors
  {
    /// The time error of this step, in the energy norm.
    double indicator = 0.;
    /// The change of the solution in the step and its size, in the same norm.
    double change = 0., size = 0.;
    /// The time error accumulated in earlier steps.
    double before = 0.;
    /// The part of the indicator due to events: slip that comes to rest or
    /// turns, bounds that change, data that oscillate.
    double of_events = 0.;
  };


  /// Numbers of rejected steps by reason, for the summary of a run.
  struct StepCounts
  {
    unsigned int rejected = 0, events = 0, failed = 0;
    /// Steps accepted at the smallest size although the error is too large.
    unsigned int unresolved = 0;
  };


  /// Chooses the time steps: those of the phases, shorter ones where stability
  /// requires it, or steps controlled by their error. It keeps all memory of
  /// the run, so that a step itself is a function of the accepted state, the
  /// time and the step size alone.
  ///
  /// With `Step control/Tolerance' = TOL, a step is accepted if its
  /// contribution d to the time error (ErrorEstimate::time_indicator) satisfies
  ///
  ///     d <= TOL max(size k/T, change),
  ///
  /// with the largest energy norm of the run so far as size and the end time T.
  /// The sum over the run is then at most TOL times the size of the solution
  /// plus the length of its path. The change is in the bound since a solution
  /// that starts from zero has no size yet. The next step follows from the
  /// error ratios of the last two by a proportional-integral controller
  /// (Gustafsson; Hairer and Wanner II, IV.2), whose exponents follow from the
  /// order p of that ratio in k.
  ///
  /// In a run to a tolerance, TOL is the share of the time steps in it, and the
  /// signed sum D of all contributions has to stay below TOL size. A step may
  /// use that part of the rest TOL size - D which it covers of the remaining
  /// time or of the change of the solution,
  ///
  ///     d <= (TOL size - D) min(1, max(k/(T - t), change/size)/c),
  ///
  /// with c <= 1 the ratio of D to the unsigned sum so far, or to TOL size if
  /// that is smaller: where contributions cancel, each may be larger, but less
  /// so near the bound. The rest is at least 0.05 of the bound, so that steps
  /// do not become ever smaller.
  class StepControl
  {
  public:
    /// @p order: of the scheme in k. @p output_interval: 0 for none. @p
    /// tolerance_of_run: the share of time steps in the tolerance, 0 without
    /// one. Throws ExcMessage.
    StepControl(const StepControlParameters &parameters,
                const StiffnessPolicy        stiffness_policy,
                const TimeSchedule          &schedule,
                const unsigned int           order,
                const double                 output_interval,
                const double                 tolerance_of_run = 0.);

    /// The step control of a run with these @p parameters. @p budget: null
    /// without a tolerance.
    StepControl(const Parameters   &parameters,
                const TimeSchedule &schedule,
                const ErrorBudget  *budget);

    /// Whether the time error of steps is estimated, which needs viscosity.
    void
    set_has_estimate(const bool value)
    {
      has_estimate = value;
    }

    /// Also end adaptive steps at these times of kinks and jumps of the data. A
    /// jump gets a short step of its own.
    void
    land_on(const std::vector<double> &kinks, const std::vector<double> &jumps);

    /// The energy norm that the solution is expected to reach.
    void
    expect_size(const double size)
    {
      present.size = size;
    }

    /// Set the norms of the dual solution of a coarse run at given times:
    /// errors may affect a quantity only later, as a force while all points
    /// slip.
    void
    expect_dual_norms(const std::vector<double> &times,
                      const std::vector<double> &norms)
    {
      dual_times = times;
      dual_norms = norms;
    }

    void
    expect_dual_norms_of(const StepControl &other)
    {
      expect_dual_norms(other.dual_times, other.dual_norms);
    }

    /// The largest dual norm from time @p t on; 0 if none is known.
    double
    later_dual_norm(const double t) const;

    /// Whether a step may be tried more than once.
    bool
    may_reject() const
    {
      return is_on || subdivides;
    }

    /// Whether the stability limit of explicit schemes limits the steps.
    bool
    needs_limit() const
    {
      return may_reject() && !passes_limit;
    }

    /// The step to try from time t, after n steps. @p limit is 2/r of an
    /// explicit scheme. Throws ExcMessage if the limit would take millions of
    /// steps.
    TimeStep
    propose(const unsigned int n, const double t, const double limit) const;

    /// Whether a step is accepted; otherwise propose() gives a shorter one. @p
    /// has_event: whether an event happens in it whose time matters.
    bool
    accepts(const TimeStep   &step,
            const StepErrors &errors,
            const bool        has_event);

    /// Repeat the step that has just been accepted on another mesh. Its error
    /// may be larger there: stresses that a finer mesh finds relax at once, a
    /// change of rates that shorter steps do not reduce.
    void
    repeat()
    {
      verdict = present;
      present = before;
    }

    /// Whether propose() gives a shorter step after this one has failed.
    bool
    retries(const TimeStep &step, const bool for_stability);

    /// Whether t is the start, a kink of the data, a phase end or a landing
    /// time, after which slip may end at once without being an event.
    bool
    is_kink(const double t) const
    {
      const double near = 1e-9 * schedule.end_time();
      return t == 0. || schedule.phase_ending_at(t) > 0 ||
             has_kink_within(t - 2. * near, t) ||
             std::binary_search(landing_times.begin(), landing_times.end(), t);
    }

    /// Whether data have a kink or jump known by land_on() in (from, to], up to
    /// rounding: differences between steps before and after it mean nothing.
    bool
    has_kink_within(const double from, const double to) const
    {
      const double near = 1e-9 * schedule.end_time();
      const auto   later =
        std::upper_bound(data_kinks.begin(), data_kinks.end(), from + near);
      return later != data_kinks.end() && *later <= to + near;
    }

    const StepCounts &
    counts() const
    {
      return n;
    }

    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      archive &present.wanted &present.last_ratio &present.size &present
        .was_rejected &present.event_before &present.unsigned_sum;
      archive &n.rejected &n.events &n.failed &n.unresolved;
      archive &dual_times                     &dual_norms;
    }

    const bool is_on, subdivides;
    /// Whether steps beyond the limit are taken by backward Euler.
    const bool passes_limit;

  private:
    /// The state of the controller between steps.
    struct Memory
    {
      /// The end of the last accepted step.
      double t = 0.;
      /// The step size that is tried next; 0 for that of the phase.
      double wanted = 0.;
      /// Error over allowed error of the last accepted step; 0 for none.
      double last_ratio = 0.;
      /// The largest energy norm so far.
      double size         = 0.;
      bool   was_rejected = false;
      /// The end of a step that was rejected for an event that has not been
      /// reached yet.
      double event_before = 0.;
      /// The sum of the indicators of all steps.
      double unsigned_sum = 0.;
    };

    double
    next_target(const double t) const;

    /// The contribution that a step may make to the time error; @p size: the
    /// largest energy norm, this step included.
    double
    allowed_error(const TimeStep   &step,
                  const StepErrors &errors,
                  const double      size) const;

    /// The factor by which the next step may be longer than an accepted one
    /// whose error is @p ratio times the allowed one. Updates `present`.
    double
    growth_allowed_by(const double ratio);

    double
    smallest(const double t) const
    {
      const auto &phase = schedule.phase_at(t);
      return parameters.smallest_step > 0. ? parameters.smallest_step :
                                             1e-6 * (phase.end - phase.start);
    }

    double
    largest(const double t) const
    {
      const auto &phase = schedule.phase_at(t);
      if (parameters.largest_step > 0.)
        return parameters.largest_step;
      return has_estimate ? phase.end - phase.start : phase.step_size();
    }

    const StepControlParameters &parameters;
    const TimeSchedule          &schedule;
    const unsigned int           order;
    const double                 output_interval, tolerance_of_run;
    std::vector<double>          landing_times, data_kinks; // ascending
    std::vector<double>          dual_times, dual_norms;
    bool                         has_estimate = true;

    /// The present state, and that before the last step was accepted.
    Memory present, before;
    /// The state after the step to be repeated, on the mesh before.
    std::optional<Memory> verdict;
    StepCounts            n;
  };
} // namespace Viscoplastic
