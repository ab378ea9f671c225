// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/held_traction.h>

namespace Viscoplastic
{
  namespace
  {
    std::shared_ptr<const Utilities::MPI::Partitioner>
    with_ghosts(const IndexSet                      &own,
                std::vector<types::global_dof_index> others,
                const MPI_Comm                       communicator)
    {
      std::sort(others.begin(), others.end());
      IndexSet ghosts(own.size());
      ghosts.add_indices(others.begin(), others.end());
      return std::make_shared<const Utilities::MPI::Partitioner>(own,
                                                                 ghosts,
                                                                 communicator);
    }
  } // namespace



  template <int dim>
  ContactFace<dim>::ContactFace(const AdmissibleSpace<dim> &space)
    : space(space)
    , bounds_vary(false)
  {
    for (const auto &pair : space.scene.boundary)
      if (pair.second.has_contact_points())
        {
          bounds_vary |= pair.second.bound_depends_on_time();
          any_obstacles |= pair.second.is_unilateral();
          any_compliance |= pair.second.has_normal_compliance();
          any_rate |= pair.second.slip_rate_factor.has_value();
          any_computed_pressure |= pair.second.has_computed_pressure();
        }
    make_nodes();
    make_shares();
    point_weights = sum_all_shares([](const Sample &) { return 1.; });
    if (!space.mortar_rows.empty())
      {
        std::set<types::boundary_id> other_sides;
        for (const auto &of_boundary : space.mortar_rows)
          other_sides.insert(
            *space.scene.boundary.at(of_boundary.first).against);
        other_side_weights = boundary_weights(space, other_sides);
      }
    if (any_compliance)
      make_compliance();
    make_area_shares();
  }



