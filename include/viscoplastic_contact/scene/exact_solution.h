// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/symmetric_tensor.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/parameters/parameters.h>
#include <viscoplastic_contact/scene/material.h>

#include <optional>

namespace Viscoplastic
{
  /// A known solution (u, sigma) of a scene, to measure errors and, if it makes
  /// data, to define the manufactured problem that it solves,
  ///
  ///     b = -Div sigma,   F = sigma nu,   S = sigma_nu,   u0, sigma0,
  ///     s = sigma' - E eps(u') - G(t, sigma, eps(u)),
  ///
  /// with the source s added to G, which may depend on x and t. Friction bounds
  /// remain data of the scene, since a sticking body does not determine them.
  ///
  /// Derivatives are differences of second order with steps of 1e-4 of the size
  /// of the body and of the end time, accurate to about 1e-8.
  template <int dim>
  class ExactSolution
  {
  public:
    /// @p end_time is T. Throws ExcMessage with a sentence for the user.
    ExactSolution(const ExactSolutionParameters &parameters,
                  const double                   end_time,
                  const PlaneModel plane_model = PlaneModel::strain);

    /// Whether the data of the problem follow from the solution.
    const bool makes_data;

    /// Whether `Stress' is given; a solution that makes data then has a source.
    bool
    has_own_stress() const
    {
      return given_stress.has_value();
    }

    /// Set the size of the body, the scale of difference steps. If `Stress' is
    /// not given and @p elastic is not null, the stress is E eps(u) of this
    /// material. Throws ExcMessage if data need a stress and there is none.
    void
    set_body(const double size, const Material<dim> *elastic);

    bool
    has_stress() const
    {
      return has_own_stress() || material != nullptr;
    }

    Tensor<1, dim>
    displacement(const Point<dim> &x, const double t) const
    {
      return given_displacement->vector(x, t);
    }

    /// grad u, with the derivatives of component i in row i.
    Tensor<2, dim>
    gradient(const Point<dim> &x, const double t) const;

    SymmetricTensor<2, 3>
    strain(const Point<dim> &x, const double t) const;

    /// eps_zz of the section in generalized plane strain, the entry after the
    /// components of the displacement; 0 in other models.
    double
    axial_strain(const double t) const
    {
      return is_generalized() ?
               given_displacement->value(Point<dim>(), t, dim) :
               0.;
    }

    SymmetricTensor<2, 3>
    stress(const Point<dim> &x, const double t) const;

    /// sigma nu.
    Tensor<1, dim>
    traction(const Point<dim>     &x,
             const Tensor<1, dim> &normal,
             const double          t) const
    {
      const SymmetricTensor<2, 3> sigma = stress(x, t);
      Tensor<1, dim>              result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i] += sigma[i][j] * normal[j];
      return result;
    }

    /// -Div sigma.
    Tensor<1, dim>
    body_force(const Point<dim> &x, const double t) const;

    /// The side of t from which a time derivative is taken: that of the step
    /// beginning at t (after) or of the step ending at t (before).
    enum class Side
    {
      after,
      before
    };

    Tensor<1, dim>
    velocity(const Point<dim> &x, const double t, const Side side) const
    {
      return rate(t, side, [&](const double s) { return displacement(x, s); });
    }

    SymmetricTensor<2, 3>
    strain_rate(const Point<dim> &x, const double t, const Side side) const
    {
      return rate(t, side, [&](const double s) { return strain(x, s); });
    }

    SymmetricTensor<2, 3>
    stress_rate(const Point<dim> &x, const double t, const Side side) const
    {
      return rate(t, side, [&](const double s) { return stress(x, s); });
    }

    /// Throws ExcMessage if rates in time are unbounded at (x, t).
    void
    check_rates(const Point<dim> &x, const double t) const;

  private:
    /// The one-sided derivative of a function at t by differences of second
    /// order.
    template <typename Function>
    auto
    rate(const double t, const Side side, const Function &f) const
    {
      const double h = side == Side::after ? time_step : -time_step;
      return (4. * f(t + h) - f(t + 2. * h) - 3. * f(t)) / (2. * h);
    }

    bool
    is_generalized() const
    {
      return dim == 2 && plane_model == PlaneModel::generalized_strain;
    }

    std::optional<VectorExpression<dim>> given_displacement, given_stress;
    const Material<dim>                 *material = nullptr;
    const PlaneModel                     plane_model;
    double                               space_step, time_step;
  };
} // namespace Viscoplastic
