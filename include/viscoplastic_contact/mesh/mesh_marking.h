// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/parameters/parameters.h>

#include <functional>

namespace Viscoplastic
{
  /// Flag the cells that make up the given fractions of the squared estimate
  /// for refinement and coarsening (bulk criterion), within the limits on
  /// levels and number of cells, and prepare the change of the mesh. If the
  /// cell budget would be exceeded, cells with the smallest estimates are not
  /// refined; refinement for the balance of the mesh may still exceed it.
  ///
  /// All flags are cleared if the change would hardly matter: if the cells to
  /// be refined have less than the smallest share s of the squared estimate, so
  /// that the next estimate cannot be less than sqrt(1-s) times the present
  /// one, and the number of cells would not decrease by a tenth.
  ///
  /// @p squared_estimate has an entry for each active cell, of which those of
  /// owned cells are read. @p limit_coarsening may clear coarsening flags
  /// before. Returns whether the mesh will change on any rank. Collective.
  template <int dim>
  bool
  mark_cells(parallel::distributed::Triangulation<dim> &triangulation,
             const Vector<double>                      &squared_estimate,
             const RefinementParameters                &parameters,
             const std::function<void()>               &limit_coarsening = {});


  /// The same for a mesh whose estimate is @p ratio times the tolerance.
  ///
  /// Above 1, as many cells are refined as are expected to bring the estimate
  /// below 0.85 times the tolerance if halved cells have a quarter of the
  /// squared estimate, but at most those with 0.6 of it, since estimates on
  /// finer meshes choose better. The cells with the smallest estimates are
  /// coarsened at the same time. If the limits leave less than a tenth of the
  /// squared estimate to be refined, the mesh stays. Below 0.6, cells are
  /// coarsened up to the same aim, if that removes a tenth of them. In between
  /// the mesh stays. Nothing is coarsened without @p limit_coarsening.
  ///
  /// Only the levels and the cell budget of @p parameters are used. Collective.
  template <int dim>
  bool
  mark_cells_to_tolerance(
    parallel::distributed::Triangulation<dim> &triangulation,
    const Vector<double>                      &squared_estimate,
    const RefinementParameters                &parameters,
    const double                               ratio,
    const std::function<void()>               &limit_coarsening = {});
} // namespace Viscoplastic
