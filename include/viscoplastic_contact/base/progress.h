// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /// How long the rest of a run takes, from what steps have taken: in
  /// proportion to the number of cells. Those of the last third of the run so
  /// far count, or some ten: of a long run enough to have its share of steps
  /// that write fields. The first step sets up what others use.
  class RemainingTime
  {
  public:
    /// A step has taken @p seconds.
    void
    add_step(const double seconds, const double n_cells)
    {
      ++n;
      const double kept =
        n == 2 ? 0. : 1. - 1. / std::max(10., static_cast<double>(n) / 3.);
      weighted_seconds = kept * weighted_seconds + seconds;
      weighted_cells   = kept * weighted_cells + n_cells;
    }

    /// The seconds that @p n_steps further steps are expected to take on a mesh
    /// of @p n_cells cells.
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



  /// The size of steps to come, where they are chosen on the way: the mean of
  /// those that have been made, with weights that halve in about seven steps,
  /// or the last one if that is longer. A short one to a time that has to be
  /// met is no sign of others.
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

    /// The first ones may be tiny, and how fast they grow shows in some more.
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



  /// What a line of progress says of a step, as far as a scene has it.
  struct StepProgress
  {
    unsigned int n;
    double       t, k;
    /// The number of active cells of the whole mesh.
    double n_cells;
    /// Corrections of the active set, and the slipping part of the area; in
    /// scenes with friction.
    std::optional<unsigned int> contact_iterations = {};
    std::optional<double>       slipping           = {};
    /// The largest slip rate, as text with its unit.
    std::string slip_rate = {};
    /// The estimate by which an adaptive scene without error estimate refines.
    std::optional<double> error_estimate = {};
    /// The total error estimate over the energy norm of the solution; in scenes
    /// with an error estimate.
    std::optional<double> relative_error = {};
    /// With adaptive steps: the fraction of the time that is done, and the
    /// expected number of steps, once it is known.
    std::optional<double> done           = {};
    std::optional<double> expected_steps = {};
  };



  /// Tells how a run proceeds, in lines: of 200 equal parts of the run each has
  /// at most one, and another one if the mesh changes or slip begins or ends in
  /// it; after a long silence the next step has one, too.
  /// Lines tell how many steps have been left out before them. statistics.csv
  /// has all steps.
  class Progress
  {
  public:
    /// @p n_steps: of the run, unless each step says how many it expects.
    /// @p time_unit stands behind times, such as " day".
    Progress(Console           &console,
             const unsigned int n_steps,
             const std::string &time_unit = "")
      : console(console)
      , n_steps(n_steps)
      , time_unit(time_unit)
    {}

    /// A step has been made, @p elapsed seconds after the beginning of the
    /// run; the initial state is step 0. In the order of steps, on all ranks.
    void
    report(const StepProgress &step, const double elapsed);

  private:
    static constexpr unsigned int max_lines = 200;
    /// The next step gets a line after so many seconds: less than a Heartbeat
    /// waits for, since lines of steps tell more.
    static constexpr double long_silence = 8.;

    /// Whether a step other than the last one gets a line; @p done is the part
    /// of the run that has been made.
    bool
    is_worth_a_line(const StepProgress &step, const double done);

    Console           &console;
    const unsigned int n_steps;
    const std::string  time_unit;
    RemainingTime      remaining;
    double             last_elapsed = 0.;

    /// Steps without a line since the last one with a line.
    unsigned int n_left_out = 0;
    /// The number of cells in the last step, and whether none (0), some (1) or
    /// all (2) of the contact face slipped in it.
    double last_cells = 0.;
    int    last_slip  = 0;
    /// The part of the run that had been done at the last line, and at the last
    /// one because of an event; negative before the first.
    double done_at_line = -1., done_at_event = -1.;
  };



  /// Seconds for people: `45 s', `12 min', `3.4 h', `2.1 d'.
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

  /// While an object of this class lives, a run that has said nothing for some
  /// time says where it is, from within the iterations of a step: "Still at
  /// step 3 (t = 0.3): 2 Newton, 17 contact, 340 linear iterations  elapsed 31
  /// s". Iterations and steps report to it by count() and begin_step(), which
  /// may be called without an object and then do nothing. Not for several
  /// threads.
  class Heartbeat
  {
  public:
    /// Speaks on @p console if that has been silent for @p seconds, or a
    /// hundredth of the run, whichever is longer.
    explicit Heartbeat(Console &console, const double seconds = 10.);
    ~Heartbeat();

    Heartbeat(const Heartbeat &) = delete;
    Heartbeat &
    operator=(const Heartbeat &) = delete;

    /// A step, or another try of one, is begun.
    static void
    begin_step(const unsigned int n, const double t);

    /// An iteration of this kind is made.
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
