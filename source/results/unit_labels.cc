// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/results/unit_labels.h>

#include <map>

namespace Viscoplastic
{
  const FieldColumn &
  column_of(const RecordedField field)
  {
    using Field                                    = RecordedField;
    constexpr Quantity                        none = Quantity::pure_number;
    static const std::map<Field, FieldColumn> columns{
      {Field::displacement, {"displacement", 1, Quantity::length}},
      {Field::velocity, {"velocity", 1, Quantity::velocity}},
      {Field::stress, {"stress", 2, Quantity::stress}},
      {Field::von_mises_stress, {"von_mises", 0, Quantity::stress}},
      {Field::irreversible_stress,
       {"irreversible_stress", 2, Quantity::stress}},
      {Field::total_strain, {"strain", 2, none}},
      {Field::irreversible_strain, {"irreversible_strain", 2, none}},
      {Field::creep_strain, {"creep_strain", 0, none}},
      {Field::creep_rate, {"creep_rate", 0, Quantity::rate}},
      {Field::history, {"history", 2, none}},
      {Field::principal_stresses,
       {"principal_stress", FieldColumn::principal, Quantity::stress}},
      {Field::temperature, {"temperature", 0, Quantity::temperature}},
      {Field::slip, {"slip", 1, Quantity::length}},
      {Field::slip_rate, {"slip_rate", 1, Quantity::velocity}},
      {Field::traction, {"traction", 1, Quantity::stress}},
      {Field::bound, {"bound", 0, Quantity::stress}},
      {Field::utilization, {"utilisation", 0, none}},
      {Field::stick, {"stick", 0, none}},
      {Field::friction_work, {"friction_work", 0, Quantity::work_per_area}},
      {Field::contact_pressure, {"contact_pressure", 0, Quantity::stress}},
      {Field::gap, {"gap", 0, Quantity::length}},
      {Field::normal_traction, {"normal_traction", 0, Quantity::stress}},
      {Field::stress_vector, {"stress_vector", 1, Quantity::stress}}};
    return columns.at(field);
  }



  template <int dim>
  std::vector<FieldColumn>
  columns_of(const std::set<RecordedField> &fields, const bool of_boundary)
  {
    const std::string        xyz = "xyz";
    std::vector<FieldColumn> result;
    for (const RecordedField field : fields)
      {
        const auto &[name, rank, quantity] = column_of(field);
        const auto add =
          [&, name = name, quantity = quantity](const std::string &component) {
            result.push_back({name + component, 0, quantity});
          };
        if (is_of_boundary(field) != of_boundary)
          continue;
        if (rank == 0)
          add("");
        else if (rank == 1)
          for (unsigned int d = 0; d < dim; ++d)
            add(std::string("_") + xyz[d]);
        else if (rank == 2)
          for (const auto &[i, j] : stress_components<dim>())
            add(std::string("_") + xyz[i] + xyz[j]);
        else
          for (const char *number : {"_1", "_2", "_3"})
            add(number);
      }
    return result;
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



  VISCOPLASTIC_INSTANTIATE(quantity_of_estimator);
  VISCOPLASTIC_INSTANTIATE(columns_of);
} // namespace Viscoplastic
