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



    /// What there is to tell of a step beside its time, each part with the
    /// order of its omission.
    std::vector<std::pair<unsigned int, std::string>>
    state_of(const StepProgress &step,
             const std::string  &time_unit,
             const bool          brief)
    {
      std::vector<std::pair<unsigned int, std::string>> parts{
        {2, "k = " + number(step.k, brief ? 2 : 3) + time_unit},
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
      return parts;
    }



    /// The step in words, or, if @p width is not 0, in that many characters:
    /// what matters least is left out first.
    std::string
    description(const StepProgress &step,
                const unsigned int  n_steps,
                const std::string  &time_unit,
                const double        elapsed,
                const double        left,
                const std::size_t   width)
    {
      const bool        brief = width > 0;
      const std::string all =
        step.expected_steps ?
          "~" + number(std::floor(*step.expected_steps), 18) :
          std::to_string(n_steps);
      const bool         is_known = !step.done || step.expected_steps;
      std::ostringstream count;
      count << "Step ";
      if (is_known)
        count << std::setw(static_cast<int>(all.size())) << step.n << '/'
              << all;
      else
        count << step.n;

      // In the order of appearance, with the order of omission.
      std::vector<std::pair<unsigned int, std::string>> parts{
        {8, count.str()},
        {6, "t = " + number(step.t, brief ? 4 : 5) + time_unit}};
      const auto state = state_of(step, time_unit, brief);
      parts.insert(parts.end(), state.begin(), state.end());
      parts.emplace_back(1, "elapsed " + duration(elapsed));
      if (is_known)
        parts.emplace_back(7, "left " + duration(left));

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
    const double all     = step.expected_steps.value_or(n_steps);
    const double left    = remaining.seconds(all - step.n, step.n_cells);
    const bool   is_last = step.done ? *step.done >= 1. : step.n == n_steps;

    std::string text;
    for (const auto &part : state_of(step, time_unit, /* brief = */ false))
      text += part.second + "  ";
    const double done =
      is_last ? 1. : step.done.value_or(static_cast<double>(step.n) / n_steps);
    // Asked in each step: it keeps count.
    if (is_worth_a_line(step, text, done) || is_last || console.is_verbose())
      {
        std::ostream &out =
          console.has_status() && !is_last ? console.log() : console.stream();
        out << description(step, n_steps, time_unit, elapsed, left, 0);
        if (n_left_out > 0)
          out << "  (" << n_left_out << (n_left_out == 1 ? " step" : " steps")
              << (n_left_out_alike == n_left_out ? " like the line above" : "")
              << " left out)";
        out << std::endl;
        last_text        = text;
        done_at_line     = done;
        n_left_out       = 0;
        n_left_out_alike = 0;
      }
    else
      {
        ++n_left_out;
        n_left_out_alike += text == last_text;
      }
    // Ten changes a second are enough.
    if (console.has_status() && !is_last && elapsed - last_shown >= 0.1)
      {
        console.show_status(description(
          step, n_steps, time_unit, elapsed, left, console.width() - 1));
        last_shown = elapsed;
      }
  }



  bool
  Progress::is_worth_a_line(const StepProgress &step,
                            const std::string  &text,
                            const double        done)
  {
    constexpr double rounding         = 1e-9;
    const auto       is_in_later_part = [done](const double than) {
      return std::floor(max_lines * (done + rounding)) >
             std::floor(max_lines * (than + rounding));
    };
    const double slipping = step.slipping.value_or(0.);
    const int    slip     = slipping >= 1. ? 2 : slipping > 0. ? 1 : 0;
    const bool   is_first = done_at_line < 0.;
    const bool   is_event = !is_first &&
                          (step.n_cells != last_cells || slip != last_slip) &&
                          is_in_later_part(done_at_event);
    last_cells = step.n_cells;
    last_slip  = slip;
    if (is_event)
      done_at_event = done;

    const bool repeats = text == last_text;
    const bool is_due  = !repeats || n_left_out + 1 >= next_distance ||
                        done >= done_at_line + 0.1 - rounding;
    if (!is_first && !is_event && !(is_due && is_in_later_part(done_at_line)))
      return false;
    // 1, 2, 5, 10, 20, 50, ...
    if (!repeats)
      next_distance = 1;
    else
      {
        unsigned int digit = next_distance;
        while (digit >= 10)
          digit /= 10;
        next_distance = digit == 2 ? next_distance / 2 * 5 : 2 * next_distance;
      }
    return true;
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
