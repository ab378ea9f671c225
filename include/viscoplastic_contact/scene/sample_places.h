// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/scene/scene.h>

#include <functional>
#include <vector>

namespace Viscoplastic
{
  // About 64 sample places, spread evenly over a part of the boundary or over
  // the body, at which data are examined as functions of time. They are taken
  // from the coarse mesh, which all ranks know.

  template <int dim>
  std::vector<Point<dim>>
  places_on_boundary(const Triangulation<dim> &triangulation,
                     const types::boundary_id  id);

  template <int dim>
  std::vector<Point<dim>>
  places_in_body(const Triangulation<dim> &triangulation);

  /// Return the values of a datum at the places at time t; a single value if it
  /// does not depend on position.
  template <int dim>
  std::vector<double>
  values_at(const Expression<dim>         &datum,
            const std::vector<Point<dim>> &places,
            const double                   t);

  /// Call @p visit for each load, displacement, datum of friction and
  /// temperature that depends on time, with sample places where it acts.
  template <int dim>
  void
  for_each_datum_in_time(
    const Scene<dim>         &scene,
    const Triangulation<dim> &triangulation,
    const std::function<void(const Expression<dim>         &datum,
                             const std::vector<Point<dim>> &places)> &visit);
} // namespace Viscoplastic
