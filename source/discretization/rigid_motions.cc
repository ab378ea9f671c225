// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/discretization/seen_motions.h>
#include <viscoplastic_contact/mesh/mesh_check.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

// The rigid motions of a body: the check that its conditions prevent them, and
// the near null space that they make for some solvers.

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int all_parts = numbers::invalid_unsigned_int;



    /// The parts of the present body. Without stages and contact between bodies
    /// there is one, and `of_cell` is empty.
    struct BodyParts : ConnectedParts
    {
      /// The parts that each boundary node belongs to, by its position in the
      /// list of boundary nodes.
      std::vector<std::set<unsigned int>> of_node;
    };



    template <int dim>
    BodyParts
    find_parts(const AdmissibleSpace<dim> &space)
    {
      const auto &nodes = space.boundary_nodes();
      BodyParts   result;
      if (!space.scene.has_stages() && !space.scene.has_contact_pairs())
        {
          result.n = 1;
          result.of_node.assign(nodes.size(), {0});
          return result;
        }
      const auto is_present = [&space](const types::material_id id) {
        return space.scene.is_present(id);
      };
      static_cast<ConnectedParts &>(result) =
        connected_parts<dim>(space.dof_handler.get_triangulation(), is_present);
      std::map<types::global_dof_index, std::size_t> number;
      for (std::size_t i = 0; i < nodes.size(); ++i)
        number[nodes[i].first_dof] = i;
      result.of_node.resize(nodes.size());
      for (const auto &cell : space.dof_handler.active_cell_iterators())
        if (!cell->is_artificial() && is_present(cell->material_id()))
          for (const unsigned int v : cell->vertex_indices())
            if (const auto node = number.find(cell->vertex_dof_index(v, 0));
                node != number.end())
              result.of_node[node->second].insert(
                result.of_cell[cell->id().get_coarse_cell_id()]);
      return result;
    }



    /// Call @p act (part of the body, place, direction) for the directions
    /// along which springs pull at places of owned faces.
    template <int dim, typename Action>
    void
    for_each_spring(const AdmissibleSpace<dim> &space,
                    const BodyParts            &parts,
                    const Action               &act)
    {
      FEFaceValues<dim> face_values(space.dof_handler.get_fe(),
                                    QGauss<dim - 1>(2),
                                    update_quadrature_points |
                                      update_normal_vectors);
      space.for_each_boundary_face([&](const std::size_t,
                                       const auto        &cell,
                                       const unsigned int f,
                                       const auto        &condition) {
        if (!condition.has_springs())
          return;
        const unsigned int part =
          parts.of_cell.empty() ?
            0 :
            parts.of_cell[cell->id().get_coarse_cell_id()];
        face_values.reinit(cell, f);
        for (const unsigned int q : face_values.quadrature_point_indices())
          {
            const Point<dim> &x = face_values.quadrature_point(q);
            const auto        K =
              condition.spring_stiffness(x, face_values.normal_vector(q));
            if (const double size = K.norm(); size > 0.)
              for (unsigned int d = 0; d < dim; ++d)
                act(part, x, K * Point<dim>::unit_vector(d) / size);
          }
      });
    }



    /// Whether friction or an obstacle at a node resists motions along a
    /// direction of its frame.
    template <int dim>
    bool
    contact_sees(const Scene<dim>      &scene,
                 const NodalFrame<dim> &frame,
                 const unsigned int     direction)
    {
      const auto has_friction = [&scene](const types::boundary_id id) {
        return !scene.boundary.at(id).friction_vanishes();
      };
      for (const FrictionPlane<dim> &plane : frame.planes)
        for (const auto &row : plane.map)
          if (row[direction] != 0. && std::any_of(plane.boundary_ids.begin(),
                                                  plane.boundary_ids.end(),
                                                  has_friction))
            return true;
      for (const Obstacle<dim> &obstacle : frame.obstacles)
        if (obstacle.map[direction] != 0.)
          return true;
      return false;
    }



    /// Rows for SeenMotions: the displacements of a place along a direction in
    /// the rigid motions of the parts of a body.
    template <int dim>
    struct MotionsOfPlace
    {
      /// Whether contact couples parts, whose motions share rows then.
      const bool       are_coupled;
      const Point<dim> center;
      const double     radius;

      void
      add_to(RigidMotion          &row,
             const unsigned int    part,
             const Point<dim>     &position,
             const Tensor<1, dim> &direction) const
      {
        const auto motions =
          rigid_displacements<dim>((position - center) / radius);
        for (unsigned int a = 0; a < motions.size(); ++a)
          row[(are_coupled ? part * motions.size() : 0) + a] =
            motions[a] * direction;
      }
    };



    /// A body of revolution resists all plane motions but that along its axis.
    void
    resist_as_ring(SeenMotions &seen, const unsigned int n_motions)
    {
      for (unsigned int motion = 0; motion < n_motions; ++motion)
        if (motion % n_rigid_motions<2> != 1)
          {
            RigidMotion row(n_motions, 0.);
            row[motion] = 1.;
            seen.add(row);
          }
    }



    /// The error message for a scene that leaves @p motions free.
    template <int dim>
    std::string
    refusal(const Scene<dim>  &scene,
            const unsigned int n_parts,
            const std::string &motions,
            const bool         may_be_held_by_contact)
    {
      std::ostringstream result;
      result << "The boundary conditions leave a rigid motion free";
      if (n_parts > 1)
        result << " of one of the " << n_parts
               << (scene.has_contact_pairs() ? " bodies" :
                                               " parts of the body");
      if (scene.stage() > 0)
        result << " from t = " << scene.stage_ends[scene.stage() - 1]
               << " on, when materials are added or removed";
      result << ": " << motions
             << ". Prescribe displacements that prevent it (clamped, "
                "displacement, symmetry, bilateral or glued contact; "
             << (may_be_held_by_contact ?
                   "unilateral contact holds a body along its normal, and "
                   "along its face by friction that is not zero)." :
                   "friction does not count).");
      return result.str();
    }
  } // namespace



  template <int dim>
  DistributedVector
  AdmissibleSpace<dim>::number_parts(
    const std::vector<unsigned int> &part_of_coarse_cell)
  {
    part_of_node.assign(node_position.size(), 0);
    for (const auto &cell : dof_handler.active_cell_iterators())
      if (!cell->is_artificial() && scene.is_present(cell->material_id()))
        for (const unsigned int v : cell->vertex_indices())
          if (const auto dof = cell->vertex_dof_index(v, 0);
              owned.is_element(dof))
            part_of_node[owned.index_within_set(dof) / dim] =
              part_of_coarse_cell[cell->id().get_coarse_cell_id()];
    DistributedVector numbers = owned_vector(), ghosted = ghosted_vector();
    for (std::size_t n = 0; n < part_of_node.size(); ++n)
      numbers.begin()[n * dim] = part_of_node[n];
    ghosted = numbers;
    return ghosted;
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::check_rigid_motions()
  {
    const BodyParts    parts       = find_parts(*this);
    const bool         are_coupled = scene.has_contact_pairs();
    const unsigned int n_together =
      (are_coupled ? parts.n : 1) * n_rigid_motions<dim>;
    std::vector<SeenMotions> seen(are_coupled ? 1 : parts.n,
                                  SeenMotions(n_together));
    const auto group = [&](const unsigned int part) {
      return are_coupled ? 0 : part;
    };
    const Point<dim>        center = this->center();
    const DistributedVector part_numbers =
      are_coupled ? number_parts(parts.of_cell) : DistributedVector();
    for (const auto &x : node_position)
      radius = std::max(radius, x.distance(center));
    radius = Utilities::MPI::max(radius, communicator);
    const MotionsOfPlace<dim> motions_of{are_coupled, center, radius};
    // A boundary node moves relative to the body opposite if there is one.
    const auto add_row_of_node = [&](SeenMotions          &to,
                                     const unsigned int    part,
                                     const BoundaryNode   &node,
                                     const Tensor<1, dim> &direction) {
      RigidMotion row(n_together, 0.);
      motions_of.add_to(row, part, node.position, direction);
      if (const auto of_node =
            couplings_of_node.find(relevant.index_within_set(node.first_dof));
          of_node != couplings_of_node.end())
        {
          const Coupling &coupling = couplings[of_node->second[0].first];
          motions_of.add_to(row,
                            static_cast<unsigned int>(
                              part_numbers.begin()[coupling.others[0].first]),
                            coupling.opposite,
                            -(coupling.projector * direction));
        }
      to.add(row);
    };
    for (std::size_t m = 0; m < nodes.size(); ++m)
      for (unsigned int i = 0; i < frames[nodes[m].frame].n_fixed; ++i)
        for (const unsigned int part : parts.of_node[m])
          add_row_of_node(seen[group(part)],
                          part,
                          nodes[m],
                          column(frames[nodes[m].frame].directions,
                                 frames[nodes[m].frame].fixed[i]));

    if (scene.is_axisymmetric())
      for (SeenMotions &of_part : seen)
        resist_as_ring(of_part, n_together);

    if (scene.has_springs())
      {
        for (SeenMotions of_part : seen) // a copy
          {
            of_part.join(communicator);
            needs_springs |= !of_part.unseen().empty();
          }
        for_each_spring(*this,
                        parts,
                        [&](const unsigned int    part,
                            const Point<dim>     &x,
                            const Tensor<1, dim> &direction) {
                          RigidMotion row(n_together, 0.);
                          motions_of.add_to(row, part, x, direction);
                          seen[group(part)].add(row);
                        });
      }

    for (SeenMotions &of_part : seen)
      {
        SeenMotions with_contact(of_part);
        of_part.join(communicator);
        const auto  free    = of_part.unseen();
        std::string motions = in_words<dim>(free);
        const bool  may_be_held_by_contact =
          seen.size() == 1 && scene.has_unilateral_contact();
        if (!motions.empty() && may_be_held_by_contact)
          {
            for (std::size_t m = 0; m < nodes.size(); ++m)
              for (unsigned int d = 0; d < dim; ++d)
                if (contact_sees(scene, frames[nodes[m].frame], d))
                  add_row_of_node(with_contact,
                                  *parts.of_node[m].begin(),
                                  nodes[m],
                                  column(frames[nodes[m].frame].directions, d));
            with_contact.join(communicator);
            motions = in_words<dim>(with_contact.unseen());
            if (motions.empty())
              free_motions = free;
          }
        if (!motions.empty())
          refuse(refusal(scene, parts.n, motions, may_be_held_by_contact));
      }
  }



  template <int dim>
  DistributedVector
  AdmissibleSpace<dim>::rigid_motion(const unsigned int motion,
                                     const unsigned int part) const
  {
    DistributedVector cartesian = owned_vector(), in_frames = owned_vector();
    const Point<dim>  center = this->center();
    for (std::size_t n = 0; n < node_position.size(); ++n)
      if (part == all_parts || part_of_node.empty() || part_of_node[n] == part)
        {
          const Tensor<1, dim> u =
            rigid_displacements<dim>(node_position[n] - center)[motion];
          for (unsigned int d = 0; d < dim; ++d)
            cartesian.begin()[n * dim + d] = u[d];
        }
    DistributedVector ghosted = ghosted_vector();
    ghosted                   = cartesian;
    to_frames(ghosted, in_frames);
    restrict_to_unknowns(in_frames);
    return in_frames;
  }



  template <int dim>
  std::vector<DistributedVector>
  AdmissibleSpace<dim>::rigid_body_modes() const
  {
    std::vector<DistributedVector> modes;
    for (unsigned int m = 0; m < n_rigid_motions<dim>; ++m)
      modes.push_back(rigid_motion(m, all_parts));
    return modes;
  }



  template <int dim>
  std::vector<DistributedVector>
  AdmissibleSpace<dim>::motions_held_by_contact() const
  {
    constexpr unsigned int         n = n_rigid_motions<dim>;
    std::vector<DistributedVector> result(free_motions.size(), owned_vector());
    if (free_motions.empty())
      return result;
    for (std::size_t a = 0; a < free_motions[0].size(); ++a)
      {
        const DistributedVector mode = rigid_motion(a % n, a / n);
        for (std::size_t i = 0; i < free_motions.size(); ++i)
          result[i].add(free_motions[i][a] / (a % n < dim ? 1. : radius), mode);
      }
    return result;
  }



  template <int dim>
  std::string
  AdmissibleSpace<dim>::name_of_motion(
    const std::vector<double> &in_free_motions) const
  {
    RigidMotion motion(free_motions[0].size(), 0.);
    double      norm_square = 0.;
    for (std::size_t a = 0; a < motion.size(); ++a)
      {
        for (std::size_t i = 0; i < free_motions.size(); ++i)
          motion[a] += in_free_motions[i] * free_motions[i][a];
        norm_square += motion[a] * motion[a];
      }
    for (double &part : motion)
      part /= std::sqrt(norm_square);
    return in_words<dim>({motion});
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, check_rigid_motions);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, number_parts);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, rigid_motion);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, rigid_body_modes);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, motions_held_by_contact);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, name_of_motion);
} // namespace Viscoplastic
