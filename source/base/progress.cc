// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/progress.h>

#include <cmath>
#include <cstdint>
#include <iomanip>
#include <sstream>
#include <vector>

namespace Viscoplastic
{
  namespace
  {
    std::string
    number(const double value, const int digits)
    {
      std::ostringstream text;
      text << std::setprecision(digits) << value;
      return text.str();
    }



    std::string
    whole_number(const double value)
    {
      return std::to_string(static_cast<std::uint64_t>(value));
    }



    std::string
    percent(const double fraction)
    {
      return std::to_string(std::lround(100. * fraction)) + " %";
    }



    /// The number of the step and of all, which may be an estimate.
    std::string
    count(const StepProgress &step, const unsigned int n_steps)
    {
      const std::string  all = step.expected_steps ?
                                 "~" + whole_number(*step.expected_steps) :
                                 std::to_string(n_steps);
      std::ostringstream text;
      text << "Step " << std::setw(static_cast<int>(all.size())) << step.n
           << '/' << all;
      return text.str();
    }



    /// The step in words, for lines that stay.
    std::string
    in_words(const StepProgress &step,
             const unsigned int  n_steps,
             const double        elapsed,
             const double        left)
    {
      std::string line = count(step, n_steps) + "  t = " + number(step.t, 5) +
                         "  k = " + number(step.k, 3) + "  cells " +
                         whole_number(step.n_cells);
      if (step.contact_iterations)
        line +=
          "  contact iterations " + std::to_string(*step.contact_iterations);
      if (step.slipping)
        line += "  slipping " + percent(*step.slipping);
      if (step.error_estimate)
        line += "  error estimate " + number(*step.error_estimate, 3);
      if (step.relative_error)
        line +=
          "  error estimate " + number(100. * *step.relative_error, 2) + " %";
      return line + "  elapsed " + duration(elapsed) + "  left " +
             duration(left);
    }



    /// The step as a line of at most @p width characters: what matters least
    /// is left out first.
    std::string
    in_short(const StepProgress &step,
             const unsigned int  n_steps,
             const double        elapsed,
             const double        left,
             const std::size_t   width)
    {
      // In the order of appearance, with the order of omission.
      std::vector<std::pair<std::string, unsigned int>> parts;
      parts.emplace_back(count(step, n_steps), 0);
      parts.emplace_back("t = " + number(step.t, 4), 6);
      parts.emplace_back("k = " + number(step.k, 2), 2);
      parts.emplace_back("cells " + whole_number(step.n_cells), 3);
      if (step.contact_iterations)
        parts.emplace_back("its " + std::to_string(*step.contact_iterations),
                           4);
      if (step.slipping)
        parts.emplace_back("slip " + percent(*step.slipping), 5);
      if (step.error_estimate)
        parts.emplace_back("error " + number(*step.error_estimate, 2), 5);
      if (step.relative_error)
        parts.emplace_back("error " + number(100. * *step.relative_error, 2) +
                             " %",
                           5);
      parts.emplace_back("elapsed " + duration(elapsed), 1);
      parts.emplace_back("left " + duration(left), 7);

      std::string line;
      for (unsigned int omitted = 0; omitted <= 7; ++omitted)
        {
          line.clear();
          for (const auto &[text, order] : parts)
            if (order == 0 || order > omitted)
              line += (line.empty() ? "" : "  ") + text;
          if (line.size() <= width)
            break;
        }
      return line;
    }
  } // namespace



  void
  RemainingTime::add_step(const double seconds, const double n_cells)
  {
    const double memory = 0.9;
    weighted_seconds    = memory * weighted_seconds + seconds;
    weighted_cells      = memory * weighted_cells + n_cells;
  }



  double
  RemainingTime::seconds(const double n_steps, const double n_cells) const
  {
    return weighted_cells > 0. ?
             n_steps * n_cells * weighted_seconds / weighted_cells :
             0.;
  }



  Progress::Progress(Console &console, const unsigned int n_steps)
    : console(console)
    , n_steps(n_steps)
  {}



  void
  Progress::report(const StepProgress &step, const double elapsed)
  {
    if (step.n > 0)
      remaining.add_step(elapsed - last_elapsed, step.n_cells);
    last_elapsed = elapsed;
    if (step.n == 0)
      return;
    const bool   varies  = step.expected_steps.has_value();
    const double all     = varies ? *step.expected_steps : n_steps;
    const double left    = remaining.seconds(all - step.n, step.n_cells);
    const bool   is_last = varies ? step.done >= 1. : step.n == n_steps;

    // A line for each of max_lines equal parts of the run.
    const std::uint64_t part =
      varies ? static_cast<std::uint64_t>(step.done * max_lines) :
               std::uint64_t(step.n) * max_lines / n_steps;
    const bool is_another_part = part > last_part;
    last_part                  = part;
    if (step.n == 1 || is_last || is_another_part)
      {
        const std::string line = in_words(step, n_steps, elapsed, left);
        if (!console.has_status() || is_last)
          console.stream() << line << std::endl;
        else
          console.log() << line << std::endl;
      }
    // Ten changes a second are enough.
    if (console.has_status() && !is_last && elapsed - last_shown >= 0.1)
      {
        console.show_status(
          in_short(step, n_steps, elapsed, left, console.width() - 1));
        last_shown = elapsed;
      }
  }



  std::string
  duration(const double seconds)
  {
    std::ostringstream text;
    text << std::fixed << std::setprecision(0);
    if (seconds < 100.)
      text << seconds << " s";
    else if (seconds < 6000.)
      text << seconds / 60. << " min";
    else if (seconds < 172800.)
      text << std::setprecision(1) << seconds / 3600. << " h";
    else
      text << std::setprecision(1) << seconds / 86400. << " d";
    return text.str();
  }
} // namespace Viscoplastic
