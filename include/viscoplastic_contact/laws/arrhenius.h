// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <memory>

namespace Viscoplastic
{
  /// The law with the rate
  ///
  ///     exp(-Q/R (1/T - 1/T_L)) G(t, sigma, eps),
  ///
  /// where G is the function of @p law, which holds at the temperature T_L. An
  /// infinite T_L gives the factor exp(-Q/(R T)). @p activation_temperature is
  /// Q/R. Callers must make sure that temperatures are above absolute zero.
  std::unique_ptr<ViscoplasticLaw>
  thermally_activated(std::unique_ptr<ViscoplasticLaw> law,
                      const double                     activation_temperature,
                      const double                     law_temperature);
} // namespace Viscoplastic
