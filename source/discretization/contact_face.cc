// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/discretization/contact_face.h>

#include <algorithm>
#include <utility>

namespace Viscoplastic
{
  template <int dim>
  ContactFace<dim>::ContactFace(const AdmissibleSpace<dim> &space)
    : space(space)
    , bounds_vary(false)
  {
    for (const auto &pair : space.scene.boundary)
      if (pair.second.has_friction())
        bounds_vary |= pair.second.bound_depends_on_time();
    make_nodes();
    make_shares();
  }



  template <int dim>
  void
  ContactFace<dim>::make_nodes()
  {
    std::vector<typename AdmissibleSpace<dim>::BoundaryNode> frictional;
    for (const auto &node : space.boundary_nodes())
      if (!space.frame(node.frame).planes.empty())
        frictional.push_back(node);
    // By position: the order of sweeps must not depend on how the mesh has come
    // about.
    std::sort(frictional.begin(),
              frictional.end(),
              [](const auto &a, const auto &b) {
                for (unsigned int d = 0; d < dim; ++d)
                  if (a.position[d] != b.position[d])
                    return a.position[d] < b.position[d];
                return false;
              });

    FrictionFace face;
    face.communicator = space.communicator;
    std::vector<types::global_dof_index> dofs;
    for (const auto &[first_dof, position, frame_index] : frictional)
      {
        const NodalFrame<dim> &frame = space.frame(frame_index);
        Node                   node{first_dof, position, frame.directions, {}};
        // Face components: those that some point sees.
        std::array<unsigned int, dim> position_of;
        unsigned int                  n = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            bool seen = false;
            for (const FrictionPlane<dim> &plane : frame.planes)
              for (const auto &row : plane.map)
                seen |= row[d] != 0.;
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
            FrictionFace::Point point;
            point.node       = nodes.size();
            point.n_tangents = plane.n_tangents;
            for (unsigned int i = 0; i < point.n_tangents; ++i)
              for (unsigned int d = 0; d < dim; ++d)
                if (plane.map[i][d] != 0.)
                  point.map[i][position_of[d]] = plane.map[i][d];
            face.points.push_back(point);
            boundary_ids.push_back(plane.boundary_ids);
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
    // The number of each node's first point over all ranks, for those that see
    // the node; its points are those of its frame.
    const FrictionFace &face  = layout();
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
      double                  value;
    };
    std::vector<GlobalShare> global_shares;
    const auto               first_point = [&](const auto first_dof) {
      return static_cast<types::global_dof_index>(
        ghosted.begin()[space.relevant.index_within_set(first_dof)]);
    };

    FEFaceValues<dim> face_values(space.dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_values | update_JxW_values |
                                    update_quadrature_points);
    const auto       &hanging = space.cartesian_hanging_nodes();
    for (const auto &cell : space.cells)
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
          {
            const types::boundary_id id        = cell->face(f)->boundary_id();
            const auto              &condition = space.scene.boundary.at(id);
            if (!condition.has_friction())
              continue;
            face_values.reinit(cell, f);
            for (const unsigned int q : face_values.quadrature_point_indices())
              {
                for (const unsigned int v : cell->vertex_indices())
                  {
                    const double value =
                      face_values.shape_value(v * dim, q) * face_values.JxW(q);
                    if (std::abs(value) < 1e-12 * face_values.JxW(q))
                      continue; // not a vertex of the face
                    const auto add = [&](const types::global_dof_index dof,
                                         const double                  weight) {
                      // None where other conditions hold the node.
                      const auto &planes = space.frame_at(dof).planes;
                      for (unsigned int p = 0; p < planes.size(); ++p)
                        if (std::count(planes[p].boundary_ids.begin(),
                                       planes[p].boundary_ids.end(),
                                       id) > 0)
                          global_shares.push_back(
                            {static_cast<unsigned int>(samples.size()),
                             first_point(dof) + p,
                             weight * value});
                    };
                    const auto dof = cell->vertex_dof_index(v, 0);
                    if (hanging.is_constrained(dof))
                      {
                        for (const auto &[master, weight] :
                             *hanging.get_constraint_entries(dof))
                          add(master, weight);
                      }
                    else
                      add(dof, 1.);
                  }
                samples.push_back(
                  {face_values.quadrature_point(q), &condition});
              }
          }

    std::vector<types::global_dof_index> others;
    for (const GlobalShare &share : global_shares)
      if (!own_points.is_element(share.point))
        others.push_back(share.point);
    std::sort(others.begin(), others.end());
    IndexSet ghost_points(own_points.size());
    ghost_points.add_indices(others.begin(), others.end());
    numbers =
      std::make_shared<const Utilities::MPI::Partitioner>(own_points,
                                                          ghost_points,
                                                          space.communicator);
    for (const GlobalShare &share : global_shares)
      shares.push_back(
        {share.sample, numbers->global_to_local(share.point), share.value});
    point_weights = sum_shares([](const Sample &) { return 1.; });
  }



