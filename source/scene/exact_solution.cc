// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/plane_model.h>
#include <viscoplastic_contact/scene/exact_solution.h>

namespace Viscoplastic
{
  namespace
  {
    // Truncation and rounding errors of second derivatives are then both 1e-8.
    constexpr double relative_step = 1e-4;
  } // namespace



  template <int dim>
  ExactSolution<dim>::ExactSolution(const ExactSolutionParameters &parameters,
                                    const double                   end_time,
                                    const PlaneModel               plane_model)
    : makes_data(parameters.data == DataSource::solution)
    , plane_model(plane_model)
    , space_step(relative_step)
    , time_step(relative_step * end_time)
  {
    if (Utilities::trim(parameters.displacement).empty())
      refuse("'Exact solution/Displacement' is missing, but other entries of "
             "that section are given.");
    given_displacement.emplace(parameters.displacement,
                               dim + (is_generalized() ? 1 : 0),
                               "Exact solution/Displacement");
    if (is_generalized() && (*given_displacement)[dim].depends_on_position())
      refuse("The last component of 'Exact solution/Displacement', eps_zz, "
             "depends on the place, but it is one for the whole section.");
    if (!Utilities::trim(parameters.stress).empty())
      given_stress.emplace(parameters.stress,
                           stress_components<dim>().size(),
                           "Exact solution/Stress");
  }



  template <int dim>
  void
  ExactSolution<dim>::set_body(const double size, const Material<dim> *elastic)
  {
    space_step = relative_step * size;
    material   = has_own_stress() ? nullptr : elastic;
    if (makes_data && !has_stress())
      refuse(
        "'Exact solution/Stress' is missing; only for a body of one elastic "
        "material without thermal expansion it follows from the displacement.");
  }



  template <int dim>
  Tensor<2, dim>
  ExactSolution<dim>::gradient(const Point<dim> &x, const double t) const
  {
    Tensor<2, dim> result;
    for (unsigned int j = 0; j < dim; ++j)
      {
        Point<dim> left(x), right(x);
        left[j] -= space_step;
        right[j] += space_step;
        const Tensor<1, dim> derivative =
          (displacement(right, t) - displacement(left, t)) /
          (right[j] - left[j]);
        for (unsigned int i = 0; i < dim; ++i)
          result[i][j] = derivative[i];
      }
    return result;
  }



  template <int dim>
  SymmetricTensor<2, 3>
  ExactSolution<dim>::strain(const Point<dim> &x, const double t) const
  {
    return Viscoplastic::strain(
      displacement(x, t), gradient(x, t), x, plane_model, axial_strain(t));
  }



  template <int dim>
  SymmetricTensor<2, 3>
  ExactSolution<dim>::stress(const Point<dim> &x, const double t) const
  {
    Assert(has_stress(), ExcInternalError());
    if (!has_own_stress())
      return material->stiffness(x).stress(strain(x, t));
    SymmetricTensor<2, 3> result;
    const auto            components = stress_components<dim>();
    for (unsigned int c = 0; c < components.size(); ++c)
      result[components[c].first][components[c].second] =
        given_stress->value(x, t, c);
    return result;
  }



  template <int dim>
  Tensor<1, dim>
  ExactSolution<dim>::body_force(const Point<dim> &x, const double t) const
  {
    Tensor<1, dim> result;
    for (unsigned int j = 0; j < dim; ++j)
      {
        Point<dim> left(x), right(x);
        left[j] -= space_step;
        right[j] += space_step;
        const SymmetricTensor<2, 3> change = stress(right, t) - stress(left, t);
        for (unsigned int i = 0; i < dim; ++i)
          result[i] -= change[i][j] / (right[j] - left[j]);
      }
    if (plane_model == PlaneModel::axisymmetric)
      {
        // The rest of the divergence in cylindrical coordinates (2: theta).
        const double                r     = std::max(x[0], space_step);
        const SymmetricTensor<2, 3> sigma = stress(x, t);
        result[0] -= (sigma[0][0] - sigma[2][2]) / r;
        result[1] -= sigma[0][1] / r;
      }
    return result;
  }



  template <int dim>
  void
  ExactSolution<dim>::check_rates(const Point<dim> &x, const double t) const
  {
    const auto refuse_growth = [&](const std::string &name, const auto &f) {
      // Difference quotients converge for smooth functions, but grow with
      // smaller steps at a vertical tangent, as that of sqrt(t).
      const auto difference = [&](const double step) {
        return ((f(t + step) - f(t)) / step).norm();
      };
      const double coarse = difference(16. * time_step),
                   fine   = difference(time_step);
      // By a factor of 4 for t^0.5; by 16^0.1 = 1.3 for t^0.9.
      if (fine > 1.3 * coarse && difference(time_step / 16.) > 1.3 * fine)
        refuse("'Exact solution/" + name + "' has no time derivative at x = (" +
               as_text(x) + "), t = " + as_text(t) +
               ": its differences over shorter and shorter times grow without "
               "bound.");
    };
    refuse_growth("Displacement",
                  [&](const double s) { return displacement(x, s); });
    if (has_own_stress())
      refuse_growth("Stress", [&](const double s) { return stress(x, s); });
  }



  template class ExactSolution<2>;
  template class ExactSolution<3>;
} // namespace Viscoplastic
