// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/affine_constraints.h>

#include <viscoplastic_contact/discretization/contact_pair.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>

#include <functional>
#include <vector>

namespace Viscoplastic
{
  /// A place on a face of the secondary boundary, the normal there, and how far
  /// along it the other side may be; see SurfaceNormals.
  template <int dim>
  struct InterfacePlace
  {
    Point<dim>     position;
    Tensor<1, dim> normal;
    double         reach;
  };


  /// What lies opposite to a place of the secondary boundary along the normal:
  /// a place of the primary one, where the displacement is the sum of those of
  /// nodes with weights, the way there, and what softness() has for the face.
  template <int dim>
  struct PlaceOpposite
  {
    /// The nodes and weights of the displacement at the opposite place; empty
    /// if nothing lies opposite.
    std::vector<NodeHierarchy::Parent> nodes;
    Tensor<1, dim>                     distance;
    double                             softness = 0.;
  };

  /// For places on the faces of the secondary boundary that this rank owns.
  /// @p softness is asked for owned faces of the primary one. Collective.
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
