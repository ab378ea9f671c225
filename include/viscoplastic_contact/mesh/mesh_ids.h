// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters/parameters.h>

#include <map>
#include <set>

namespace Viscoplastic
{
  using namespace dealii;

  /// Set the ids of the coarse mesh from the expressions `Geometry/Boundary
  /// ids' and `Geometry/Material ids', if given. Throws ExcMessage with a
  /// sentence for the user.
  template <int dim>
  void
  set_ids(const GeometryParameters                  &geometry,
          parallel::distributed::Triangulation<dim> &triangulation);

  /// Return the boundary ids of the coarse mesh, which all ranks know.
  template <int dim>
  std::set<types::boundary_id>
  boundary_ids(const parallel::distributed::Triangulation<dim> &triangulation);

  /// Return the boundary ids at each coarse vertex, by the index of the vertex.
  template <int dim>
  std::map<unsigned int, std::set<types::boundary_id>>
  boundaries_at_vertices(const Triangulation<dim> &triangulation);

  /// Return the pairs of boundary ids, in both orders, that share a vertex of
  /// the coarse mesh; each id is also paired with itself.
  template <int dim>
  std::set<std::pair<types::boundary_id, types::boundary_id>>
  touching_boundaries(const Triangulation<dim> &triangulation);

  /// Return the material ids of the coarse mesh, which all ranks know.
  template <int dim>
  std::set<types::material_id>
  material_ids(const parallel::distributed::Triangulation<dim> &triangulation);



  /// The mean outward normal of faces with one id, and their deviation from it.
  template <int dim>
  struct PieceNormal
  {
    /// The outward normal of unit length; exact for pieces along coordinate
    /// planes.
    Tensor<1, dim> normal;
    /// The largest angle between it and the normals of the faces, in degrees.
    double deviation;
  };

  /// Return the area-weighted mean normal of the boundary faces with this @p
  /// id. If the normals cancel, as all around a body, the mean is zero and the
  /// deviation 180. Collective.
  template <int dim>
  PieceNormal<dim>
  piece_normal(const parallel::distributed::Triangulation<dim> &triangulation,
               const types::boundary_id                         id);

  /// Return the largest angle in degrees between the normals of faces with this
  /// @p id that share a vertex. Collective.
  template <int dim>
  double
  largest_angle(const parallel::distributed::Triangulation<dim> &triangulation,
                const types::boundary_id                         id);

  /// Return whether the outward normal of any face with this @p id has a
  /// positive component in @p direction. Collective.
  template <int dim>
  bool
  faces_towards(const parallel::distributed::Triangulation<dim> &triangulation,
                const types::boundary_id                         id,
                const Tensor<1, dim>                            &direction);
} // namespace Viscoplastic
