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
  /// where G is that of @p law, which holds at the temperature T_L, infinity
  /// for a factor exp(-Q/(R T)); @p activation_temperature is Q/R. Points that
  /// are not above absolute zero have no rate: who evaluates the law makes sure
  /// that there are none.
  std::unique_ptr<ViscoplasticLaw>
  thermally_activated(std::unique_ptr<ViscoplasticLaw> law,
                      const double                     activation_temperature,
                      const double                     law_temperature);
} // namespace Viscoplastic
