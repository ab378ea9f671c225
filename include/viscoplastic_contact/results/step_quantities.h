// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/energy.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <map>

namespace Viscoplastic
{
  /// What is measured of a step: the numbers of a row of statistics.csv that
  /// need the fields.
  template <int dim>
  struct StepQuantities
  {
    StressSummary stress;
    /// At the end of the step.
    double stored_energy = 0.;
    /// Of loads, prescribed displacements and moving foundations in the step.
    double external_work = 0.;
    /// Zero without friction, as the force.
    FrictionIdentities friction;
    Tensor<1, dim>     friction_force;
    /// On each boundary with prescribed displacements.
    std::map<types::boundary_id, Tensor<1, dim>> reactions;
    /// Loads, reactions and friction on the body, which add up to zero, and the
    /// largest of them, or what rounding makes of them if that is more.
    Tensor<1, dim> sum_of_forces;
    double         largest_force    = 0.;
    double         max_displacement = 0.;
    /// Where bilateral contact pulls at the body.
    double tension_area = 0.;
    /// By which an adaptive mesh is refined; zero before the first estimate.
    double refinement_estimate = 0.;
    /// At the points of `Output/Points'.
    std::vector<Tensor<1, dim>> point_displacements;
  };



  /// Of a step that leads from @p old, but for the displacements of points.
  /// Collective.
  template <int dim>
  StepQuantities<dim>
  measure_step(const Discretization<dim> &discretization,
               const EvaluatedState<dim> &old,
               const AcceptedStep<dim>   &step);

  /// 1/2 int E^-1 sigma : sigma, and what laws store beyond it. Collective.
  template <int dim>
  double
  stored_energy(const Discretization<dim> &discretization,
                const EvaluatedState<dim> &of);
} // namespace Viscoplastic