  template <int dim>
  types::global_dof_index
  ContactFace<dim>::n_global_points() const
  {
    return numbers ? numbers->size() : 0;
  }



  template <int dim>
  template <typename Factor>
  std::vector<double>
  ContactFace<dim>::sum_shares(const Factor &factor) const
  {
    if (!numbers)
      return {};
    std::vector<double> factors;
    for (const Sample &sample : samples)
      factors.push_back(factor(sample));
    LinearAlgebra::distributed::Vector<double> sums(numbers);
    for (const Share &share : shares)
      sums.local_element(share.point) += share.value * factors[share.sample];
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
      if (condition.has_friction() && ids_of_points.count(id) == 0)
        result.insert(id);
    return result;
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::bounds(const double t) const
  {
    if (constant_bounds)
      return *constant_bounds;
    // rho_c = int rho phi_c, with which j_n(v) = sum_c rho_c |v_c|.
    std::vector<double> result = sum_shares([t](const Sample &sample) {
      return sample.condition->bound(sample.x, t);
    });
    if (!bounds_vary)
      constant_bounds = result;
    return result;
  }



  template <int dim>
  Tensor<1, dim>
  ContactFace<dim>::cartesian(const unsigned int  point,
                              const Tensor<1, 2> &multiplier) const
  {
    const FrictionFace &face  = layout();
    const Node         &node  = nodes[face.points[point].node];
    const Tensor<1, 3>  force = node_force(face.points[point], multiplier);
    Tensor<1, dim>      in_frame;
    for (unsigned int i = 0; i < face.n_node_dofs(face.points[point].node); ++i)
      in_frame[node.components[i]] = force[i];
    return node.directions * in_frame;
  }



  template <int dim>
  Tensor<1, dim>
  ContactFace<dim>::resultant(const FrictionState &state) const
  {
    const FrictionFace &face = layout();
    Tensor<1, dim>      sum;
    for (unsigned int p = 0; p < face.points.size(); ++p)
      sum += cartesian(p, state.multiplier[p]);
    return Utilities::MPI::sum(sum, space.communicator);
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::bounds_by_id(const double t) const
  {
    if (constant_bounds_by_id)
      return *constant_bounds_by_id;
    std::vector<std::size_t> first{0};
    for (const auto &ids : boundary_ids)
      first.push_back(first.back() + ids.size());
    std::vector<double> result(first.back(), 0.);
    for (const auto &[id, condition] : space.scene.boundary)
      if (condition.has_friction())
        {
          const types::boundary_id  this_id = id;
          const std::vector<double> part =
            sum_shares([this_id, t](const Sample &sample) {
              return sample.condition->id == this_id ?
                       sample.condition->bound(sample.x, t) :
                       0.;
            });
          for (unsigned int p = 0; p < part.size(); ++p)
            for (unsigned int i = 0; i < boundary_ids[p].size(); ++i)
              if (boundary_ids[p][i] == id)
                result[first[p] + i] = part[p];
        }
    if (!bounds_vary && space.scene.parameters.solver.reuse_unchanged)
      constant_bounds_by_id = result;
    return result;
  }



  template <int dim>
  Vector<double>
  ContactFace<dim>::foundation_step(const double t_old, const double t) const
  {
    const FrictionFace &face = layout();
    if (!space.scene.has_moving_foundation())
      return {};
    const std::vector<double> weights = bounds_by_id(t);
    Vector<double>            result(face.n_dofs());
    std::size_t               k = 0; // among the weights
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      {
        const Node &node = nodes[n];
        // The motion of an id in face components.
        const auto motion = [&](const types::boundary_id id) {
          const BoundaryCondition<dim> &condition = space.scene.boundary.at(id);
          const Tensor<1, dim>          step      = transpose(node.directions) *
                                      (condition.sliding(node.position, t) -
                                       condition.sliding(node.position, t_old));
          Tensor<1, 3> on_face;
          for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
            on_face[i] = step[node.components[i]];
          return on_face;
        };

        // Least squares of M_p x = M_p w over the points p and their ids.
        SymmetricTensor<2, 3> matrix;
        Tensor<1, 3>          right_side, first_motion;
        unsigned int          n_motions = 0;
        for (unsigned int p = face.first_point[n]; p < face.first_point[n + 1];
             ++p)
          for (const types::boundary_id id : boundary_ids[p])
            {
              const double weight = weights[k++];
              if (weight == 0.)
                continue;
              const FrictionFace::Point &point = face.points[p];
              const Tensor<1, 3>         w     = motion(id);
              if (n_motions++ == 0)
                first_motion = w;
              right_side += weight * node_force(point, slip(point, w));
              for (unsigned int row = 0; row < point.n_tangents; ++row)
                matrix += weight * symmetrize(outer_product(point.map[row],
                                                            point.map[row]));
            }
        Tensor<1, 3> x = first_motion;
        if (n_motions > 1)
          {
            // The change against one of them, of least norm: directions that
            // no point sees drop out, and equal motions are met exactly.
            right_side -= matrix * first_motion;
            const auto modes = eigenvectors(matrix);
            for (const auto &[value, mode] : modes)
              if (value > 1e-12 * modes[0].first)
                x += (mode * right_side / value) * mode;
          }
        face.set_node_values(x, n, result);
      }
    return result;
  }



  template <int dim>
  std::vector<Tensor<1, 2>>
  ContactFace<dim>::slips(const Vector<double> &change) const
  {
    const FrictionFace       &face = layout();
    std::vector<Tensor<1, 2>> result;
    for (const auto &point : face.points)
      result.push_back(slip(point, face.node_values(change, point.node)));
    return result;
  }



  template <int dim>
  std::vector<Tensor<1, 2>>
  ContactFace<dim>::slips(const DistributedVector &change,
                          const Vector<double>    &foundation_step) const
  {
    Vector<double> x = face_restriction.gather(change);
    if (foundation_step.size() > 0)
      x -= foundation_step;
    return slips(x);
  }



  template <int dim>
  DistributedVector
  ContactFace<dim>::density(const FrictionState &state) const
  {
    const FrictionFace &face   = layout();
    DistributedVector   values = space.owned_vector(),
                      ghosted  = space.ghosted_vector();
    for (unsigned int p = 0; p < face.points.size(); ++p)
      {
        const auto dof = nodes[face.points[p].node].first_dof;
        if (point_weights[p] == 0.)
          continue;
        const Tensor<1, dim> traction =
          cartesian(p, state.multiplier[p]) / point_weights[p];
        for (unsigned int d = 0; d < dim; ++d)
          values.begin()[space.owned.index_within_set(dof) + d] += traction[d];
      }
    space.distribute_hanging_nodes(values);
    ghosted = values;
    return ghosted;
  }



  template <int dim>
  std::vector<Tensor<1, 2>>
  ContactFace<dim>::multipliers(const DistributedVector &ghosted_density) const
  {
    const FrictionFace       &face = layout();
    std::vector<Tensor<1, 2>> result(face.points.size());
    for (unsigned int p = 0; p < face.points.size(); ++p)
      {
        const Node &node = nodes[face.points[p].node];
        if (face.n_node_points(face.points[p].node) > 1)
          continue;
        Tensor<1, dim> density;
        for (unsigned int d = 0; d < dim; ++d)
          density[d] =
            ghosted_density
              .begin()[space.relevant.index_within_set(node.first_dof) + d];
        const Tensor<1, dim> in_frame = transpose(node.directions) * density;
        Tensor<1, 3>         on_face;
        for (unsigned int i = 0; i < face.n_node_dofs(face.points[p].node); ++i)
          on_face[i] = in_frame[node.components[i]];
        result[p] = slip(face.points[p], on_face) * point_weights[p];
      }
    return result;
  }



  template <int dim>
  DistributedVector
  ContactFace<dim>::nodal_field(const std::vector<double> &point_values) const
  {
    const FrictionFace &face   = layout();
    DistributedVector   values = space.owned_vector(),
                      ghosted  = space.ghosted_vector();
    for (unsigned int p = 0; p < face.points.size(); ++p)
      {
        const auto dof = nodes[face.points[p].node].first_dof;
        values.begin()[space.owned.index_within_set(dof)] +=
          point_values[p] / face.n_node_points(face.points[p].node);
      }
    space.distribute_hanging_nodes(values);
    ghosted = values;
    return ghosted;
  }



  template class ContactFace<2>;
  template class ContactFace<3>;
} // namespace Viscoplastic
