// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/discretization/admissible_space.h>

namespace Viscoplastic
{
  /// Squared jumps of the displacement gradient, weighted by the cell size
  /// (Kelly, Gago, Zienkiewicz and Babuska, Int. J. Numer. Methods Eng. 19,
  /// 1983); the layout of ResidualEstimator::estimate().
  template <int dim>
  Vector<double>
  kelly_estimate(const AdmissibleSpace<dim> &space,
                 const DistributedVector    &ghosted_u);

  /// The norm of the strains at the midpoints of cells, which is the size of
  /// jumps that Kelly's estimate is small or large against. Collective.
  template <int dim>
  double
  strain_norm(const AdmissibleSpace<dim> &space,
              const DistributedVector    &ghosted_u);

  /// The sum of the values of all cells, by active index, and that of their
  /// sizes; rounded alike however the mesh came about. Zero without values, on
  /// all ranks. Collective.
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
