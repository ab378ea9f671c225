// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/discretization/contact_face.h>

#include <algorithm>
#include <map>
#include <utility>

namespace Viscoplastic
{
  namespace
  {
    /// A face node as its owner knows it, for the other ranks.
    template <int dim>
    struct NodeRecord
    {
      types::global_dof_index                first_dof;
      Point<dim>                             position;
      Tensor<2, dim>                         directions;
      std::vector<unsigned int>              n_tangents;   // a plane
      std::vector<Tensor<1, dim>>            maps;         // dim - 1 a plane
      std::vector<std::vector<unsigned int>> boundary_ids; // a plane

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &first_dof &position &directions &n_tangents &maps
          &boundary_ids;
      }
    };
  } // namespace



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
    std::vector<NodeRecord<dim>> records;
    for (const auto &node : space.boundary_nodes())
      {
        const NodalFrame<dim> &frame = space.frame(node.frame);
        if (frame.planes.empty())
          continue;
        NodeRecord<dim> record;
        record.first_dof  = node.first_dof;
        record.position   = node.position;
        record.directions = frame.directions;
        for (const FrictionPlane<dim> &plane : frame.planes)
          {
            record.n_tangents.push_back(plane.n_tangents);
            for (const auto &row : plane.map)
              record.maps.push_back(row);
            record.boundary_ids.emplace_back(plane.boundary_ids.begin(),
                                             plane.boundary_ids.end());
          }
        records.push_back(record);
      }
    std::vector<NodeRecord<dim>> all;
    for (auto &part : Utilities::MPI::all_gather(space.communicator, records))
      all.insert(all.end(), part.begin(), part.end());
    // By position: the order of sweeps must not depend on the partition.
    std::sort(all.begin(), all.end(), [](const auto &a, const auto &b) {
      for (unsigned int d = 0; d < dim; ++d)
        if (a.position[d] != b.position[d])
          return a.position[d] < b.position[d];
      return false;
    });

    FrictionFace                         face;
    std::vector<types::global_dof_index> dofs;
    for (const NodeRecord<dim> &record : all)
      {
        Node node{record.first_dof, record.position, record.directions, {}};
        // Face components: those that some point sees.
        std::array<unsigned int, dim> position_of;
        unsigned int                  n = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            bool seen = false;
            for (const auto &row : record.maps)
              seen |= row[d] != 0.;
            if (seen)
              {
                node.components[n] = d;
                position_of[d]     = n++;
                dofs.push_back(record.first_dof + d);
              }
          }
        face.first_dof.push_back(face.first_dof.back() + n);
        for (unsigned int p = 0; p < record.n_tangents.size(); ++p)
          {
            FrictionFace::Point point;
            point.node       = nodes.size();
            point.n_tangents = record.n_tangents[p];
            for (unsigned int i = 0; i < point.n_tangents; ++i)
              for (unsigned int d = 0; d < dim; ++d)
                if (record.maps[p * (dim - 1) + i][d] != 0.)
                  point.map[i][position_of[d]] =
                    record.maps[p * (dim - 1) + i][d];
            face.points.push_back(point);
            boundary_ids.emplace_back(record.boundary_ids[p].begin(),
                                      record.boundary_ids[p].end());
          }
        face.first_point.push_back(face.points.size());
        nodes.push_back(node);
      }
    face_restriction = FaceRestriction(std::move(face),
                                       std::move(dofs),
                                       space.owned,
                                       space.communicator);
  }



  template <int dim>
  void
  ContactFace<dim>::make_shares()
  {
    const FrictionFace                             &face = layout();
    std::map<types::global_dof_index, unsigned int> node_of_dof;
    for (unsigned int n = 0; n < nodes.size(); ++n)
      node_of_dof[nodes[n].first_dof] = n;

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
                      const auto node = node_of_dof.find(dof);
                      if (node == node_of_dof.end())
                        return; // held by other conditions
                      for (unsigned int p = face.first_point[node->second];
                           p < face.first_point[node->second + 1];
                           ++p)
                        if (std::count(boundary_ids[p].begin(),
                                       boundary_ids[p].end(),
                                       id) > 0)
                          shares.push_back(
                            {static_cast<unsigned int>(samples.size()),
                             p,
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
    point_weights.assign(face.points.size(), 0.);
    for (const Share &share : shares)
      point_weights[share.point] += share.value;
    Utilities::MPI::sum(point_weights, space.communicator, point_weights);
  }



  template <int dim>
  std::set<types::boundary_id>
  ContactFace<dim>::held_boundaries() const
  {
    std::set<types::boundary_id> result;
    for (const auto &[id, condition] : space.scene.boundary)
      if (condition.has_friction())
        result.insert(id);
    for (const auto &ids_of_point : boundary_ids)
      for (const types::boundary_id id : ids_of_point)
        result.erase(id);
    return result;
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::bounds(const double t) const
  {
    const FrictionFace &face = layout();
    if (!constant_bounds.empty())
      return constant_bounds;
    std::vector<double> rho(samples.size());
    for (unsigned int s = 0; s < samples.size(); ++s)
      rho[s] = samples[s].condition->bound(samples[s].x, t);
    // rho_c = int rho phi_c, with which j_n(v) = sum_c rho_c |v_c|.
    std::vector<double> result(face.points.size(), 0.);
    for (const Share &share : shares)
      result[share.point] += share.value * rho[share.sample];
    Utilities::MPI::sum(result, space.communicator, result);
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
    return sum;
  }



  template <int dim>
  std::vector<double>
  ContactFace<dim>::bounds_by_id(const double t) const
  {
    std::vector<std::size_t> first{0};
    for (const auto &ids : boundary_ids)
      first.push_back(first.back() + ids.size());
    std::vector<double> result(first.back(), 0.);
    for (const Share &share : shares)
      {
        const Sample &sample = samples[share.sample];
        const auto   &ids    = boundary_ids[share.point];
        const auto id = std::find(ids.begin(), ids.end(), sample.condition->id);
        result[first[share.point] + (id - ids.begin())] +=
          share.value * sample.condition->bound(sample.x, t);
      }
    Utilities::MPI::sum(result, space.communicator, result);
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
        if (!space.owned.is_element(dof) || point_weights[p] == 0.)
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
    const FrictionFace &face = layout();
    std::vector<double> values(2 * face.points.size(), 0.);
    for (unsigned int p = 0; p < face.points.size(); ++p)
      {
        const Node &node = nodes[face.points[p].node];
        if (!space.owned.is_element(node.first_dof) ||
            face.n_node_points(face.points[p].node) > 1)
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
        const Tensor<1, 2> multiplier =
          slip(face.points[p], on_face) * point_weights[p];
        values[2 * p]     = multiplier[0];
        values[2 * p + 1] = multiplier[1];
      }
    Utilities::MPI::sum(values, space.communicator, values);
    std::vector<Tensor<1, 2>> result(face.points.size());
    for (unsigned int p = 0; p < result.size(); ++p)
      for (unsigned int i = 0; i < 2; ++i)
        result[p][i] = values[2 * p + i];
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
        if (space.owned.is_element(dof))
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
