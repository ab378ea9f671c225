// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/parameters/parameters.h>

#include <functional>

namespace Viscoplastic
{
  /// Mark the cells that make up the given fractions of the squared estimate,
  /// within the limits of level and number of cells, and prepare the change of
  /// the mesh. Of cells beyond the budget the ones with the smallest estimate
  /// stay as they are; the budget may be exceeded by the cells that keep
  /// neighbors within one level of each other.
  ///
  /// Nothing stays marked if that would change (almost) nothing: while the
  /// cells to be refined have less than the smallest share s of the squared
  /// estimate, so that the estimate of the next mesh cannot be less than
  /// sqrt(1-s) of the present one, and the number of cells would not fall by a
  /// tenth.
  ///
  /// @p squared_estimate has an entry for each active cell, of which those of
  /// owned cells are read. @p limit_coarsening may withdraw marks for
  /// coarsening before that is decided. Returns whether the mesh will change on
  /// any rank. Collective.
  template <int dim>
  bool
  mark_cells(parallel::distributed::Triangulation<dim> &triangulation,
             const Vector<double>                      &squared_estimate,
             const RefinementParameters                &parameters,
             const std::function<void()>               &limit_coarsening = {});


  /// The same for a mesh whose estimate is @p ratio times what it may be.
  ///
  /// Above 1, as many cells are refined as are expected to bring the estimate
  /// below 0.85 of what it may be, halved cells having a quarter of the squared
  /// estimate, but at most those with 0.6 of it: estimates of finer meshes know
  /// better which cells to refine next. Cells that matter least are coarsened
  /// with them. Where the bounds leave less than a tenth of the squared
  /// estimate to be refined, a new mesh is not worth its price. Below 0.6,
  /// cells are coarsened up to that aim, if that removes a tenth of them. In
  /// between the mesh stays. Nothing is coarsened without
  /// @p limit_coarsening.
  ///
  /// Only levels and number of cells of @p parameters count. Collective.
  template <int dim>
  bool
  mark_cells_to_tolerance(
    parallel::distributed::Triangulation<dim> &triangulation,
    const Vector<double>                      &squared_estimate,
    const RefinementParameters                &parameters,
    const double                               ratio,
    const std::function<void()>               &limit_coarsening = {});
} // namespace Viscoplastic
