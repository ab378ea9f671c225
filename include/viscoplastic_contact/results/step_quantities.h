// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/energy.h>
#include <viscoplastic_contact/results/energy_balance.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <map>

namespace Viscoplastic
{
  /// Quantities of a step that are computed from its fields for a row of
  /// statistics.csv.
  template <int dim>
  struct StepQuantities
  {
    StressSummary<dim> stress;
    FlowEnergies       flow;
    /// The energy stored at the end of the step, and its part in springs.
    double stored_energy = 0., spring_energy = 0.;
    /// The work of loads, prescribed displacements and moving foundations in
    /// the step.
    double external_work = 0.;
    /// Defects of the friction law, and the resulting friction force on the
    /// body; zero without friction.
    FrictionIdentities friction;
    Tensor<1, dim>     friction_force;
    /// Forces and areas of unilateral contact and normal compliance; zero
    /// without these.
    NormalContact<dim> contact;
    /// ContactFace::forces_by_boundary().
    std::map<types::boundary_id, typename ContactFace<dim>::BoundaryForces>
      contact_forces;
    /// The reaction on each boundary and support with prescribed displacements
    /// or springs.
    std::map<types::boundary_id, Tensor<1, dim>> reactions;
    /// The sum of loads, reactions, friction and contact on the body, which
    /// should be zero, and the largest of them.
    Tensor<1, dim> sum_of_forces;
    double         largest_force = 0.;
    /// Set if the sum exceeds 1e-9 of the largest force: a scale that includes
    /// nodal forces of the body that cancel, and rounding; the sum of absolute
    /// nodal loads; the possible effect of rounding of displacements on the
    /// sum.
    double force_scale = 0., load_size = 0., rounding_of_forces = 0.;
    /// The largest length of a displacement, and the position of its node.
    double     max_displacement = 0.;
    Point<dim> displacement_position;
    /// eps_zz and N in generalized plane strain.
    double axial_strain = 0., axial_force = 0.;
    /// The area on which bilateral contact is in tension.
    double tension_area = 0.;
    /// InterfaceSlide::largest(); zero without contact between bodies.
    double slide = 0.;
    /// The error of friction bounds that lag by a step.
    typename ContactFace<dim>::MissedBounds friction_bounds;
    /// The estimate by which an adaptive mesh is refined; zero before the first
    /// estimate.
    double                      refinement_estimate = 0.;
    std::vector<Tensor<1, dim>> point_displacements;
    /// The values of `Output/Point fields' and `Output/Integrals'.
    std::vector<double> point_fields, integrals;
  };



  /// Compute the quantities of a step from @p old, without values at points and
  /// integrals. Collective.
  template <int dim>
  StepQuantities<dim>
  measure_step(const Discretization<dim> &discretization,
               const EvaluatedState<dim> &old,
               const AcceptedStep<dim>   &step);

  /// Return the energies of a state on its mesh. Collective.
  template <int dim>
  EnergiesOnMesh
  energies_on_mesh(const Discretization<dim> &discretization,
                   const EvaluatedState<dim> &of);
} // namespace Viscoplastic
