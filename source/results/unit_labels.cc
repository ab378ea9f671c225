// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/results/unit_labels.h>

#include <utility>
#include <vector>

namespace Viscoplastic
{
  namespace
  {
    /// Names, of which one that ends with `*' is the beginning of several.
    using UnitTable = std::vector<std::pair<std::string, Quantity>>;

    // As doc/results.md has them; what is not here has no unit.
    const UnitTable of_columns{{"t", Quantity::time},
                               {"k", Quantity::time},
                               {"step_limit", Quantity::time},
                               {"critical_cell_*", Quantity::length},
                               {"tension_area", Quantity::area},
                               {"capped_volume", Quantity::volume},
                               {"duality_gap", Quantity::energy},
                               {"stick_area", Quantity::area},
                               {"slip_area", Quantity::area},
                               {"friction_force_*", Quantity::force},
                               {"contact_force_*", Quantity::force},
                               {"contact_area", Quantity::area},
                               {"max_pressure", Quantity::stress},
                               {"max_gap", Quantity::length},
                               {"max_penetration", Quantity::length},
                               {"reaction_*", Quantity::force},
                               {"load_*", Quantity::force},
                               {"max_stick_slip", Quantity::length},
                               {"stored_energy", Quantity::energy},
                               {"strain_energy", Quantity::energy},
                               {"spring_energy", Quantity::energy},
                               {"viscous_dissipation", Quantity::energy},
                               {"friction_dissipation", Quantity::energy},
                               {"external_work", Quantity::energy},
                               {"adaptation_energy", Quantity::energy},
                               {"construction_energy", Quantity::energy},
                               {"energy_balance_defect", Quantity::energy},
                               {"max_displacement", Quantity::length},
                               {"max_von_mises", Quantity::stress},
                               {"mean_von_mises", Quantity::stress},
                               {"stress_norm", Quantity::stress_norm},
                               {"area_*", Quantity::area},
                               {"volume_*", Quantity::volume},
                               {"stored_energy_*", Quantity::energy},
                               {"viscous_dissipation_*", Quantity::energy},
                               {"energy_norm", Quantity::energy_norm},
                               {"estimate_*", Quantity::energy_norm},
                               {"time_indicator", Quantity::energy_norm},
                               {"velocity_variation", Quantity::rate_norm},
                               {"error_memory", Quantity::energy_norm},
                               {"wall_*", Quantity::wall_time}};

    const UnitTable of_fields{{"displacement", Quantity::length},
                              {"velocity", Quantity::velocity},
                              {"stress_*", Quantity::stress},
                              {"irreversible_stress_*", Quantity::stress},
                              {"von_mises", Quantity::stress},
                              {"creep_rate", Quantity::rate},
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



    /// Of a field, or one of its components.
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



    /// Of an integral over a boundary or a material.
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



    /// Of a column of statistics.csv.
    Quantity
    quantity_of_column(const std::string &name)
    {
      const auto after = [&name](const std::string &text) {
        return name.substr(name.find(text) + text.size());
      };
      // point0_x, point0_stress_xx
      if (name.rfind("point", 0) == 0)
        return after("_").size() == 1 ? Quantity::length :
                                        quantity_of_field(after("_"));
      // integral_body_stress_xx, integral_boundary_3_traction_x
      if (name.rfind("integral_", 0) == 0)
        {
          const bool is_of_boundary = name.rfind("integral_boundary_", 0) == 0;
          const std::string of      = name.substr(name.find('_') + 1);
          const std::size_t domain  = of.find('_') + 1;
          const std::size_t field =
            of.rfind("body_", 0) == 0 ? domain : of.find('_', domain) + 1;
          return integrated(quantity_of_field(of.substr(field)),
                            is_of_boundary);
        }
      return find_quantity(of_columns, name);
    }
  } // namespace



  template <int dim>
  std::string
  UnitLabels<dim>::of_column(const std::string &name) const
  {
    const bool is_of_quantity =
      scene.quantity && name.rfind("quantity_", 0) == 0;
    return scene.parameters.units.label(
      is_of_quantity      ? quantity_of_column(scene.quantity->name) :
      name == "estimator" ? of_estimator() :
                            quantity_of_column(name),
      dim);
  }



  template <int dim>
  std::string
  UnitLabels<dim>::of_field(const std::string &name) const
  {
    return scene.parameters.units.label(
      name == "estimator" ? of_estimator() : quantity_of_field(name), dim);
  }



  template <int dim>
  Quantity
  UnitLabels<dim>::of_estimator() const
  {
    return !scene.quantity && scene.parameters.refinement.strategy ==
                                RefinementStrategy::residual ?
             Quantity::energy_norm :
             Quantity::pure_number;
  }



  template class UnitLabels<2>;
  template class UnitLabels<3>;
} // namespace Viscoplastic
