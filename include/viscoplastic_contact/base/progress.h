// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>

#include <string>

namespace Viscoplastic
{
  /// Estimates the time that the rest of a run takes from its last steps, ten
  /// or a third of all: the time that a step takes for each cell, and what it
  /// does of the run, which grows from step to step in a relaxation.
  class RemainingTime
  {
  public:
    /// Record a step that has taken @p seconds on @p n_cells cells, after which
    /// the part @p done of the run has been made. The first step is forgotten
    /// since it sets up what later ones reuse.
    void
    add_step(const double seconds, const double n_cells, const double done);

    /// Return the seconds until the end on a mesh of @p n_cells cells.
    double
    seconds(const double n_cells) const;

  private:
    unsigned int n                = 0;
    double       done             = 0.;
    double       seconds_per_cell = 0.;
    /// The part of the run that is done by a step, the last one and in the
    /// mean, and the mean growth of its logarithm from step to step.
    double last_part = 0., part = 0., growth = 0.;
  };



  /// Prints the progress of a run: a line for the first and the last step and
  /// for one in each of 200 equal parts of the run. statistics.csv has all
  /// steps.
  class Progress
  {
  public:
    explicit Progress(Console &console)
      : console(console)
    {}

    /// Continue a run that has been made in part, after @p elapsed seconds.
    void
    resume(const double done, const double elapsed);

    /// Report a step after which the part @p done of the run has been made,
    /// @p elapsed seconds after its beginning; @p words describe the step. To
    /// be called in order.
    void
    report(const std::string &words,
           const double       n_cells,
           const double       done,
           const double       elapsed);

  private:
    Console      &console;
    RemainingTime remaining;
    double        last_elapsed = 0.;
    /// The part of the run at the last line; negative before the first.
    double done_at_line = -1.;
  };



  /// Return seconds in a readable unit: `45 s', `12 min', `3.4 h', `2.1 d'.
  std::string
  duration(const double seconds);
} // namespace Viscoplastic
