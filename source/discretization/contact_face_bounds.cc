// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/discretization/contact_face.h>

#include <algorithm>
#include <cmath>
#include <limits>

// Friction bounds at the points of the face, and distances to obstacles.

namespace Viscoplastic
{
  template <int dim>
  double
  ContactFace<dim>::initial_distance(const Node           &node,
                                     const Tensor<1, dim> &normal) const
  {
    const auto       &coupling = space.coupling_at(node.first_dof);
    const Point<dim> &opposite = coupling.opposite;
    const double      distance =
      (opposite - node.position) * normal + coupling.bulge;
    // Rounding of coordinates is no distance between bodies that touch.
    return std::abs(distance) >
               1e-12 * (opposite.norm() + node.position.norm()) ?
             distance :
             0.;
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::bounds(const double               t,
                           const std::vector<double> &slip_rates) const
  {
    if (constant_bounds)
      return *constant_bounds;
    // rho_c = int rho phi_c, with which j_n(v) = sum_c rho_c |v_c|.
    std::vector<double> result = sum_shares(
      [t](const Sample &sample) {
        return sample.condition->bound(sample.x, t);
      },
      /* of_obstacles = */ false,
      &slip_rates);
    // Gaps are values at the nodes. Where basis functions are not symmetric,
    // means over them would differ from linear gaps at the nodes, so that
    // linear displacements would not be exact.
    for (const unsigned int o : layout().obstacles())
      {
        result[o] = std::numeric_limits<double>::max();
        for (const types::boundary_id id : boundary_ids[o])
          {
            const Node &node      = nodes[layout().points[o].node];
            const auto &condition = space.scene.boundary.at(id);
            double      gap       = condition.gap(node.position, t);
            if (condition.against)
              gap +=
                initial_distance(node,
                                 space.normal_at(node.first_dof, condition));
            result[o] = std::min(result[o], gap);
          }
      }
    if (!bounds_vary && !any_rate)
      constant_bounds = result;
    return result;
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::step_bounds(const double               t,
                                const DistributedVector   &u,
                                const std::vector<double> &slip_rates) const
  {
    std::vector<double> result = bounds(t, slip_rates);
    if (!any_obstacles)
      return result;
    const ContactLayout &face = layout();
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      {
        const std::size_t first =
          space.owned.index_within_set(nodes[n].first_dof);
        for (const unsigned int o : face.obstacles(n))
          {
            const Obstacle<dim> &obstacle =
              space.frame_at(nodes[n].first_dof)
                .obstacles[o - face.first_obstacle(n)];
            for (unsigned int d = 0; d < dim; ++d)
              result[o] -=
                (obstacle.map[d] + obstacle.fixed[d]) * u.begin()[first + d];
          }
      }
    return result;
  }



  template <int dim>
  void
  ContactFace<dim>::set_obstacles(const double             t,
                                  const DistributedVector &u,
                                  ContactState            &state) const
  {
    const std::vector<double> distances = step_bounds(t, u);
    for (const unsigned int o : layout().obstacles())
      {
        state.bound[o] = distances[o];
        state.slip[o]  = Tensor<1, 2>();
      }
    for (const unsigned int o : layout().compliant(layout().obstacles()))
      {
        state.multiplier[o] = state.multiplier_of_slip(layout().points[o], o);
        state.sticks[o]     = state.penetration(o) > 0.;
      }
  }



  template <int dim>
  typename ContactFace<dim>::MissedBounds
  ContactFace<dim>::missed_bounds(const State<dim> &state) const
  {
    const std::vector<double> rates =
      slip_rates(state.velocity, state.t - state.k, state.t);
    std::vector<double> of_step = bounds(state.t, rates);
    add_computed_bounds(state.t, state.contact, of_step, rates);
    std::vector<double> sums(3, 0.);
    for (const unsigned int p : layout().friction_points())
      {
        const double missed = std::abs(of_step[p] - state.contact.bound[p]);
        sums[0] += of_step[p];
        sums[1] += missed;
        sums[2] += missed * state.contact.slip[p].norm();
      }
    Utilities::MPI::sum(sums, space.communicator, sums);
    return {sums[0], sums[1], sums[2]};
  }



  template <int dim>
  bool
  ContactFace<dim>::closes_between_nodes(const double             t,
                                         const DistributedVector &u) const
  {
    if (!any_obstacles || !numbers)
      return false;
    // The remaining gap between nodes is the gap at the sample minus the
    // interpolated normal displacement, `gaps` - `left`.
    LinearAlgebra::distributed::Vector<double> gaps(numbers), left(numbers);
    const std::vector<double>                  gap_at_nodes = bounds(t),
                              left_at_nodes                 = step_bounds(t, u);
    std::copy(gap_at_nodes.begin(), gap_at_nodes.end(), gaps.begin());
    std::copy(left_at_nodes.begin(), left_at_nodes.end(), left.begin());
    gaps.update_ghost_values();
    left.update_ghost_values();
    std::vector<double> sums(samples.size(), 0.), weights(samples.size(), 0.);
    for (const Share &share : shares)
      if (share.of_obstacle)
        {
          weights[share.sample] += share.value;
          sums[share.sample] += share.value * (left.local_element(share.point) -
                                               gaps.local_element(share.point));
        }
    bool here = false;
    for (std::size_t s = 0; s < samples.size(); ++s)
      if (weights[s] > 0. && !samples[s].condition->against)
        here |=
          samples[s].condition->gap(samples[s].x, t) + sums[s] / weights[s] <
          0.;
    return layout().any(here);
  }



  template <int dim>
  void
  ContactFace<dim>::add_computed_bounds(
    const double               t,
    const ContactState        &state,
    std::vector<double>       &bounds,
    const std::vector<double> &slip_rates) const
  {
    if (!any_computed_pressure)
      return;
    // Each boundary's friction follows the pressure of its own obstacle.
    const ContactLayout &face = layout();
    for (const auto &pair : space.scene.boundary)
      {
        const types::boundary_id      id        = pair.first;
        const BoundaryCondition<dim> &condition = pair.second;
        if (!condition.has_computed_pressure())
          continue;
        const std::vector<double> coefficients = sum_shares(
          [&](const Sample &sample) {
            return sample.condition == &condition ?
                     condition.friction_coefficient(sample.x, t) :
                     0.;
          },
          /* of_obstacles = */ false,
          &slip_rates);
        if (state.n_points() != bounds.size())
          continue;
        for (unsigned int p = 0; p < bounds.size(); ++p)
          if (coefficients[p] > 0.)
            // There is no obstacle where other conditions hold the normal.
            for (const unsigned int o : face.obstacles(face.points[p].node))
              if (const auto &ids = boundary_ids[o];
                  state.multiplier[o][0] > 0. &&
                  std::find(ids.begin(), ids.end(), id) != ids.end())
                bounds[p] +=
                  coefficients[p] / point_weights[o] * state.multiplier[o][0];
      }
  }



  template <int dim>
  std::vector<std::vector<double>>
  ContactFace<dim>::bounds_of_pressure(
    const double               t,
    const std::vector<double> &slip_rates) const
  {
    // Bounds are linear in the pressures, so their coefficients are the bounds
    // for a unit force at one obstacle per node at a time.
    const ContactLayout             &face = layout();
    std::vector<std::vector<double>> result(face.points.size());
    unsigned int                     n_obstacles = 0;
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      n_obstacles =
        std::max<unsigned int>(n_obstacles, face.obstacles(node).size());
    n_obstacles = Utilities::MPI::max(n_obstacles, face.communicator);
    for (unsigned int k = 0; k < n_obstacles; ++k)
      {
        ContactState state(std::vector<double>(result.size()));
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          if (k < face.obstacles(node).size())
            state.multiplier[face.first_obstacle(node) + k][0] = 1.;
        std::vector<double> of_pressure(result.size());
        add_computed_bounds(t, state, of_pressure, slip_rates);
        for (unsigned int p = 0; p < result.size(); ++p)
          if (k < face.obstacles(face.points[p].node).size())
            result[p].push_back(of_pressure[p]);
      }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, bounds);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, step_bounds);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, set_obstacles);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, missed_bounds);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, closes_between_nodes);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, add_computed_bounds);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, bounds_of_pressure);
} // namespace Viscoplastic
