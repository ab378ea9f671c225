// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/scene/boundary_condition.h>

#include <sstream>

// The data of a boundary condition at places and times.

namespace Viscoplastic
{
  namespace
  {
    /// The value of an entry at a place, whose description comes in parts.
    template <typename... Place>
    double
    not_negative(const double             value,
                 const types::boundary_id id,
                 const std::string       &name,
                 const Place &...place)
    {
      if (!(value >= 0.))
        {
          std::ostringstream message;
          message << "'Boundary " << id << '/' << name << "' is " << value
                  << " at ";
          (message << ... << place) << "; it must not be negative.";
          AssertThrow(false, ExcMessage(message.str()));
        }
      return value;
    }
  } // namespace



  template <int dim>
  double
  BoundaryCondition<dim>::bound(const Point<dim> &x, const double t) const
  {
    // rho = g, (5.22), or mu |S|, (5.6).
    const double given = sum_of_friction(x, t, /* of_pressure = */ false);
    return has_given_stress() ? given + friction_coefficient(x, t) *
                                          std::abs(normal_stress->value(x, t)) :
                                given;
  }



  template <int dim>
  double
  BoundaryCondition<dim>::friction_coefficient(const Point<dim> &x,
                                               const double      t) const
  {
    return sum_of_friction(x, t, /* of_pressure = */ true);
  }



  template <int dim>
  double
  BoundaryCondition<dim>::sum_of_friction(const Point<dim> &x,
                                          const double      t,
                                          const bool        of_pressure) const
  {
    double sum = 0.;
    for (unsigned int i = 0; i < friction_data.size(); ++i)
      if (const LawEntry &entry = friction_law->entries[i];
          entry.of_pressure == of_pressure)
        sum += not_negative(friction_data[i].value(x, t),
                            id,
                            entry.name,
                            "x = (",
                            x,
                            "), t = ",
                            t);
    return sum;
  }



  template <int dim>
  double
  BoundaryCondition<dim>::bound_factor(const double slip_rate) const
  {
    if (!slip_rate_factor)
      return 1.;
    return not_negative(slip_rate_factor->value(Point<1>(slip_rate), 0.),
                        id,
                        "Slip rate factor",
                        "v = ",
                        slip_rate);
  }



  template <int dim>
  double
  BoundaryCondition<dim>::compliance(const Point<dim> &x) const
  {
    return not_negative(given_compliance->value(x, 0.),
                        id,
                        contact_law->entries.front().name,
                        "x = (",
                        x,
                        ")");
  }



  template <int dim>
  void
  BoundaryCondition<dim>::derive_data()
  {
    if (solution && has_given_stress())
      normal_stress.emplace(
        [solution = solution, normal = normal](const Point<dim> &x,
                                               const double      t) {
          return solution->traction(x, normal, t) * normal;
        },
        "Exact solution/Stress");
  }



  template <int dim>
  Tensor<1, dim>
  BoundaryCondition<dim>::load(const Point<dim>     &x,
                               const Tensor<1, dim> &outward_normal,
                               const double          t) const
  {
    if (normal_stress)
      return normal_stress->value(x, t) * outward_normal;
    Tensor<1, dim> result;
    if (has_derived_traction())
      {
        result = solution->traction(x, outward_normal, t);
        if (has_springs())
          result +=
            spring_stiffness(x, outward_normal) * solution->displacement(x, t);
      }
    if (traction)
      result = traction->vector(x, t);
    if (pressure)
      result -= pressure->value(x, t) * outward_normal;
    for (unsigned int d = 0; d < dim; ++d)
      if (displacement[d])
        result[d] = 0.;
    return result;
  }



  template <int dim>
  SymmetricTensor<2, dim>
  BoundaryCondition<dim>::spring_stiffness(
    const Point<dim>     &x,
    const Tensor<1, dim> &outward_normal) const
  {
    const auto value = [&](const std::optional<Expression<dim>> &datum,
                           const std::string                    &name) {
      return datum ?
               not_negative(datum->value(x, 0.), id, name, "x = (", x, ")") :
               0.;
    };
    const double k_n = value(normal_stiffness, "Normal stiffness"),
                 k_t = value(tangential_stiffness, "Tangential stiffness");
    return k_t * unit_symmetric_tensor<dim>() +
           (k_n - k_t) *
             symmetrize(outer_product(outward_normal, outward_normal));
  }



  template <int dim>
  std::vector<const Expression<dim> *>
  BoundaryCondition<dim>::data() const
  {
    std::vector<const Expression<dim> *> result;
    const auto add = [&](const std::optional<Expression<dim>> &datum) {
      if (datum)
        result.push_back(&*datum);
    };
    for (const auto &component : displacement)
      add(component);
    add(given_gap);
    add(given_compliance);
    add(normal_stiffness);
    add(tangential_stiffness);
    add(foundation_displacement);
    for (const Expression<dim> &datum : friction_data)
      result.push_back(&datum);
    add(normal_stress);
    add(pressure);
    for (const auto *vector : {&traction, &foundation_motion})
      if (*vector)
        for (unsigned int d = 0; d < dim; ++d)
          result.push_back(&(**vector)[d]);
    return result;
  }



  template struct BoundaryCondition<2>;
  template struct BoundaryCondition<3>;
} // namespace Viscoplastic
