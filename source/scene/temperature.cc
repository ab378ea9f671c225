// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/scene/temperature.h>

namespace Viscoplastic
{
  std::optional<double>
  optional_number(const std::string &text, const std::string &entry)
  {
    if (Utilities::trim(text).empty())
      return {};
    const Expression<1> number(text, entry);
    if (number.depends_on_position() || number.depends_on_time())
      refuse("'" + entry + "' = " + text + " is not a number.");
    return number.value(Point<1>(), 0.);
  }



  std::optional<double>
  optional_positive_number(const std::string &text, const std::string &entry)
  {
    const auto result = optional_number(text, entry);
    if (result && !(*result > 0.))
      refuse("'" + entry + "' = " + text + " is not positive.");
    return result;
  }



  namespace
  {
    double
    gas_constant(const std::string &text, const Units &units)
    {
      const double joules = 8.314462618; // CODATA 2018, a mole and a kelvin
      return optional_positive_number(text, "Temperature/Gas constant")
        .value_or(units.are_declared() ? joules / units.si({3., 0., 1.}) :
                                         joules);
    }
  } // namespace



  template <int dim>
  Temperature<dim>::Temperature(const TemperatureParameters &parameters,
                                const Units                 &units)
    : value(parameters.value, "Temperature/Value")
    , reference(optional_number(parameters.reference,
                                "Temperature/Reference temperature"))
    , gas_constant(Viscoplastic::gas_constant(parameters.gas_constant, units))
  {}



  template <int dim>
  std::unique_ptr<const Temperature<dim>>
  make_temperature(const TemperatureParameters &parameters, const Units &units)
  {
    if (!Utilities::trim(parameters.value).empty())
      return std::make_unique<const Temperature<dim>>(parameters, units);
    if (!parameters.reference.empty() || !parameters.gas_constant.empty())
      refuse("'Temperature' has no `Value', so that its other entries mean "
             "nothing.");
    return nullptr;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(Temperature);
  VISCOPLASTIC_INSTANTIATE(make_temperature);
} // namespace Viscoplastic
