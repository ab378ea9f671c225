// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>

#include <algorithm>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /**
   * How long the rest of a run takes, from what steps have taken: in proportion
   * to the number of cells, and with weights that halve in about seven steps.
   */
  class RemainingTime
  {
  public:
    /// A step has taken @p seconds.
    void
    add_step(const double seconds, const double n_cells)
    {
      weighted_seconds = 0.9 * weighted_seconds + seconds;
      weighted_cells   = 0.9 * weighted_cells + n_cells;
    }

    /// What @p n_steps further ones will take on a mesh of @p n_cells.
    double
    seconds(const double n_steps, const double n_cells) const
    {
      return weighted_cells > 0. ?
               n_steps * n_cells * weighted_seconds / weighted_cells :
               0.;
    }

  private:
    double weighted_seconds = 0., weighted_cells = 0.;
  };



  /**
   * The size of steps to come, where they are chosen on the way: the mean of
   * those that have been made, with weights that halve in about seven steps, or
   * the last one if that is longer. A short one to a time that has to be met is
   * no sign of others.
   */
  class ExpectedStep
  {
  public:
    void
    add_step(const double k)
    {
      last           = k;
      weighted_sizes = 0.9 * weighted_sizes + k;
      weights        = 0.9 * weights + 1.;
    }

    double
    size() const
    {
      return std::max(last, mean());
    }

    /// Whether the last one is much longer than those before.
    bool
    grows() const
    {
      return last > 1.2 * mean();
    }

  private:
    double
    mean() const
    {
      return weights > 0. ? weighted_sizes / weights : 0.;
    }

    double last = 0., weighted_sizes = 0., weights = 0.;
  };



  /// What there is to say of a step.
  struct StepProgress
  {
    unsigned int n;
    double       t, k;
    /// Of the whole mesh.
    double n_cells;
    /// With friction: corrections of the active set, and the slipping part of
    /// the area.
    std::optional<unsigned int> contact_iterations = {};
    std::optional<double>       slipping           = {};
    /// In adaptive scenes without error estimate.
    std::optional<double> error_estimate = {};
    /// With an error estimate: its total over the energy norm of the solution.
    std::optional<double> relative_error = {};
    /// Where steps are chosen on the way: how many the run may have, and which
    /// part of its time is done.
    std::optional<double> expected_steps = {};
    double                done           = 0.;
    /// Whether steps still become longer, so that fewer may do.
    bool steps_grow = false;
  };



  /**
   * Tells how a run proceeds. A terminal shows the present step in a line that
   * changes. Otherwise, and in the log, steps are lines, at most about 200 of
   * them in a run; statistics.csv has all steps.
   */
  class Progress
  {
  public:
    /// @p n_steps: of the run, unless each step says how many it expects.
    Progress(Console &console, const unsigned int n_steps)
      : console(console)
      , n_steps(n_steps)
    {}

    /// A step has been made, @p elapsed seconds after the beginning of the
    /// run; the initial state is step 0. In the order of steps, on all ranks.
    void
    report(const StepProgress &step, const double elapsed);

  private:
    static constexpr unsigned int max_lines = 200;

    Console           &console;
    const unsigned int n_steps;
    RemainingTime      remaining;
    double             last_elapsed = 0., last_shown = -1.;
    /// Of max_lines equal parts of the run, those that are done.
    double last_part = 0.;
  };



  /// Seconds for people: `45 s', `12 min', `3.4 h', `2.1 d'.
  std::string
  duration(const double seconds);
} // namespace Viscoplastic
