// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/affine_constraints.h>

#include <viscoplastic_contact/discretization/mortar_interpolation.h>
#include <viscoplastic_contact/scene/scene.h>

#include <cstdint>
#include <map>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// The conditions of displacement and contact, those of supports last, and
  /// for each owned node the bits of the conditions that it carries.
  template <int dim>
  struct ConditionsAtNodes
  {
    std::vector<const BoundaryCondition<dim> *> conditions;
    std::vector<std::uint64_t>                  mask;
    /// Whether a node belongs to absent materials only, and to contact in
    /// another stage: it stays where it is, or follows the body opposite. Empty
    /// if contact is the same in all stages.
    std::vector<bool> waits;
  };

  /// Return which conditions the nodes of a mesh carry: those of their boundary
  /// faces, except those of absent materials at nodes of the body, contact of
  /// absent materials, contact with another body where nothing lies opposite,
  /// and all conditions at hanging nodes. @p node_position: of each owned node.
  /// Owners know all ids at their nodes, since every neighbor of an owned cell
  /// is at least a ghost. Throws ExcMessage where there are more than 52
  /// conditions.
  template <int dim>
  ConditionsAtNodes<dim>
  conditions_at_nodes(
    const DoFHandler<dim>                          &dof_handler,
    const Scene<dim>                               &scene,
    const AffineConstraints<double>                &hanging_nodes,
    const std::map<types::boundary_id, MortarRows> &mortar_rows,
    const std::vector<Point<dim>>                  &node_position);
} // namespace Viscoplastic
