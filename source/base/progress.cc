// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/progress.h>

#include <algorithm>
#include <cmath>
#include <iomanip>

namespace Viscoplastic
{
  void
  RemainingTime::add_step(const double seconds,
                          const double n_cells,
                          const double done_after)
  {
    ++n;
    const double weight = n <= 2 ? 1. : 1. / std::clamp(n / 3., 10., n - 1.),
                 step   = std::max(done_after - done, 1e-12);
    const auto update   = [](double &mean, const double value, const double w) {
      mean += w * (value - mean);
    };
    update(seconds_per_cell, seconds / n_cells, weight);
    update(part, step, weight);
    if (n > 2)
      update(growth, std::log(step / last_part), 1. / std::min(n - 2., 10.));
    last_part = step;
    done      = done_after;
  }



  double
  RemainingTime::seconds(const double n_cells) const
  {
    // Parts p, p e^g, p e^2g, ... add up to what is left.
    const double equal =
      part > 0. ? (1. - done) / std::max(part, last_part) : 0.;
    const double n_steps =
      growth > 1e-3 ? std::log1p(growth * equal) / growth : equal;
    return n_steps * seconds_per_cell * n_cells;
  }



  void
  Progress::resume(const double done, const double elapsed)
  {
    remaining.add_step(0., 1., done);
    last_elapsed = elapsed;
  }



  void
  Progress::report(const std::string &words,
                   const double       n_cells,
                   const double       done,
                   const double       elapsed)
  {
    remaining.add_step(elapsed - last_elapsed, n_cells, done);
    last_elapsed    = elapsed;
    const auto line = [](const double part) {
      return std::floor(200. * (part + 1e-9));
    };
    if (done < 1. && done_at_line >= 0. && line(done) <= line(done_at_line) &&
        !console.is_verbose())
      return;
    done_at_line = done;
    console.stream() << words << "  elapsed " << duration(elapsed) << "  left "
                     << duration(remaining.seconds(n_cells)) << std::endl;
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
