// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/scene/boundary_condition.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Supports have ids beyond those of boundaries, so that conditions and
  /// reactions of both are addressed alike.
  constexpr types::boundary_id first_support_id = largest_id + 1,
                               first_edge_id    = 2 * first_support_id;

  /// The name of a boundary or a support in columns: `3', `point0', `edge1'.
  std::string
  name_in_columns(const types::boundary_id id);


  /// Nodes at which some components of u are zero: a vertex of the coarse mesh,
  /// which every mesh has, or the nodes where boundaries meet.
  template <int dim>
  struct Support
  {
    /// The place of the support in words.
    std::string place;
    /// The position of a support at a point: as given, and that of the nearest
    /// vertex after place_supports().
    std::optional<Point<dim>> position;
    /// The boundaries whose intersection is supported; empty for points.
    std::set<types::boundary_id> boundaries;
    /// The condition, with role displacement and the held components.
    BoundaryCondition<dim> condition;
  };


  /// Read the section `Supports'. Throws ExcMessage.
  template <int dim>
  std::vector<Support<dim>>
  read_supports(const SupportParameters &parameters);


  /// Find the vertices of supports at points and check that boundaries of the
  /// others meet. Returns warnings, one sentence each. Throws ExcMessage.
  template <int dim>
  std::vector<std::string>
  place_supports(
    const parallel::distributed::Triangulation<dim>            &triangulation,
    const std::map<types::boundary_id, BoundaryCondition<dim>> &boundary,
    std::vector<Support<dim>>                                  &supports);
} // namespace Viscoplastic
