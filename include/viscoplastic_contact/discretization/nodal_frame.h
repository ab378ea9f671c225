// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <viscoplastic_contact/scene/scene.h>

#include <array>
#include <vector>

namespace Viscoplastic
{
  /// The slip that one friction point can make. At a node where Gamma_3 is flat
  /// this is the tangent plane. Where pieces meet at an angle each piece has a
  /// point, whose slip is the part of the piece's tangential displacement that
  /// the other conditions at the node leave free. Pieces whose foundations move
  /// in different ways have a point each, too.
  template <int dim>
  struct FrictionPlane
  {
    /// Number of independent slip directions, 1 or 2.
    unsigned int n_tangents;
    /// slip = map u: n_tangents rows over the frame components of the node.
    std::array<Tensor<1, dim>, dim - 1> map;
    /// Boundary ids whose bounds add up here (coplanar pieces, or pieces that
    /// leave the same direction free); their foundations move alike.
    std::vector<types::boundary_id> boundary_ids;
  };


  /// A plane of the foundation that a node must not pass: the parts of the
  /// node's normal displacement that other conditions leave free and prescribe.
  template <int dim>
  struct Obstacle
  {
    /// u_n = map u + fixed u: rows over the frame components of the node; `map`
    /// is zero for fixed components, `fixed` for free ones.
    Tensor<1, dim> map, fixed;
    /// Boundary ids with this normal; either all or none are compliant.
    std::vector<types::boundary_id> boundary_ids;
    bool                            is_compliant = false;
  };


  /// The orthonormal frame of displacement components at a node, chosen so that
  /// conditions fix single components.
  template <int dim>
  struct NodalFrame
  {
    /// Columns are the frame's directions; the identity wherever conditions
    /// are along coordinate axes.
    Tensor<2, dim> directions;
    bool           is_cartesian = true;
    /// The first n_fixed entries of `fixed` are prescribed components.
    std::array<unsigned int, dim> fixed;
    unsigned int                  n_fixed = 0;
    /// The accepted conditions direction . u = datum, n_fixed in number, which
    /// may be oblique to each other (see condition_matrix()): their directions,
    /// and the boundary id and component of the datum
    /// (numbers::invalid_unsigned_int if it belongs to a normal).
    std::array<Tensor<1, dim>, dim>     condition_direction;
    std::array<types::boundary_id, dim> condition_boundary;
    std::array<unsigned int, dim>       condition_component;
    std::vector<FrictionPlane<dim>>     planes;
    std::vector<Obstacle<dim>>          obstacles;
  };


  /// The frame of a node where @p conditions meet (in the order of their ids).
  /// Where conditions compete, those that fix more come first: clamped, given
  /// components, glued, symmetry, bilateral contact, supports, glued to another
  /// body; a condition whose direction depends on the others is dropped.
  /// Conditions on curved boundaries have the normal @p varying_normal here.
  template <int dim>
  NodalFrame<dim>
  make_nodal_frame(
    const std::vector<const BoundaryCondition<dim> *> &conditions,
    const Tensor<1, dim>                              &varying_normal = {});


  /// M_ij = (direction of condition i) . (direction of fixed component j),
  /// padded by the identity: the fixed components a satisfy M a = data, and
  /// constraint forces r in the fixed components are made of M^-T r along the
  /// directions of the conditions.
  template <int dim>
  Tensor<2, dim>
  condition_matrix(const NodalFrame<dim> &frame);


  /// Column @p j of a matrix: a direction of a frame.
  template <int dim>
  Tensor<1, dim>
  column(const Tensor<2, dim> &matrix, const unsigned int j)
  {
    Tensor<1, dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      result[i] = matrix[i][j];
    return result;
  }
} // namespace Viscoplastic
