// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/affine_constraints.h>

#include <viscoplastic_contact/discretization/surface_normals.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>

#include <functional>
#include <map>
#include <vector>

namespace Viscoplastic
{
  /// The nodes of the primary boundary and their weights in the displacement
  /// opposite to a node of the secondary one. Nodes have the numbers of
  /// NodeHierarchy.
  struct MortarRow
  {
    std::vector<NodeHierarchy::Parent> nodes;
    /// The distance between the two curved surfaces beyond that between their
    /// plane faces at the node.
    double bulge = 0.;
  };

  using MortarRows = std::map<NodeHierarchy::Node, MortarRow>;


  /// The interpolation Q of the trace v of the primary side at the nodes p of
  /// the secondary side by dual basis functions psi_p, which are biorthogonal
  /// to the nodal ones phi_q on each face e,
  ///
  ///     (Q v)_p = sum_e int_e psi_p v / int phi_p,
  ///     int_e psi_p phi_q = delta_pq int_e phi_p
  ///
  /// (Wohlmuth, SIAM J. Numer. Anal. 38, 2000). v is taken where the normal at
  /// a place of e meets the primary side, and e is cut along that side's faces;
  /// integrals are exact for flat faces that are parallelograms. With a hanging
  /// node h between a and b, (Q v)_a becomes
  ///
  ///     (Q v)_a + sum_h c_h ((Q v)_h - (Q v)_a/2 - (Q v)_b/2),
  ///     c_h = D_h/(D_a + D_b),
  ///
  /// where D are the integrals of the basis functions, for a and b of those
  /// that hanging-node constraints leave. So linear v are exact, and sum_p D_p
  /// (Q v)_p is the integral of v: rigid motions meet no resistance, and a
  /// constant pressure passes the interface as it is.
  ///
  /// Returns the rows of independent nodes among the locally relevant ones,
  /// except those with nothing opposite to some part of their support.
  /// Collective.
  template <int dim>
  MortarRows
  mortar_interpolation(const DoFHandler<dim>           &dof_handler,
                       const AffineConstraints<double> &hanging_nodes,
                       const ContactPair<dim>          &pair);



  /// A place on a face of the secondary boundary, the normal there, and how far
  /// along it the other side may be; see SurfaceNormals.
  template <int dim>
  struct InterfacePlace
  {
    Point<dim>     position;
    Tensor<1, dim> normal;
    double         reach;
  };


  /// The place of the primary boundary opposite to a place of the secondary one
  /// along the normal: the nodes and weights of its displacement, the vector to
  /// it, and the softness of its face.
  template <int dim>
  struct PlaceOpposite
  {
    /// The nodes and weights of the displacement at the opposite place; empty
    /// if nothing lies opposite.
    std::vector<NodeHierarchy::Parent> nodes;
    Tensor<1, dim>                     distance;
    double                             softness = 0.;
  };

  /// The places opposite to points on owned faces of the secondary boundary; @p
  /// softness is evaluated on owned primary faces. Collective.
  template <int dim>
  std::vector<PlaceOpposite<dim>>
  places_opposite(const DoFHandler<dim>                  &dof_handler,
                  const AffineConstraints<double>        &hanging_nodes,
                  const ContactPair<dim>                 &pair,
                  const std::vector<InterfacePlace<dim>> &places,
                  const std::function<double(
                    const typename DoFHandler<dim>::active_cell_iterator &,
                    const unsigned int)>                 &softness);
} // namespace Viscoplastic
