// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/parameters/parameters.h>

#include <memory>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /// The number in @p text, or nothing if that is empty. Throws ExcMessage
  /// naming @p entry if it is something else, or not positive.
  std::optional<double>
  optional_number(const std::string &text, const std::string &entry);
  std::optional<double>
  optional_positive_number(const std::string &text, const std::string &entry);



  /// The temperature T(x, t) of the body, which is given.
  template <int dim>
  class Temperature
  {
  public:
    Temperature(const TemperatureParameters &parameters, const Units &units);

    const Expression<dim> value;
    /// T_0, where there is no thermal strain; nothing for the temperature of
    /// each place at t = 0.
    const std::optional<double> reference;
    /// The gas constant R, in the units of the scene.
    const double gas_constant;
  };

  /// The temperature that the entries give; null if none.
  template <int dim>
  std::unique_ptr<const Temperature<dim>>
  make_temperature(const TemperatureParameters &parameters, const Units &units);
} // namespace Viscoplastic
