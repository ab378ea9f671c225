// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/grid/tria.h>

#include <viscoplastic_contact/base/expression.h>

#include <vector>

namespace Viscoplastic
{
  // Places that stand for a piece of the boundary or for the body, where data
  // are looked at as functions of time: about 64, spread evenly over the coarse
  // mesh, which all ranks know.

  template <int dim>
  std::vector<Point<dim>>
  places_on_boundary(const Triangulation<dim> &triangulation,
                     const types::boundary_id  id);

  template <int dim>
  std::vector<Point<dim>>
  places_in_body(const Triangulation<dim> &triangulation);

  /// The values of a datum at places, all at a time; at one place if these do
  /// not matter.
  template <int dim>
  std::vector<double>
  values_at(const Expression<dim>         &datum,
            const std::vector<Point<dim>> &places,
            const double                   t);
} // namespace Viscoplastic
