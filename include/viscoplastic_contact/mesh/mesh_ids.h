// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters/parameters.h>

#include <map>
#include <set>

namespace Viscoplastic
{
  using namespace dealii;

  /// Give the coarse mesh the ids of the expressions `Geometry/Boundary ids'
  /// and `Geometry/Material ids', if there are any. Throws ExcMessage with a
  /// sentence for the user.
  template <int dim>
  void
  set_ids(const GeometryParameters                  &geometry,
          parallel::distributed::Triangulation<dim> &triangulation);

  /// Return the boundary ids of the coarse mesh, which all ranks know.
  template <int dim>
  std::set<types::boundary_id>
  boundary_ids(const parallel::distributed::Triangulation<dim> &triangulation);

  /// The ids of the boundaries at each vertex of the coarse mesh, by the index
  /// of the vertex.
  template <int dim>
  std::map<unsigned int, std::set<types::boundary_id>>
  boundaries_at_vertices(const Triangulation<dim> &triangulation);

  /// The pairs of ids of boundaries, either first, that have a vertex of the
  /// coarse mesh in common.
  template <int dim>
  std::set<std::pair<types::boundary_id, types::boundary_id>>
  touching_boundaries(const Triangulation<dim> &triangulation);

  /// Return the material ids of the coarse mesh, which all ranks know.
  template <int dim>
  std::set<types::material_id>
  material_ids(const parallel::distributed::Triangulation<dim> &triangulation);



  /// The mean outward normal of the boundary faces with one id, which tells
  /// how far they are from a plane.
  template <int dim>
  struct PieceNormal
  {
    /// The outward normal of unit length; exact for pieces along coordinate
    /// planes.
    Tensor<1, dim> normal;
    /// The largest angle between it and the normals of the faces, in degrees.
    double deviation;
  };

  /// Return the mean normal of the boundary faces with this @p id, each
  /// weighted by its area. Where normals cancel, as all around a body, it is
  /// zero and the deviation 180. Collective.
  template <int dim>
  PieceNormal<dim>
  piece_normal(const parallel::distributed::Triangulation<dim> &triangulation,
               const types::boundary_id                         id);

  /// The largest angle between the normals of faces with this @p id that share
  /// a vertex, in degrees. Collective.
  template <int dim>
  double
  largest_angle(const parallel::distributed::Triangulation<dim> &triangulation,
                const types::boundary_id                         id);

  /// Whether any face with this @p id looks, by its outward normal, into a @p
  /// direction. Collective.
  template <int dim>
  bool
  faces_towards(const parallel::distributed::Triangulation<dim> &triangulation,
                const types::boundary_id                         id,
                const Tensor<1, dim>                            &direction);
} // namespace Viscoplastic
