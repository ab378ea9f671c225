// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/geometry_info.h>
#include <deal.II/base/mpi.h>
#include <deal.II/numerics/rtree.h>

#include <viscoplastic_contact/discretization/plane_faces.h>
#include <viscoplastic_contact/discretization/surface_normals.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>

#include <boost/serialization/array.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

namespace Viscoplastic
{
  /// A face of the primary side, to send to other ranks. Each vertex has its
  /// independent node, or the parents of a hanging node with their weights.
  template <int dim>
  struct PrimaryFace : SurfaceFace<dim>
  {
    std::array<std::vector<NodeHierarchy::Parent>, SurfaceFace<dim>::n> nodes;
    double softness = 0.;

    template <class Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      archive &this->vertices &this->normals &this->lifts &nodes &softness;
    }
  };



  /// The faces of two boundaries in contact, and which of them may lie opposite
  /// to each other.
  template <int dim>
  class InterfaceSides
  {
  public:
    using Node = NodeHierarchy::Node;
    using Row  = std::vector<NodeHierarchy::Parent>;

    static constexpr unsigned int d = dim - 1;
    static constexpr unsigned int n = GeometryInfo<dim>::vertices_per_face;

    InterfaceSides(const DoFHandler<dim>           &dof_handler,
                   const AffineConstraints<double> &hanging,
                   const ContactPair<dim>          &pair)
      : dof_handler(dof_handler)
      , hanging(hanging)
      , pair(pair)
      , project(pair.normals != nullptr ? Point<dim>::unit_vector(0) :
                                          pair.normal)
      , communicator(dof_handler.get_communicator())
      , owned(dof_handler.locally_owned_dofs())
    {
      const Node n_nodes = dof_handler.n_dofs() / dim;
      // Ranks without nodes begin where the next one does.
      begins = Utilities::MPI::all_gather(communicator,
                                          owned.n_elements() > 0 ?
                                            owned.nth_index_in_set(0) / dim :
                                            n_nodes);
      begins.push_back(n_nodes);
      for (std::size_t r = begins.size() - 1; r-- > 0;)
        begins[r] = std::min(begins[r], begins[r + 1]);
    }

    /// Call @p act (cell, face) for the faces with boundary id @p id on owned
    /// and ghost cells; of flat sides those with an outward normal along
    /// @p sign times that of the pair.
    template <typename Action>
    void
    for_each_face(const types::boundary_id id,
                  const double             sign,
                  const Action            &act) const
    {
      for (const auto &cell : dof_handler.active_cell_iterators())
        if (!cell->is_artificial())
          for (const unsigned int f : cell->face_indices())
            if (cell->at_boundary(f) && cell->face(f)->boundary_id() == id &&
                ((id == pair.primary && pair.of_absent) ||
                 pair.scene.is_present(cell->material_id()) !=
                   pair.of_absent) &&
                (pair.normals != nullptr ||
                 sign * ((cell->face(f)->center() - cell->center()) *
                         pair.normal) >
                   0.))
              act(cell, f);
    }

    template <typename Cell>
    Node
    node_at(const Cell &cell, const unsigned int f, const unsigned int v) const
    {
      return cell->face(f)->vertex_dof_index(v, 0) / dim;
    }

    bool
    owns(const Node node) const
    {
      return owned.is_element(node * dim);
    }

    bool
    hangs(const Node node) const
    {
      return hanging.is_constrained(node * dim);
    }

    unsigned int
    owner(const Node node) const
    {
      return std::upper_bound(begins.begin(), begins.end(), node) -
             begins.begin() - 1;
    }

    Row
    resolve(const Node node) const
    {
      if (!hangs(node))
        return {{node, 1.}};
      Row result;
      for (const auto &[dof, weight] :
           *hanging.get_constraint_entries(node * dim))
        result.push_back({dof / dim, weight});
      return result;
    }

    template <typename Cell>
    SurfaceFace<dim>
    surface_face(const Cell &cell, const unsigned int f) const
    {
      if (pair.normals != nullptr)
        return pair.normals->face(cell, f);
      SurfaceFace<dim> result;
      for (unsigned int v = 0; v < n; ++v)
        result.vertices[v] = cell->face(f)->vertex(v);
      result.normals.fill(pair.normal);
      return result;
    }

    /// The key of a place in the search: for flat sides its projection onto the
    /// interface plane.
    Point<dim>
    place_of(const Point<dim> &x) const
    {
      if (pair.normals != nullptr)
        return x;
      Point<dim>     result;
      const Point<d> in_plane = project(x);
      for (unsigned int i = 0; i < d; ++i)
        result[i] = in_plane[i];
      return result;
    }

    BoundingBox<dim>
    box_before(const Point<dim>     &x,
               const Tensor<1, dim> &normal,
               const double          reach) const
    {
      return BoundingBox<dim>(
        std::vector<Point<dim>>{place_of(x - reach * normal),
                                place_of(x + reach * normal)});
    }

    BoundingBox<dim>
    box_before(const SurfaceFace<dim> &face) const
    {
      const double reach =
        pair.normals != nullptr ? SurfaceNormals<dim>::reach(face) : 0.;
      BoundingBox<dim> result =
        box_before(face.vertices[0], face.normals[0], reach);
      for (unsigned int v = 1; v < n; ++v)
        result.merge_with(box_before(face.vertices[v], face.normals[v], reach));
      return result;
    }

    BoundingBox<dim>
    box_of(const SurfaceFace<dim> &face) const
    {
      std::vector<Point<dim>> places;
      for (const Point<dim> &x : face.vertices)
        places.push_back(place_of(x));
      return BoundingBox<dim>(places);
    }

    /// Whether the outward normal of a face of the other side is opposite to
    /// @p normal, by a cosine below -0.2. Always true of flat sides.
    bool
    faces(const Tensor<1, dim> &normal, const SurfaceFace<dim> &other) const
    {
      if (pair.normals == nullptr)
        return true;
      return normal * other.normal(reference_center<d>()) < -0.2;
    }

    /// The faces of the primary side that may lie opposite to owned faces of
    /// the secondary one. Collective.
    template <typename Softness>
    std::vector<PrimaryFace<dim>>
    primary_faces(const Softness &softness) const
    {
      std::vector<BoundingBox<dim>> here;
      for_each_face(pair.secondary,
                    1.,
                    [&](const auto &cell, const unsigned int f) {
                      if (!cell->is_locally_owned())
                        return;
                      const auto box = box_before(surface_face(cell, f));
                      if (here.empty())
                        here.push_back(box);
                      else
                        here[0].merge_with(box);
                    });
      const auto boxes = Utilities::MPI::all_gather(communicator, here);

      std::map<unsigned int, std::vector<PrimaryFace<dim>>> to_send;
      for_each_face(
        pair.primary, -1., [&](const auto &cell, const unsigned int f) {
          if (!cell->is_locally_owned())
            return;
          PrimaryFace<dim> face;
          static_cast<SurfaceFace<dim> &>(face) = surface_face(cell, f);
          const BoundingBox<dim> box            = box_of(face);
          bool                   is_complete    = false;
          for (unsigned int rank = 0; rank < boxes.size(); ++rank)
            if (!boxes[rank].empty() && boxes[rank][0].get_neighbor_type(box) !=
                                          NeighborType::not_neighbors)
              {
                if (!is_complete)
                  {
                    face.softness = softness(cell, f);
                    for (unsigned int v = 0; v < n; ++v)
                      face.nodes[v] = resolve(node_at(cell, f, v));
                    is_complete = true;
                  }
                to_send[rank].push_back(face);
              }
        });
      std::vector<PrimaryFace<dim>> result;
      for (const auto &received :
           Utilities::MPI::some_to_some(communicator, to_send))
        result.insert(result.end(),
                      received.second.begin(),
                      received.second.end());
      return result;
    }

    auto
    tree_of(const std::vector<PrimaryFace<dim>> &faces) const
    {
      std::vector<std::pair<BoundingBox<dim>, std::size_t>> boxes;
      for (std::size_t i = 0; i < faces.size(); ++i)
        {
          BoundingBox<dim> box = box_of(faces[i]);
          box.extend(1e-10 * box.side_length(0)); // see contains()
          boxes.emplace_back(box, i);
        }
      return pack_rtree(boxes);
    }

    const DoFHandler<dim>           &dof_handler;
    const AffineConstraints<double> &hanging;
    const ContactPair<dim>          &pair;
    const Projection<dim>            project;
    const MPI_Comm                   communicator;
    const IndexSet                   owned;
    std::vector<Node>                begins;
  };
} // namespace Viscoplastic
