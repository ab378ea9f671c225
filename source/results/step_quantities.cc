// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/largest_place.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/results/step_quantities.h>

namespace Viscoplastic
{
  namespace
  {
    /// Return the largest nodal displacement; @p u is Cartesian, with ghosts.
    template <int dim>
    LargestPlace<dim>
    largest_displacement(const StressSpace<dim>  &stress_space,
                         const DistributedVector &u)
    {
      const AdmissibleSpace<dim> &space = stress_space.space;
      LargestPlace<dim>           result;
      double                      square = 0.; // slightly below the largest
      for (std::size_t c = 0; c < space.cells.size(); ++c)
        {
          const auto &cell = space.cells[c];
          if (space.scene.has_stages() &&
              !space.scene.is_present(cell->material_id()))
            continue;
          const unsigned int *const nodes = stress_space.nodes_of_cell(c);
          for (unsigned int v = 0; v < GeometryInfo<dim>::vertices_per_cell;
               ++v)
            {
              Tensor<1, dim> at_node;
              for (unsigned int d = 0; d < dim; ++d)
                at_node[d] = u.begin()[nodes[v] + d];
              if (at_node.norm_square() < square)
                continue;
              const double length = stable_norm(at_node);
              if (result.may_take(length))
                result.add(length, cell->vertex(v));
              square = std::max(square, 0.99 * at_node.norm_square());
            }
        }
      result.reduce(space.communicator);
      return result;
    }



    /// Return the size of rounding errors in a vanishing sum of forces.
    template <int dim>
    double
    force_of_rounding(const Discretization<dim> &d, const DistributedVector &u)
    {
      double sum = 0.;
      for (std::size_t i = 0; i < d.space.owned.n_elements(); ++i)
        sum += d.matrix.diagonal(i) * std::abs(u.begin()[i]);
      return std::numeric_limits<double>::epsilon() *
             Utilities::MPI::sum(sum, d.space.communicator);
    }

    /// Return energies_of_flow(), from forces where these suffice. Collective.
    template <int dim>
    FlowEnergies
    energies_of_step(const Discretization<dim> &d,
                     const EvaluatedState<dim> &old,
                     const EvaluatedState<dim> &end)
    {
      const auto &thermal = d.laws.thermal;
      if (d.laws.any_own_energy ||
          (thermal && thermal->expands && thermal->varies_in_time))
        return energies_of_flow(d.laws, old.state, end.state);
      const Forces<dim> &before = old.forces, &after = end.forces;
      FlowEnergies       result;
      result.irreversible_energy = after.irreversible_energy;
      if (after.irreversible.size() > 0)
        {
          // The driving strain E^-1 sigma is eps(u) + E^-1 z.
          DistributedVector flow(after.irreversible);
          flow -= before.irreversible;
          result.viscous_dissipation = before.irreversible_energy -
                                       after.irreversible_energy -
                                       0.5 * (flow * before.u + flow * after.u);
        }
      return result;
    }



    /// The stored energy, from the integrals of the stress.
    template <int dim>
    double
    stored_energy(const Forces<dim> &forces, const FlowEnergies &flow)
    {
      // 1/2 int E^-1 sigma : sigma with sigma = E eps(u) + z.
      return forces.strain_energy + forces.irreversible_work +
             flow.irreversible_energy;
    }



    /// Return the energy stored in compliant foundations.
    template <int dim>
    double
    energy_of_foundation(const Discretization<dim> &d, const State<dim> &state)
    {
      if (!d.face || !d.face->has_normal_compliance())
        return 0.;
      const ContactLayout &face = d.face->layout();
      double               sum  = 0.;
      for (const unsigned int o : face.obstacles())
        sum += face.points[o].compliance.energy(state.contact.penetration(o));
      return face.sum(sum);
    }



    /// Set the scale of defects of balance. Forces may be negligible beside
    /// nodal forces that cancel, of stresses in equilibrium up to the solver
    /// tolerance. For a body that moves without strain only rounding remains,
    /// which need not add up to zero: it counts as a defect of at most 1e-8.
    /// Called only for large defects, since it needs the whole matrix.
    template <int dim>
    void
    set_force_scale(const Discretization<dim> &d,
                    const EvaluatedState<dim> &end,
                    StepQuantities<dim>       &result)
    {
      const Forces<dim> &forces = end.forces;
      if (const double cancels =
            forces.elastic().l1_norm() + forces.irreversible.l1_norm();
          result.largest_force <= 1e-6 * cancels)
        result.force_scale = cancels;
      DistributedVector moves(forces.u);
      if (d.face)
        d.face->restriction().add(
          1.,
          face_motion(d.face->layout(), end.state.contact.foundation_step),
          moves);
      result.load_size          = forces.load.values.l1_norm();
      result.rounding_of_forces = force_of_rounding(d, moves);
      if (result.largest_force <= result.rounding_of_forces)
        result.force_scale =
          std::max(result.force_scale, 1e8 * result.rounding_of_forces);
    }
  } // namespace



