// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/progress.h>

#include <cmath>
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



    /// The step in words, or, if @p width is not 0, in that many characters:
    /// what matters least is left out first.
    std::string
    description(const StepProgress &step,
                const unsigned int  n_steps,
                const double        elapsed,
                const double        left,
                const std::size_t   width)
    {
      const bool        brief = width > 0;
      const std::string all =
        step.expected_steps ?
          "~" + number(std::floor(*step.expected_steps), 18) :
          std::to_string(n_steps);
      std::ostringstream count;
      count << "Step " << std::setw(static_cast<int>(all.size())) << step.n
            << '/' << all;

      // In the order of appearance, with the order of omission.
      std::vector<std::pair<unsigned int, std::string>> parts{
        {8, count.str()},
        {6, "t = " + number(step.t, brief ? 4 : 5)},
        {2, "k = " + number(step.k, brief ? 2 : 3)},
        {3, "cells " + number(step.n_cells, 18)}};
      const std::string error = brief ? "error " : "error estimate ";
      if (step.contact_iterations)
        parts.emplace_back(4,
                           (brief ? "its " : "contact iterations ") +
                             std::to_string(*step.contact_iterations));
      if (step.slipping)
        parts.emplace_back(
          5,
          (brief ? "slip " : "slipping ") +
            std::to_string(std::lround(100. * *step.slipping)) + " %");
      if (step.error_estimate)
        parts.emplace_back(5,
                           error + number(*step.error_estimate, brief ? 2 : 3));
      if (step.relative_error)
        parts.emplace_back(5,
                           error + number(100. * *step.relative_error, 2) +
                             " %");
      parts.emplace_back(1, "elapsed " + duration(elapsed));
      parts.emplace_back(7,
                         (step.steps_grow ? "left < " : "left ") +
                           duration(left));

      std::string line;
      for (unsigned int omitted = 0; omitted < 8; ++omitted)
        {
          line.clear();
          for (const auto &[order, text] : parts)
            if (order > omitted)
              line += (line.empty() ? "" : "  ") + text;
          if (!brief || line.size() <= width)
            break;
        }
      return line;
    }
  } // namespace



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
    const double part = std::floor(
      varies ? max_lines * step.done : double(max_lines) * step.n / n_steps);
    if (step.n == 1 || is_last || part > last_part)
      (console.has_status() && !is_last ? console.log() : console.stream())
        << description(step, n_steps, elapsed, left, 0) << std::endl;
    last_part = part;
    // Ten changes a second are enough.
    if (console.has_status() && !is_last && elapsed - last_shown >= 0.1)
      {
        console.show_status(
          description(step, n_steps, elapsed, left, console.width() - 1));
        last_shown = elapsed;
      }
  }



  std::string
  duration(const double seconds)
  {
    std::ostringstream text;
    text << std::fixed << std::setprecision(seconds < 6000. ? 0 : 1);
    if (seconds < 100.)
      text << seconds << " s";
    else if (seconds < 6000.)
      text << seconds / 60. << " min";
    else if (seconds < 172800.)
      text << seconds / 3600. << " h";
    else
      text << seconds / 86400. << " d";
    return text.str();
  }
} // namespace Viscoplastic
