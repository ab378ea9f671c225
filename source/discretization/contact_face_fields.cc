// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/discretization/contact_face.h>

// Displacements and multipliers at the points of the face and as nodal fields.

namespace Viscoplastic
{
  template <int dim>
  Tensor<1, dim>
  ContactFace<dim>::cartesian(const unsigned int  point,
                              const Tensor<1, 2> &multiplier) const
  {
    const ContactLayout &face  = layout();
    const Node          &node  = nodes[face.points[point].node];
    const Tensor<1, 3>   force = node_force(face.points[point], multiplier);
    Tensor<1, dim>       in_frame;
    for (unsigned int i = 0; i < face.n_node_dofs(face.points[point].node); ++i)
      in_frame[node.components[i]] = force[i];
    return node.directions * in_frame;
  }



  template <int dim>
  std::map<types::boundary_id, typename ContactFace<dim>::BoundaryForces>
  ContactFace<dim>::forces_by_boundary(const ContactState &state) const
  {
    std::map<types::boundary_id, BoundaryForces> result;
    for (const auto &[id, part] : area_shares)
      {
        const auto sum = [&, &part = part](const bool of_obstacles) {
          Tensor<1, dim> here;
          for (const unsigned int p : layout().points_of_kind(of_obstacles))
            if (part[p] != 0.)
              here += part[p] * cartesian(p, state.multiplier[p]);
          return Utilities::MPI::sum(here, space.communicator);
        };
        result[id] = {sum(false), sum(true)};
      }
    return result;
  }



  template <int dim>
  std::vector<Tensor<1, 2>>
  ContactFace<dim>::slips(
    const DistributedVector         &change,
    const std::vector<Tensor<1, 2>> &foundation_step) const
  {
    const ContactLayout      &face = layout();
    const Vector<double>      x    = face_restriction.gather(change);
    std::vector<Tensor<1, 2>> result;
    for (const auto &point : face.points)
      result.push_back(slip(point, face.node_values(x, point.node)));
    for (unsigned int p = 0; p < foundation_step.size(); ++p)
      result[p] -= foundation_step[p];
    return result;
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::slip_rates(const DistributedVector &velocity,
                               const double             t_old,
                               const double             t) const
  {
    if (!any_rate)
      return {};
    DistributedVector in_frames = space.owned_vector();
    space.to_frames(velocity, in_frames);
    std::vector<Tensor<1, 2>> carried;
    if (t > t_old)
      carried = foundation_step(t_old, t);
    for (Tensor<1, 2> &rate : carried)
      rate /= t - t_old;
    std::vector<double> result;
    for (const Tensor<1, 2> &rate : slips(in_frames, carried))
      result.push_back(stable_norm(rate));
    return result;
  }



  template <int dim>
  DistributedVector
  ContactFace<dim>::density(const ContactState &state,
                            const bool          of_friction_alone) const
  {
    const ContactLayout &face   = layout();
    DistributedVector    values = space.owned_vector(),
                      ghosted   = space.ghosted_vector();
    LinearAlgebra::distributed::Vector<double> on_other_side;
    if (!space.mortar_rows.empty())
      on_other_side.reinit(space.owned, space.relevant, space.communicator);
    for (unsigned int p = 0; p < face.points.size(); ++p)
      {
        const auto dof = nodes[face.points[p].node].first_dof;
        if (point_weights[p] == 0. ||
            (of_friction_alone && face.points[p].is_obstacle))
          continue;
        // Points of the same normal at a node share the sum of their areas.
        double      area  = point_weights[p];
        const auto &point = face.points[p];
        for (const unsigned int o : face.node_points(point.node))
          if (const auto &other = face.points[o];
              o != p && other.is_obstacle == point.is_obstacle &&
              other.n_tangents == point.n_tangents &&
              (other.map[0] - point.map[0]).norm() < 1e-10 &&
              (other.map[1] - point.map[1]).norm() < 1e-10)
            area += point_weights[o];
        Tensor<1, dim> traction = cartesian(p, state.multiplier[p]) / area;
        // A pressure acts along the whole normal, also in components that other
        // conditions hold, which cartesian() leaves out.
        if (face.points[p].is_obstacle)
          {
            const unsigned int     n     = face.points[p].node;
            const NodalFrame<dim> &frame = space.frame_at(dof);
            traction += state.multiplier[p][0] / area *
                        (nodes[n].directions *
                         frame.obstacles[p - face.first_obstacle(n)].fixed);
          }
        for (unsigned int d = 0; d < dim; ++d)
          values.begin()[space.owned.index_within_set(dof) + d] += traction[d];
        if (!space.scene.boundary.at(boundary_ids[p].front()).against)
          continue;
        const auto          &coupling = space.coupling_at(dof);
        const Tensor<1, dim> force    = area * (coupling.projector * traction);
        for (const auto &[other, weight] : coupling.others)
          for (unsigned int d = 0; d < dim; ++d)
            on_other_side(space.relevant.nth_index_in_set(other + d)) +=
              weight * force[d];
      }
    if (!space.mortar_rows.empty())
      {
        on_other_side.compress(VectorOperation::add);
        for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
          if (const double force = on_other_side.local_element(i); force != 0.)
            values.begin()[i] -=
              force / other_side_weights.local_element(i - i % dim);
      }
    space.distribute_hanging_nodes(values);
    ghosted = values;
    return ghosted;
  }



  template <int dim>
  std::vector<Tensor<1, 2>>
  ContactFace<dim>::multipliers(const DistributedVector &ghosted_density) const
  {
    const ContactLayout      &face = layout();
    std::vector<Tensor<1, 2>> result(face.points.size());
    for (unsigned int p = 0; p < face.points.size(); ++p)
      {
        const unsigned int n    = face.points[p].node;
        const Node        &node = nodes[n];
        if (!face.is_plain(n))
          continue;
        Tensor<1, dim> density;
        for (unsigned int d = 0; d < dim; ++d)
          density[d] =
            ghosted_density
              .begin()[space.relevant.index_within_set(node.first_dof) + d];
        const Tensor<1, dim> in_frame = transpose(node.directions) * density;
        Tensor<1, 3>         on_face;
        for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
          on_face[i] = in_frame[node.components[i]];
        result[p] = slip(face.points[p], on_face) * point_weights[p];
        if (face.points[p].is_obstacle)
          {
            // At an oblique obstacle, rounding of friction is no pressure.
            const Tensor<1, 3> &normal = face.points[p].map[0];
            if (std::abs(normal * on_face) <=
                1e-12 * normal.norm() * on_face.norm())
              result[p] = Tensor<1, 2>();
            result[p] /= normal.norm_square();
          }
      }
    return result;
  }



  template <int dim>
  DistributedVector
  ContactFace<dim>::nodal_field(const std::vector<double> &point_values,
                                const bool                 of_obstacles) const
  {
    const ContactLayout &face   = layout();
    DistributedVector    values = space.owned_vector(),
                      ghosted   = space.ghosted_vector();
    for (const unsigned int p : face.points_of_kind(of_obstacles))
      {
        const unsigned int n = face.points[p].node;
        values.begin()[space.owned.index_within_set(nodes[n].first_dof)] +=
          point_values[p] /
          (of_obstacles ? face.obstacles(n) : face.friction_points(n)).size();
      }
    space.distribute_hanging_nodes(values);
    ghosted = values;
    return ghosted;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, cartesian);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, forces_by_boundary);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, slips);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, slip_rates);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, density);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, multipliers);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ContactFace, nodal_field);
} // namespace Viscoplastic
