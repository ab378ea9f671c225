// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/results/unit_labels.h>

#include <map>

namespace Viscoplastic
{
  Quantity
  quantity_of_field(const std::string &name)
  {
    // Fields that are not listed have no unit.
    static const std::map<std::string, Quantity> of_fields{
      {"displacement", Quantity::length},
      {"velocity", Quantity::velocity},
      {"stress", Quantity::stress},
      {"irreversible_stress", Quantity::stress},
      {"von_mises", Quantity::stress},
      {"creep_rate", Quantity::rate},
      {"temperature", Quantity::temperature},
      {"principal_stress", Quantity::stress},
      {"error_energy", Quantity::energy_norm},
      {"recovery", Quantity::energy_norm},
      {"slip", Quantity::length},
      {"slip_rate", Quantity::velocity},
      {"traction", Quantity::stress},
      {"bound", Quantity::stress},
      {"contact_pressure", Quantity::stress},
      {"gap", Quantity::length},
      {"normal_traction", Quantity::stress},
      {"stress_vector", Quantity::stress},
      {"friction_work", Quantity::work_per_area}};
    // The name is that of a field or of a component.
    for (const std::string &field : {name, name.substr(0, name.rfind('_'))})
      if (const auto found = of_fields.find(field); found != of_fields.end())
        return found->second;
    return Quantity::pure_number;
  }



  template <int dim>
  Quantity
  quantity_of_estimator(const Scene<dim> &scene)
  {
    return !scene.quantity && scene.parameters.refinement.strategy ==
                                RefinementStrategy::residual ?
             Quantity::energy_norm :
             Quantity::pure_number;
  }



  template <int dim>
  std::string
  label_of_field(const Scene<dim> &scene, const std::string &name)
  {
    return scene.parameters.units.label(name == "estimator" ?
                                          quantity_of_estimator(scene) :
                                          quantity_of_field(name),
                                        dim);
  }



  VISCOPLASTIC_INSTANTIATE(quantity_of_estimator);
  VISCOPLASTIC_INSTANTIATE(label_of_field);
} // namespace Viscoplastic