  template <int dim>
  void
  ContactFace<dim>::make_nodes()
  {
    std::vector<typename AdmissibleSpace<dim>::BoundaryNode> in_contact;
    for (const auto &node : space.boundary_nodes())
      if (const auto &frame = space.frame(node.frame);
          !frame.planes.empty() || !frame.obstacles.empty())
        in_contact.push_back(node);
    // Sorting by position makes the order of Gauss-Seidel sweeps independent of
    // the numbering of the mesh.
    std::sort(in_contact.begin(),
              in_contact.end(),
              [](const auto &a, const auto &b) {
                for (unsigned int d = 0; d < dim; ++d)
                  if (a.position[d] != b.position[d])
                    return a.position[d] < b.position[d];
                return false;
              });

    ContactLayout face;
    face.communicator  = space.communicator;
    face.has_obstacles = any_obstacles;
    std::vector<types::global_dof_index> dofs;
    for (const auto &[first_dof, position, frame_index] : in_contact)
      {
        const NodalFrame<dim> &frame = space.frame(frame_index);
        Node                   node{first_dof, position, frame.directions, {}};
        // Face components are those on which the slip at some point depends.
        std::array<unsigned int, dim> position_of;
        unsigned int                  n = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            bool seen = false;
            for (const FrictionPlane<dim> &plane : frame.planes)
              for (const auto &row : plane.map)
                seen |= row[d] != 0.;
            for (const Obstacle<dim> &obstacle : frame.obstacles)
              seen |= obstacle.map[d] != 0.;
            if (seen)
              {
                node.components[n] = d;
                position_of[d]     = n++;
                dofs.push_back(first_dof + d);
              }
          }
        face.first_dof.push_back(face.first_dof.back() + n);
        for (const FrictionPlane<dim> &plane : frame.planes)
          {
            ContactLayout::Point point;
            point.node       = nodes.size();
            point.n_tangents = plane.n_tangents;
            for (unsigned int i = 0; i < point.n_tangents; ++i)
              for (unsigned int d = 0; d < dim; ++d)
                if (plane.map[i][d] != 0.)
                  point.map[i][position_of[d]] = plane.map[i][d];
            face.points.push_back(point);
            boundary_ids.push_back(plane.boundary_ids);
          }
        for (const Obstacle<dim> &obstacle : frame.obstacles)
          {
            ContactLayout::Point point;
            point.node        = nodes.size();
            point.n_tangents  = 1;
            point.is_obstacle = true;
            for (unsigned int d = 0; d < dim; ++d)
              if (obstacle.map[d] != 0.)
                point.map[0][position_of[d]] = obstacle.map[d];
            face.points.push_back(point);
            boundary_ids.push_back(obstacle.boundary_ids);
          }
        face.first_point.push_back(face.points.size());
        nodes.push_back(node);
      }
    face_restriction =
      FaceRestriction(std::move(face), std::move(dofs), space.owned);
  }



  template <int dim>
  void
  ContactFace<dim>::make_shares()
  {
    // Tell ranks that see a node the number of its first point over all ranks;
    // further points follow in the order of the node's frame.
    const ContactLayout &face = layout();
    const IndexSet own_points = Utilities::MPI::create_ascending_partitioning(
      space.communicator,
      face.points.size())[Utilities::MPI::this_mpi_process(space.communicator)];
    if (own_points.size() == 0)
      return;
    DistributedVector first_points = space.owned_vector(),
                      ghosted      = space.ghosted_vector();
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      first_points.begin()[space.owned.index_within_set(nodes[n].first_dof)] =
        own_points.nth_index_in_set(face.first_point[n]);
    ghosted = first_points;

    struct GlobalShare
    {
      unsigned int            sample;
      types::global_dof_index point;
      bool                    of_obstacle;
      double                  value;
    };
    std::vector<GlobalShare> global_shares;
    const auto               first_point = [&](const auto first_dof) {
      return static_cast<types::global_dof_index>(
        ghosted.begin()[space.relevant.index_within_set(first_dof)]);
    };

    FEFaceValues<dim> face_values(space.mapping,
                                  space.dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_values | update_JxW_values |
                                    update_quadrature_points);
    space.for_each_boundary_face([&](const std::size_t,
                                     const auto        &cell,
                                     const unsigned int f,
                                     const auto        &condition) {
      if (!condition.has_contact_points() ||
          !space.scene.is_present(cell->material_id()))
        return;
      face_values.reinit(cell, f);
      for (const unsigned int q : face_values.quadrature_point_indices())
        {
          for (const unsigned int v : cell->vertex_indices())
            {
              const double value =
                face_values.shape_value(v * dim, q) * face_values.JxW(q);
              if (std::abs(value) < 1e-12 * face_values.JxW(q))
                continue; // not a vertex of the face
              for (const auto &[dof, weight] :
                   space.independent_nodes(cell->vertex_dof_index(v, 0)))
                {
                  // The frame of a node that is held has no points.
                  const NodalFrame<dim>  &frame = space.frame_at(dof);
                  types::global_dof_index point = first_point(dof);
                  const auto              add_to =
                    [&, share = weight * value](const bool  of_obstacle,
                                                const auto &ids) {
                      if (std::find(ids.begin(), ids.end(), condition.id) !=
                          ids.end())
                        global_shares.push_back(
                          {static_cast<unsigned int>(samples.size()),
                           point,
                           of_obstacle,
                           share});
                      ++point;
                    };
                  for (const auto &plane : frame.planes)
                    add_to(false, plane.boundary_ids);
                  for (const auto &obstacle : frame.obstacles)
                    add_to(true, obstacle.boundary_ids);
                }
            }
          samples.push_back({face_values.quadrature_point(q), &condition});
        }
    });

    std::vector<types::global_dof_index> others;
    for (const GlobalShare &share : global_shares)
      if (!own_points.is_element(share.point))
        others.push_back(share.point);
    numbers = with_ghosts(own_points, std::move(others), space.communicator);
    for (const GlobalShare &share : global_shares)
      shares.push_back({share.sample,
                        numbers->global_to_local(share.point),
                        share.of_obstacle,
                        share.value});
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::sum_all_shares(
    const std::function<double(const Sample &)> &factor) const
  {
    std::vector<double> result = sum_shares(factor);
    if (any_obstacles)
      {
        const std::vector<double> of_obstacles = sum_shares(factor, true);
        for (const unsigned int o : layout().obstacles())
          result[o] = of_obstacles[o];
      }
    return result;
  }



  template <int dim>
  void
  ContactFace<dim>::make_compliance()
  {
    // k_c = int c phi_c, since penetration and gap are those of the node.
    for (const auto &pair : space.scene.boundary)
      {
        const BoundaryCondition<dim> &condition = pair.second;
        if (!condition.has_normal_compliance())
          continue;
        const std::vector<double> stiffness = sum_shares(
          [&](const Sample &sample) {
            return sample.condition == &condition ?
                     condition.compliance(sample.x) :
                     0.;
          },
          /* of_obstacles = */ true);
        for (const unsigned int o : layout().obstacles())
          if (const auto &ids = boundary_ids[o];
              std::find(ids.begin(), ids.end(), pair.first) != ids.end())
            face_restriction.add_compliance(o,
                                            stiffness[o],
                                            condition.pressure_law);
      }
  }



  template <int dim>
  void
  ContactFace<dim>::make_area_shares()
  {
    for (const auto &[id, condition] : space.scene.boundary)
      if (condition.has_contact_points())
        area_shares[id];
    if (area_shares.size() < 2)
      area_shares.clear();
    for (auto &[id, part] : area_shares)
      {
        const BoundaryCondition<dim> *const condition =
          &space.scene.boundary.at(id);
        part = sum_all_shares([condition](const Sample &sample) {
          return sample.condition == condition ? 1. : 0.;
        });
        part.resize(point_weights.size());
        for (unsigned int p = 0; p < part.size(); ++p)
          part[p] = point_weights[p] > 0. ? part[p] / point_weights[p] : 0.;
      }
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::sum_shares(
    const std::function<double(const Sample &)> &factor,
    const bool                                   of_obstacles,
    const std::vector<double> *const             slip_rates) const
  {
    if (!numbers)
      return {};
    std::vector<double> factors;
    for (const Sample &sample : samples)
      factors.push_back((of_obstacles ? sample.condition->is_unilateral() :
                                        sample.condition->has_friction()) ?
                          factor(sample) :
                          0.);
    LinearAlgebra::distributed::Vector<double> sums(numbers), rates;
    const bool by_rate = any_rate && slip_rates != nullptr;
    if (by_rate)
      {
        rates.reinit(numbers);
        std::copy(slip_rates->begin(), slip_rates->end(), rates.begin());
        rates.update_ghost_values();
      }
    for (const Share &share : shares)
      if (share.of_obstacle == of_obstacles)
        {
          double value = share.value * factors[share.sample];
          if (by_rate && value != 0.)
            value *= samples[share.sample].condition->bound_factor(
              rates.local_element(share.point));
          sums.local_element(share.point) += value;
        }
    sums.compress(VectorOperation::add);
    return {sums.begin(), sums.end()};
  }



  template <int dim>
  std::set<types::boundary_id>
  ContactFace<dim>::held_boundaries() const
  {
    std::set<types::boundary_id> ids_of_points;
    for (const auto &ids : boundary_ids)
      ids_of_points.insert(ids.begin(), ids.end());
    ids_of_points =
      Utilities::MPI::compute_set_union(ids_of_points, space.communicator);
    std::set<types::boundary_id> result;
    for (const auto &[id, condition] : space.scene.boundary)
      if (condition.has_contact_points() && ids_of_points.count(id) == 0)
        result.insert(id);
    return result;
  }



  template <int dim>
  std::vector<Tensor<1, 2>>
  ContactFace<dim>::foundation_step(const double t_old, const double t) const
  {
    if (!space.scene.has_moving_foundation())
      return {};
    const ContactLayout      &face = layout();
    std::vector<Tensor<1, 2>> result(face.points.size());
    for (const unsigned int p : face.friction_points())
      {
        // All pieces of a point of friction move alike, see make_nodal_frame().
        const BoundaryCondition<dim> &condition =
          space.scene.boundary.at(boundary_ids[p].front());
        if (!condition.foundation_motion)
          continue;
        const unsigned int   n    = face.points[p].node;
        const Node          &node = nodes[n];
        const Tensor<1, dim> step = transpose(node.directions) *
                                    (condition.sliding(node.position, t) -
                                     condition.sliding(node.position, t_old));
        Tensor<1, 3> on_face;
        for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
          on_face[i] = step[node.components[i]];
        // With map^T map = P^T P for the tangential displacement P x of the
        // free components x, the slip of a step w that is tangential itself is
        // (map map^T)^{-1} map w.
        result[p] = nearest_multiplier(face.points[p], on_face);
      }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ContactFace);
} // namespace Viscoplastic
