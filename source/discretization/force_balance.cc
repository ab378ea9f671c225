// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/discretization/force_balance.h>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// Call visit(frame, local index of the first component) for each owned
    /// node with prescribed components.
    template <int dim, typename Visitor>
    void
    for_each_prescribed(const AdmissibleSpace<dim> &space, const Visitor &visit)
    {
      for (const auto &node : space.boundary_nodes())
        {
          const NodalFrame<dim> &frame = space.frame(node.frame);
          if (frame.n_fixed > 0)
            visit(frame, space.owned.index_within_set(node.first_dof));
        }
    }



    /// Return the constraint forces in the prescribed components of the node
    /// whose first component has the local index @p first; padded by zeros.
    template <int dim>
    Tensor<1, dim>
    constraint_force(const Forces<dim>     &forces,
                     const NodalFrame<dim> &frame,
                     const std::size_t      first)
    {
      Tensor<1, dim> force;
      for (unsigned int i = 0; i < frame.n_fixed; ++i)
        {
          const std::size_t dof = first + frame.fixed[i];
          force[i] =
            forces.internal.begin()[dof] - forces.load.values.begin()[dof];
        }
      return force;
    }
  } // namespace



  template <int dim>
  Forces<dim>
  evaluate_forces(const StressSpace<dim>  &stress_space,
                  const DistributedMatrix &matrix,
                  Load<dim>                load,
                  const State<dim>        &state,
                  DistributedVector        irreversible)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    Forces<dim>                 forces;
    forces.load = std::move(load);
    forces.u = forces.internal = space.owned_vector();
    space.to_frames(state.u, forces.u);
    matrix.vmult(forces.internal, forces.u);
    forces.strain_energy = 0.5 * (forces.u * forces.internal);
    if (space.scene.has_irreversible_stress()) // collective
      {
        forces.irreversible      = irreversible.size() > 0 ?
                                     std::move(irreversible) :
                                     irreversible_forces(stress_space, state.z);
        forces.irreversible_work = forces.u * forces.irreversible;
        forces.internal += forces.irreversible;
        double square = 0.;
        for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
          {
            const auto *z = &state.z[c * stress_space.n_samples];
            square += stress_space.complementary_square(c, z);
          }
        forces.irreversible_energy =
          0.5 * Utilities::MPI::sum(square, space.communicator);
      }
    return forces;
  }



  template <int dim>
  EnergyRounding
  energy_rounding(const AdmissibleSpace<dim> &space,
                  const DistributedMatrix    &matrix,
                  const Forces<dim>          &forces)
  {
    const auto          square = [](const double x) { return x * x; };
    const bool          has_z  = forces.irreversible.size() > 0;
    std::vector<double> sums(2, 0.);
    for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
      {
        const double stiffness = matrix.diagonal(i);
        if (!(stiffness > 0.))
          continue;
        const double z = has_z ? forces.irreversible.begin()[i] : 0.;
        sums[0] += stiffness * square(forces.u.begin()[i]);
        if (!space.excluded()[i])
          sums[0] +=
            (square(forces.load.values.begin()[i]) + square(z)) / stiffness;
        sums[1] += square(forces.internal.begin()[i] - z) / stiffness;
      }
    Utilities::MPI::sum(sums, space.communicator, sums);
    const double size =
      100. * std::numeric_limits<double>::epsilon() * std::sqrt(sums[0]);
    return {size, std::sqrt(sums[1]) <= size};
  }



  template <int dim>
  std::map<types::boundary_id, Tensor<1, dim>>
  reactions(const AdmissibleSpace<dim> &space, const Forces<dim> &forces)
  {
    std::map<types::boundary_id, Tensor<1, dim>> result;
    for (const auto &pair : space.scene.boundary)
      if (pair.second.constrains())
        result[pair.first]; // the same entries on all ranks
    for (const Support<dim> &support : space.scene.supports)
      result[support.condition.id];
    // A constraint force acts along the direction that it prescribes. These may
    // be oblique, so the force is decomposed, not projected.
    for_each_prescribed(
      space, [&](const NodalFrame<dim> &frame, const std::size_t first) {
        const Tensor<1, dim> part = transpose(invert(condition_matrix(frame))) *
                                    constraint_force(forces, frame, first);
        for (unsigned int i = 0; i < frame.n_fixed; ++i)
          result[frame.condition_boundary[i]] +=
            part[i] * frame.condition_direction[i];
      });
    for (auto &pair : result)
      pair.second = Utilities::MPI::sum(pair.second, space.communicator);
    return result;
  }



  template <int dim>
  double
  axial_force(const AdmissibleSpace<dim> &space, const Forces<dim> &forces)
  {
    const auto axial = space.owned_axial();
    return Utilities::MPI::sum(axial ? forces.internal.begin()[*axial] *
                                         space.axial_length :
                                       0.,
                               space.communicator);
  }



  template <int dim>
  double
  external_work(const AdmissibleSpace<dim> &space,
                const Forces<dim>          &old_forces,
                const Forces<dim>          &forces)
  {
    DistributedVector change = forces.u;
    change -= old_forces.u;
    // Loads everywhere; at prescribed components the reaction adds what is
    // missing to the internal force.
    double work =
      0.5 * (change * old_forces.load.values + change * forces.load.values);
    double reaction_work = 0.;
    for_each_prescribed(
      space, [&](const NodalFrame<dim> &frame, const std::size_t first) {
        const Tensor<1, dim> mean =
          0.5 * (constraint_force(old_forces, frame, first) +
                 constraint_force(forces, frame, first));
        for (unsigned int i = 0; i < frame.n_fixed; ++i)
          reaction_work += mean[i] * change.begin()[first + frame.fixed[i]];
      });
    if (const auto axial = space.owned_axial();
        axial && space.scene.axial_strain)
      for (const Forces<dim> *at : {&old_forces, &forces})
        reaction_work +=
          0.5 *
          (at->internal.begin()[*axial] - at->load.values.begin()[*axial]) *
          change.begin()[*axial];
    return work + Utilities::MPI::sum(reaction_work, space.communicator);
  }



  template <int dim>
  FrictionIdentities
  check_friction(const ContactFace<dim>  &face,
                 const ContactState      &old_state,
                 const ContactState      &state,
                 const DistributedVector &change,
                 const double             max_displacement)
  {
    FrictionIdentities              result;
    const std::vector<Tensor<1, 2>> slips =
      face.slips(change, state.foundation_step);
    for (unsigned int p = 0; p < slips.size(); ++p)
      result.foundation_work -=
        0.5 * (old_state.multiplier[p] + state.multiplier[p]) *
        state.foundation_step[p];
    for (const unsigned int p : face.layout().friction_points())
      {
        const auto obstacles =
          face.layout().obstacles(face.layout().points[p].node);
        bool is_open = !obstacles.empty();
        for (const unsigned int o : obstacles)
          is_open &= state.multiplier[o][0] == 0.;
        // Without contact there is neither stick nor slip.
        if (is_open && state.bound[p] == 0.)
          continue;
        const double size   = stable_norm(slips[p]);
        const double weight = face.weights()[p];
        const double force  = stable_norm(state.multiplier[p]);
        if (state.bound[p] > 0.)
          result.max_utilization =
            std::max(result.max_utilization, force / state.bound[p]);
        if (state.sticks[p])
          {
            result.stick_area += weight;
            result.max_stick_slip = std::max(result.max_stick_slip, size);
          }
        else
          {
            result.slip_area += weight;
            result.max_slip = std::max(result.max_slip, size);
            // The direction of a smaller slip is rounding.
            if (state.bound[p] > 0. && size > 1e-7 * max_displacement)
              result.slip_misalignment =
                std::max(result.slip_misalignment,
                         stable_norm(state.multiplier[p] -
                                     slips[p] * (state.bound[p] / size)) /
                           state.bound[p]);
            result.dissipation += state.multiplier[p] * slips[p];
          }
      }
    const MPI_Comm communicator = face.layout().communicator;
    for (double *const sum : {&result.foundation_work,
                              &result.stick_area,
                              &result.slip_area,
                              &result.dissipation})
      *sum = Utilities::MPI::sum(*sum, communicator);
    for (double *const maximum : {&result.max_utilization,
                                  &result.max_stick_slip,
                                  &result.slip_misalignment,
                                  &result.max_slip})
      *maximum = Utilities::MPI::max(*maximum, communicator);
    return result;
  }



  template <int dim>
  NormalContact<dim>
  summarize_contact(const ContactFace<dim>  &face,
                    const ContactState      &old_state,
                    const ContactState      &state,
                    const DistributedVector &change)
  {
    NormalContact<dim>              result;
    const ContactLayout            &layout  = face.layout();
    const std::vector<Tensor<1, 2>> motions = face.slips(change, {});
    for (const unsigned int p : layout.obstacles())
      {
        const double force = state.multiplier[p][0], weight = face.weights()[p];
        result.area += weight;
        if (force > 0.)
          result.contact_area += weight;
        if (const NormalCompliance &compliance = layout.points[p].compliance;
            !compliance.is_rigid())
          {
            const double w         = state.penetration(p);
            result.max_penetration = std::max(result.max_penetration, w);
            result.foundation_work +=
              compliance.energy(w) -
              compliance.energy(old_state.penetration(p));
          }
        if (weight > 0.)
          result.max_pressure = std::max(result.max_pressure, force / weight);
        result.max_gap = std::max(result.max_gap, -state.penetration(p));
        result.foundation_work -=
          0.5 * (old_state.multiplier[p][0] + force) * motions[p][0];
      }
    for (double *const sum :
         {&result.area, &result.contact_area, &result.foundation_work})
      *sum = layout.sum(*sum);
    for (double *const maximum :
         {&result.max_pressure, &result.max_gap, &result.max_penetration})
      *maximum = Utilities::MPI::max(*maximum, layout.communicator);
    result.force = face.resultant(state, /* of_obstacles = */ true);
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(evaluate_forces);
  VISCOPLASTIC_INSTANTIATE(energy_rounding);
  VISCOPLASTIC_INSTANTIATE(reactions);
  VISCOPLASTIC_INSTANTIATE(axial_force);
  VISCOPLASTIC_INSTANTIATE(external_work);
  VISCOPLASTIC_INSTANTIATE(summarize_contact);
  VISCOPLASTIC_INSTANTIATE(check_friction);
} // namespace Viscoplastic
