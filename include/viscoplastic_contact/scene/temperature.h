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
  /// Return the number in @p text, or nothing if it is empty. Throw ExcMessage
  /// naming @p entry if it is anything else, or not positive if it has to be.
  std::optional<double>
  optional_number(const std::string &text, const std::string &entry);
  std::optional<double>
  optional_positive_number(const std::string &text, const std::string &entry);



  /// The given temperature T(x, t) of the body.
  template <int dim>
  class Temperature
  {
  public:
    Temperature(const TemperatureParameters &parameters, const Units &units);

    const Expression<dim> value;
    /// The temperature T_0 without thermal strain; absent if it is the
    /// temperature of each place at t = 0.
    const std::optional<double> reference;
    /// The gas constant R, in the units of the scene.
    const double gas_constant;
  };

  /// Return the temperature that the entries give; null if they give none.
  template <int dim>
  std::unique_ptr<const Temperature<dim>>
  make_temperature(const TemperatureParameters &parameters, const Units &units);
} // namespace Viscoplastic