  template <int dim>
  StepQuantities<dim>
  measure_step(const Discretization<dim> &d,
               const EvaluatedState<dim> &old,
               const AcceptedStep<dim>   &step)
  {
    const State<dim>   &state      = step.end.state;
    const Forces<dim>  &forces     = step.end.forces;
    const bool          is_initial = step.time_step.n == 0;
    StepQuantities<dim> result;
    result.stress = summarize_stress(d.stress_space, state);
    result.flow   = energies_of_step(d, old, step.end);
    result.stored_energy =
      stored_energy(forces, result.flow) + energy_of_foundation(d, state);
    DistributedVector        difference;
    const DistributedVector &u =
      reported_displacement(d.scene(), state, difference);
    const LargestPlace<dim> largest = largest_displacement(d.stress_space, u);
    result.axial_strain             = d.space.axial_strain(u.begin());
    if (d.space.axial)
      result.axial_force = axial_force(d.space, forces);
    result.max_displacement      = largest.value();
    result.displacement_position = largest.position();
    if (d.face)
      {
        DistributedVector change = forces.u;
        change -= old.forces.u;
        result.friction       = check_friction(*d.face,
                                         old.state.contact,
                                         state.contact,
                                         change,
                                         result.max_displacement);
        result.friction_force = d.face->resultant(state.contact);
        result.contact_forces = d.face->forces_by_boundary(state.contact);
        if (d.face->has_obstacles())
          result.contact = summarize_contact(*d.face,
                                             old.state.contact,
                                             state.contact,
                                             change);
      }
    if (d.tension)
      result.tension_area = d.tension->tension_area(state);
    if (d.slide)
      result.slide = d.slide->largest(state.u);
    if (!is_initial && d.face && d.face->has_computed_pressure() &&
        d.scene().parameters.solver.coulomb_pressure == CoulombPressure::lagged)
      result.friction_bounds = d.face->missed_bounds(state);

    result.reactions = reactions(d.space, forces);
    if (d.springs)
      {
        const auto [of_springs, energy] = d.springs->summarize(state.u);
        result.spring_energy            = energy;
        for (const auto &[id, force] : of_springs)
          result.reactions[id] += force;
      }
    result.sum_of_forces = forces.load.resultant;
    if (d.face)
      result.sum_of_forces -= d.face->resultant_on_foundations(state.contact);
    result.largest_force = std::max({stable_norm(forces.load.resultant),
                                     stable_norm(result.friction_force),
                                     stable_norm(result.contact.force)});
    for (const auto &[id, force] : result.reactions)
      {
        if (!d.scene().condition(id).against)
          result.sum_of_forces += force;
        result.largest_force =
          std::max(result.largest_force, stable_norm(force));
      }
    // On a ring, hoop stresses balance radial forces.
    if (d.scene().is_axisymmetric())
      result.sum_of_forces[0] = 0.;
    if (stable_norm(result.sum_of_forces) > 1e-9 * result.largest_force)
      set_force_scale(d, step.end, result);
    if (!is_initial)
      result.external_work = external_work(d.space, old.forces, forces) +
                             result.friction.foundation_work +
                             result.contact.foundation_work;
    const Vector<double> &indicators =
      step.end.space_estimate.squared_indicators;
    if (indicators.size() > 0)
      result.refinement_estimate =
        total_estimate(indicators, d.space.dof_handler.get_triangulation());
    return result;
  }



  template <int dim>
  EnergiesOnMesh
  energies_on_mesh(const Discretization<dim> &discretization,
                   const EvaluatedState<dim> &of)
  {
    return {stored_energy(of.forces, energies_of_step(discretization, of, of)) +
              energy_of_foundation(discretization, of.state),
            of.forces.u * of.forces.load.values};
  }



  VISCOPLASTIC_INSTANTIATE(measure_step);
  VISCOPLASTIC_INSTANTIATE(energies_on_mesh);
} // namespace Viscoplastic
