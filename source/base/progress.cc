// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/progress.h>

#include <cmath>
#include <iomanip>

namespace Viscoplastic
{
  namespace
  {
    /// The text on a step beside its number and time.
    std::string
    state_of(const StepProgress &step, const std::string &time_unit)
    {
      std::string text = "k = " + number(step.k, 3) + time_unit + "  cells " +
                         number(step.n_cells, 18);
      if (step.contact_iterations)
        text +=
          "  contact iterations " + std::to_string(*step.contact_iterations);
      if (step.slipping)
        text += "  slipping " +
                std::to_string(std::lround(100. * *step.slipping)) + " %" +
                (step.slip_rate.empty() ? "" : " at " + step.slip_rate);
      if (step.error_estimate)
        text += "  error estimate " + number(*step.error_estimate, 3);
      if (step.relative_error)
        text +=
          "  error estimate " + number(100. * *step.relative_error, 2) + " %";
      return text;
    }



    /// The text on the number of a step, out of all steps if their number is
    /// known, and its time.
    std::string
    place_of(const StepProgress &step,
             const unsigned int  n_steps,
             const std::string  &time_unit)
    {
      const std::string all =
        step.expected_steps ?
          "~" + number(std::floor(*step.expected_steps), 18) :
          std::to_string(n_steps);
      std::ostringstream text;
      text << "Step ";
      if (!step.done || step.expected_steps)
        text << std::setw(static_cast<int>(all.size())) << step.n << '/' << all;
      else
        text << step.n;
      text << "  t = " << number(step.t, 5) << time_unit;
      return text.str();
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
    const bool   is_last = step.done ? *step.done >= 1. : step.n == n_steps;
    const double done =
      is_last ? 1. : step.done.value_or(static_cast<double>(step.n) / n_steps);
    // is_worth_a_line() has to be called in each step, since it keeps count.
    if (!is_worth_a_line(step, done) && !is_last && !console.is_verbose() &&
        !console.is_silent_for(long_silence))
      {
        ++n_left_out;
        return;
      }
    std::ostream &out = console.stream();
    out << place_of(step, n_steps, time_unit) << "  "
        << state_of(step, time_unit) << "  elapsed " << duration(elapsed);
    if (!step.done || step.expected_steps)
      out << "  left "
          << duration(remaining.seconds(all - step.n, step.n_cells));
    if (n_left_out > 0)
      out << "  (" << n_left_out << (n_left_out == 1 ? " step" : " steps")
          << " left out)";
    out << std::endl;
    done_at_line = done;
    n_left_out   = 0;
  }



  bool
  Progress::is_worth_a_line(const StepProgress &step, const double done)
  {
    const auto is_in_later_part = [done](const double than) {
      constexpr double rounding = 1e-9;
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
    return is_first || is_event || is_in_later_part(done_at_line);
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



  namespace
  {
    Heartbeat *present = nullptr;

    constexpr std::array<const char *, 3> names{
      {" Newton", " contact", " linear"}};
  } // namespace



  Heartbeat::Heartbeat(Console &console, const double seconds)
    : console(console)
    , seconds(seconds)
  {
    if (console.is_heard())
      present = this;
  }



  Heartbeat::~Heartbeat()
  {
    if (present == this)
      present = nullptr;
  }



  void
  Heartbeat::begin_step(const unsigned int n, const double t)
  {
    if (present == nullptr)
      return;
    present->n            = n;
    present->t            = t;
    present->n_iterations = {};
  }



  void
  Heartbeat::count(const Loop loop)
  {
    if (present == nullptr)
      return;
    ++present->n_iterations[static_cast<unsigned int>(loop)];
    if (present->console.is_silent_for(present->seconds))
      present->speak(present->console.age());
  }



  void
  Heartbeat::speak(const double elapsed)
  {
    std::ostringstream text;
    text << "Still at ";
    if (n == 0)
      text << "the initial state";
    else
      text << "step " << n << " (t = " << t << ')';
    const char *separator = ": ";
    for (unsigned int loop = 0; loop < names.size(); ++loop)
      if (n_iterations[loop] > 0)
        {
          text << separator << n_iterations[loop] << names[loop];
          separator = ", ";
        }
    text << " iterations  elapsed " << duration(elapsed);
    console.stream() << text.str() << std::endl;
  }
} // namespace Viscoplastic
