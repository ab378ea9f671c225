// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/discretization/admissible_space.h>

namespace Viscoplastic
{
  /// Return squared jumps of the displacement gradient, weighted by the cell
  /// size (Kelly, Gago, Zienkiewicz and Babuska, Int. J. Numer. Methods Eng.
  /// 19, 1983), by active cell; zero on cells of other ranks. Collective.
  template <int dim>
  Vector<double>
  kelly_estimate(const AdmissibleSpace<dim> &space,
                 const DistributedVector    &ghosted_u);

  /// Return the L2 norm of the strain by the midpoint rule, the reference size
  /// for the jumps in Kelly's estimate. Collective.
  template <int dim>
  double
  strain_norm(const AdmissibleSpace<dim> &space,
              const DistributedVector    &ghosted_u);

  /// Return the sum of @p values, by active cell, and that of their absolute
  /// values over all cells, in an order that depends on the mesh alone. Zero if
  /// @p values is empty on all ranks. Collective.
  template <int dim>
  std::array<double, 2>
  sum_over_cells(const Vector<double>     &values,
                 const Triangulation<dim> &triangulation);

  /// The root of the sum of the squares of all cells. Collective.
  template <int dim>
  double
  total_estimate(const Vector<double>     &squared_estimate,
                 const Triangulation<dim> &triangulation);
} // namespace Viscoplastic
