// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/scene/boundary_condition.h>

// Values of the data of a boundary condition.

namespace Viscoplastic
{
  namespace
  {
    /// The value at x (a slip rate if dim is 1). Throws where it is negative.
    template <int dim>
    double
    not_negative(const Expression<dim>       &datum,
                 const Point<dim>            &x,
                 const std::optional<double> &t = {})
    {
      const double value = datum.value(x, t.value_or(0.));
      if (!(value >= 0.))
        refuse("'" + datum.name_of_entry() + "' is " + as_text(value) + " at " +
               (dim == 1 ? "v = " + as_text(x) : "x = (" + as_text(x) + ")") +
               (t ? ", t = " + as_text(*t) : "") +
               "; it must not be negative.");
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
      if (friction_law->entries[i].of_pressure == of_pressure)
        sum += not_negative(friction_data[i], x, t);
    return sum;
  }



  template <int dim>
  double
  BoundaryCondition<dim>::bound_factor(const double slip_rate) const
  {
    return slip_rate_factor ?
             not_negative(*slip_rate_factor, Point<1>(slip_rate)) :
             1.;
  }



  template <int dim>
  double
  BoundaryCondition<dim>::compliance(const Point<dim> &x) const
  {
    return not_negative(*given_compliance, x);
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
    const double k_n =
                   normal_stiffness ? not_negative(*normal_stiffness, x) : 0.,
                 k_t = tangential_stiffness ?
                         not_negative(*tangential_stiffness, x) :
                         0.;
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
