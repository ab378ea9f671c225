// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/parameters/phases.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    constexpr double most_steps = 1e8;
  }



  std::vector<StepsUntil>
  read_phases(const std::string &text)
  {
    std::vector<StepsUntil> phases;
    for (const std::string &phase : Utilities::split_string_list(text, ','))
      {
        const auto parts = Utilities::split_string_list(phase, ':');
        phases.push_back({parts.at(0),
                          static_cast<unsigned int>(Utilities::string_to_double(
                            parts.at(1)))}); // may be 1e3
      }
    return phases;
  }



  std::vector<StepsUntil>
  scale_phases(std::vector<StepsUntil> phases, const double factor)
  {
    for (StepsUntil &phase : phases)
      phase.n_steps = static_cast<unsigned int>(std::clamp(
        std::ceil(factor * phase.n_steps * (1. - 1e-12)), 1., most_steps));
    return phases;
  }



  std::string
  write_phases(const std::vector<StepsUntil> &phases)
  {
    std::string text;
    for (const StepsUntil &phase : phases)
      text += (text.empty() ? "" : ", ") + phase.end + ": " +
              std::to_string(phase.n_steps);
    return text;
  }



  unsigned int
  n_steps(const std::vector<StepsUntil> &phases)
  {
    unsigned int n = 0;
    for (const StepsUntil &phase : phases)
      n += phase.n_steps;
    return n;
  }
} // namespace Viscoplastic
