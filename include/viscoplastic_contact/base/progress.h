// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /// Estimates the time that the rest of a run takes, in proportion to the
  /// number of cells, from the last third of the steps so far, or some ten: in
  /// long runs these include their share of steps that write fields. The first
  /// step is ignored since it sets up what later ones reuse.
  class RemainingTime
  {
  public:
    /// Record that a step has taken @p seconds.
    void
    add_step(const double seconds, const double n_cells)
    {
      ++n;
      const double kept =
        n == 2 ? 0. : 1. - 1. / std::max(10., static_cast<double>(n) / 3.);
      weighted_seconds = kept * weighted_seconds + seconds;
      weighted_cells   = kept * weighted_cells + n_cells;
    }

    /// Return the expected time in seconds of @p n_steps further steps on a
    /// mesh of @p n_cells cells.
    double
    seconds(const double n_steps, const double n_cells) const
    {
      return weighted_cells > 0. ?
               n_steps * n_cells * weighted_seconds / weighted_cells :
               0.;
    }

  private:
    unsigned int n                = 0;
    double       weighted_seconds = 0., weighted_cells = 0.;
  };



  /// Predicts the size of future adaptive time steps: the mean of past sizes,
  /// with weights that halve in about seven steps, or the last size if that is
  /// larger. A single short step, made to reach a prescribed time, says little
  /// about the following ones.
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

    /// Whether there are enough steps for a prediction: the first ones may be
    /// tiny and growing fast.
    bool
    is_known() const
    {
      return weights > 3.;
    }

  private:
    double
    mean() const
    {
      return weights > 0. ? weighted_sizes / weights : 0.;
    }

    double last = 0., weighted_sizes = 0., weights = 0.;
  };



  /// The data of a step for a progress line, as far as the scene has them.
  struct StepProgress
  {
    unsigned int n;
    double       t, k;
    /// The global number of active cells.
    double n_cells;
    /// Corrections of the active set, and the slipping fraction of the contact
    /// area, in scenes with friction.
    std::optional<unsigned int> contact_iterations = {};
    std::optional<double>       slipping           = {};
    /// The largest slip rate, as text with its unit.
    std::string slip_rate = {};
    /// The refinement indicator of an adaptive scene without error estimate.
    std::optional<double> error_estimate = {};
    /// The total error estimate divided by the energy norm of the solution, in
    /// scenes with an error estimate.
    std::optional<double> relative_error = {};
    /// With adaptive time steps: the elapsed fraction of the simulated time,
    /// and the expected number of steps once it is known.
    std::optional<double> done           = {};
    std::optional<double> expected_steps = {};
  };



  /// Prints the progress of a run: at most one line in each of 200 equal parts
  /// of it, and one more if the mesh changes or slip begins or ends there;
  /// after a long silence the next step is printed, too. Each line tells how
  /// many steps have been left out before it. statistics.csv has all steps.
  class Progress
  {
  public:
    /// @p n_steps is the number of steps of the run; it is not used if steps
    /// have `expected_steps`. @p time_unit follows times, such as " day".
    Progress(Console           &console,
             const unsigned int n_steps,
             const std::string &time_unit = "")
      : console(console)
      , n_steps(n_steps)
      , time_unit(time_unit)
    {}

    /// Report a step that ends @p elapsed seconds after the beginning of the
    /// run; the initial state is step 0. To be called in order, on all ranks.
    void
    report(const StepProgress &step, const double elapsed);

  private:
    static constexpr unsigned int max_lines = 200;
    /// The seconds of silence after which the next step is printed: less than
    /// for a Heartbeat, since lines of steps tell more.
    static constexpr double long_silence = 8.;

    /// Whether to print a step other than the last one; @p done is the fraction
    /// of the run that has been made.
    bool
    is_worth_a_line(const StepProgress &step, const double done);

    Console           &console;
    const unsigned int n_steps;
    const std::string  time_unit;
    RemainingTime      remaining;
    double             last_elapsed = 0.;

    /// The number of steps left out since the last line.
    unsigned int n_left_out = 0;
    /// The number of cells in the last step, and whether none (0), some (1) or
    /// all (2) of the contact face slipped in it.
    double last_cells = 0.;
    int    last_slip  = 0;
    /// The fraction of the run at the last line, and at the last line caused by
    /// an event; negative before the first.
    double done_at_line = -1., done_at_event = -1.;
  };



  /// Return seconds in a readable unit: `45 s', `12 min', `3.4 h', `2.1 d'.
  std::string
  duration(const double seconds);



  /// The nested iterations that solve a time step, from the outermost to the
  /// innermost.
  enum class Loop
  {
    newton,
    contact,
    linear
  };

  /// While an object of this class lives, a run that is silent for some time
  /// prints where it is, from within the iterations of a step: "Still at step 3
  /// (t = 0.3): 2 Newton, 17 contact, 340 linear iterations  elapsed 31 s".
  /// Iterations and steps report by count() and begin_step(), which do nothing
  /// if there is no such object. Not thread-safe.
  class Heartbeat
  {
  public:
    /// Print on @p console if that has been silent for @p seconds, or for a
    /// hundredth of the run if that is longer.
    explicit Heartbeat(Console &console, const double seconds = 10.);
    ~Heartbeat();

    Heartbeat(const Heartbeat &) = delete;
    Heartbeat &
    operator=(const Heartbeat &) = delete;

    /// Record that a step, or another attempt at it, begins.
    static void
    begin_step(const unsigned int n, const double t);

    /// Count an iteration of this kind.
    static void
    count(const Loop loop);

  private:
    void
    speak(const double elapsed);

    Console                    &console;
    const double                seconds;
    unsigned int                n = 0;
    double                      t = 0.;
    std::array<unsigned int, 3> n_iterations{};
  };
} // namespace Viscoplastic
