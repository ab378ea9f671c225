// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/scene/scene.h>

namespace Viscoplastic
{
  template <int dim>
  struct SurfaceFace;


  /// Outward normals at the nodes of curved boundaries, of both sides, on which
  /// two bodies are in contact: sums of those of adjacent faces, each weighted
  /// by 1/length in the plane, and in space by the sine of the face's angle at
  /// the node over the product of its edges there (Max, J. Graphics Tools 4,
  /// 1999), which is exact where vertices lie on a circle or sphere. On a plane
  /// of symmetry, normals are those of the body with its mirror image. Hanging
  /// nodes have the mean of their parents' normals, and are lifted to the
  /// surface, see SurfaceFace::bulge().
  template <int dim>
  class SurfaceNormals
  {
  public:
    /// Collective.
    SurfaceNormals(const DoFHandler<dim>           &dof_handler,
                   const AffineConstraints<double> &hanging_nodes,
                   const Scene<dim>                &scene);

    /// The normal at a locally relevant node, by its first degree of freedom.
    Tensor<1, dim>
    at(const types::global_dof_index first_dof) const;

    /// A face of these boundaries on an owned cell or a ghost.
    SurfaceFace<dim>
    face(const typename DoFHandler<dim>::cell_iterator &cell,
         const unsigned int                             f) const;

    /// How far along the normals of a face to look for the other side: half of
    /// the radius of curvature, at which normals meet.
    static double
    reach(const SurfaceFace<dim> &face);

  private:
    /// Set normals and lifts of hanging nodes from their parents. Collective.
    void
    lift(const std::map<types::global_dof_index, Point<dim>> &positions,
         const AffineConstraints<double>                     &hanging_nodes);

    LinearAlgebra::distributed::Vector<double> normals, lifts;
  };



  /// Two boundaries in contact with each other. Multipliers belong to the nodes
  /// of the secondary one, whose outward normal is `normal`; where it is
  /// curved, `normals` has those at the nodes of both instead. Faces of absent
  /// materials belong to neither.
  template <int dim>
  struct ContactPair
  {
    types::boundary_id         secondary, primary;
    Tensor<1, dim>             normal;
    const SurfaceNormals<dim> *normals;
    const Scene<dim>          &scene;
    /// Whether this is the pair of the absent secondary faces and the whole
    /// primary side, which they follow until they are added.
    bool of_absent = false;
  };
} // namespace Viscoplastic
