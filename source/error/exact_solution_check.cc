// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/error/solution_errors.h>

#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// The largest values met so far, to which tolerances are relative.
    struct Scales
    {
      double displacement = 0., velocity = 0., stress = 0.;
    };



    /// The tangential velocity of the exact solution minus the foundation's.
    template <int dim>
    Tensor<1, dim>
    slip_rate(const BoundaryCondition<dim> &condition,
              const ExactSolution<dim>     &solution,
              const Point<dim>             &x,
              const double                  t,
              const double                  k)
    {
      using Side = typename ExactSolution<dim>::Side;
      Tensor<1, dim> rate =
        tangential(solution.velocity(x, t, Side::after), condition.normal);
      if (condition.foundation_motion)
        {
          const double h = 1e-4 * k;
          rate -= (condition.sliding(x, t + h) - condition.sliding(x, t)) / h;
        }
      return rate;
    }



    /// Describe what the solution violates at a point of a boundary piece;
    /// empty if nothing.
    template <int dim>
    std::string
    violation(const BoundaryCondition<dim> &condition,
              const ExactSolution<dim>     &solution,
              const Point<dim>             &x,
              const double                  t,
              const double                  k,
              Scales                       &scales)
    {
      // Difference quotients are accurate to 1e-8 of the scales.
      constexpr double     small = 1e-6;
      const Tensor<1, dim> u     = solution.displacement(x, t);
      scales.displacement        = std::max(scales.displacement, u.norm());
      const auto prescribes      = [&](const Tensor<1, dim> &given) {
        return (u - given).norm() > small * scales.displacement;
      };
      std::ostringstream text;
      if (condition.role == BoundaryRole::clamped)
        {
          if (prescribes({}))
            text << "is clamped, but the displacement is " << u;
          return text.str();
        }
      if (condition.is_glued())
        {
          const Tensor<1, dim> given =
            condition.glued_displacement(x, condition.normal, t);
          if (prescribes(given))
            text << "prescribes the displacement " << given << ", not " << u;
          return text.str();
        }
      if (condition.role != BoundaryRole::contact &&
          condition.role != BoundaryRole::symmetry)
        return "";

      const Tensor<1, dim> &normal = condition.normal;
      const double          given_normal =
        condition.foundation_displacement ?
                   condition.foundation_displacement->value(x, t) :
                   0.;
      if (condition.is_bilateral() &&
          std::abs(u * normal - given_normal) > small * scales.displacement)
        {
          text << "prescribes the normal displacement " << given_normal
               << ", not " << u * normal;
          return text.str();
        }

      const Tensor<1, dim> force =
        tangential(solution.traction(x, normal, t), normal);
      scales.stress          = std::max(scales.stress, force.norm());
      const double tolerance = small * scales.stress;
      if (!condition.has_friction())
        {
          if (force.norm() > tolerance)
            text << "has no friction, but the tangential stress is " << force;
          return text.str();
        }
      const double         bound = condition.bound(x, t);
      const Tensor<1, dim> slip  = slip_rate(condition, solution, x, t, k);
      scales.velocity            = std::max(scales.velocity, slip.norm());
      if (force.norm() > bound + tolerance)
        text << "has the friction bound " << bound
             << ", but the tangential stress is " << force;
      // The direction of very small slip is lost in difference quotients.
      else if (slip.norm() > 1e-4 * scales.velocity &&
               (force + bound * slip / slip.norm()).norm() >
                 1e-3 * bound + tolerance)
        text << "has the friction bound " << bound
             << " and the body slips with the velocity " << slip
             << ", but the tangential stress " << force
             << " does not oppose it with that bound";
      return text.str();
    }
  } // namespace



  template <int dim>
  void
  check_exact_solution(const AdmissibleSpace<dim> &space)
  {
    const Scene<dim>         &scene    = space.scene;
    const ExactSolution<dim> &solution = *scene.exact_solution;
    const unsigned int        n_steps  = scene.schedule.n_steps();
    const unsigned int        stride   = (n_steps + 19) / 20;
    FEFaceValues<dim>         face_values(space.dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_quadrature_points);
    Scales                    scales;
    for (const auto &cell : space.cells)
      {
        solution.check_rates(cell->center(), 0.);
        for (const unsigned int f : cell->face_indices())
          {
            if (!cell->face(f)->at_boundary())
              continue;
            const auto &condition =
              scene.boundary.at(cell->face(f)->boundary_id());
            face_values.reinit(cell, f);
            for (unsigned int n = 1; n <= n_steps; n += stride)
              for (const auto &x : face_values.get_quadrature_points())
                {
                  const TimeStep    step = scene.schedule.step(n);
                  const std::string text = violation(
                    condition, solution, x, step.t_old, step.k, scales);
                  if (!text.empty())
                    refuse("The exact solution contradicts 'Boundary " +
                           as_text(condition.id) + "' at x = (" + as_text(x) +
                           "), t = " + as_text(step.t_old) + ": the boundary " +
                           text + '.');
                }
          }
      }
  }



  VISCOPLASTIC_INSTANTIATE(check_exact_solution);
} // namespace Viscoplastic
