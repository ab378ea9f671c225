// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/results/unit_labels.h>

namespace Viscoplastic
{
  namespace
  {
    /// Names, of which one that ends with `*' is the beginning of several.
    using UnitTable = std::vector<std::pair<std::string, Quantity>>;

    // What is not here has no unit.
    const UnitTable of_fields{{"displacement", Quantity::length},
                              {"velocity", Quantity::velocity},
                              {"stress_*", Quantity::stress},
                              {"irreversible_stress_*", Quantity::stress},
                              {"von_mises", Quantity::stress},
                              {"creep_rate", Quantity::rate},
                              {"temperature", Quantity::temperature},
                              {"principal_stress_*", Quantity::stress},
                              {"error_energy", Quantity::energy_norm},
                              {"recovery", Quantity::energy_norm},
                              {"slip", Quantity::length},
                              {"slip_rate", Quantity::velocity},
                              {"traction", Quantity::stress},
                              {"bound", Quantity::stress},
                              {"contact_pressure", Quantity::stress},
                              {"gap", Quantity::length},
                              {"normal_traction", Quantity::stress},
                              {"friction_work", Quantity::work_per_area}};



    Quantity
    find_quantity(const UnitTable &table, const std::string &name)
    {
      for (const auto &[pattern, quantity] : table)
        {
          const std::size_t n = pattern.size() - 1;
          if (pattern.back() == '*' ? name.compare(0, n, pattern, 0, n) == 0 :
                                      name == pattern)
            return quantity;
        }
      return Quantity::pure_number;
    }



    /// What an integral over a boundary or a material is.
    Quantity
    integrated(const Quantity quantity, const bool is_of_boundary)
    {
      if (quantity == Quantity::stress)
        return is_of_boundary ? Quantity::force : Quantity::energy;
      if (quantity == Quantity::work_per_area && is_of_boundary)
        return Quantity::energy;
      if (quantity == Quantity::length && is_of_boundary)
        return Quantity::volume;
      if (quantity == Quantity::pure_number)
        return is_of_boundary ? Quantity::area : Quantity::volume;
      return Quantity::pure_number; // which has no name of its own
    }
  } // namespace



  Quantity
  quantity_of_field(const std::string &name)
  {
    const Quantity whole = find_quantity(of_fields, name);
    const bool     is_component =
      name.size() > 2 && name[name.size() - 2] == '_' &&
      std::string("xyz").find(name.back()) != std::string::npos;
    return whole != Quantity::pure_number || !is_component ?
             whole :
             find_quantity(of_fields, name.substr(0, name.size() - 2));
  }



  Quantity
  quantity_of_integral(const std::string &name)
  {
    const auto begins = [&name](const char *with) {
      return name.rfind(with, 0) == 0;
    };
    if (begins("area_"))
      return Quantity::area;
    if (begins("volume_"))
      return Quantity::volume;
    if (!begins("integral_"))
      return Quantity::energy; // stored or dissipated
    // integral_body_stress_xx, integral_boundary_3_traction_x
    const std::string of     = name.substr(name.find('_') + 1);
    const std::size_t domain = of.find('_') + 1;
    const std::size_t field =
      of.rfind("body_", 0) == 0 ? domain : of.find('_', domain) + 1;
    return integrated(quantity_of_field(of.substr(field)),
                      begins("integral_boundary_"));
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
