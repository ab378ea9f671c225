// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/grid/tria.h>

#include <functional>
#include <limits>
#include <set>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  template <int dim>
  struct CellPoint
  {
    static constexpr std::size_t elsewhere =
      std::numeric_limits<std::size_t>::max();

    /// The cell by its number in owned_cells(); elsewhere on all ranks but the
    /// one that owns it.
    std::size_t cell = elsewhere;
    Point<dim>  unit;
    /// The face of the cell that it has been looked for on, if any.
    unsigned int face = numbers::invalid_unsigned_int;

    bool
    is_mine() const
    {
      return cell != elsewhere;
    }
  };


  /// The cells and reference coordinates of points on a mesh and, on all ranks,
  /// the points outside of it.
  template <int dim>
  struct PointLocations
  {
    std::vector<CellPoint<dim>> points;
    /// The distance of each point from its place in the mesh; 0 inside.
    std::vector<double> distances;
  };


  /// Whether to look into cells of a material; empty for all.
  using MaterialFilter = std::function<bool(const types::material_id)>;

  /// Find the cells of some points; of several cells that a point is on, the
  /// one whose center has the least coordinates, x first, which does not depend
  /// on the number of ranks. Cells of materials that are not @p is_preferred
  /// count only where there is no other. For a point outside of the mesh it is
  /// the place on its boundary that is nearest. Collective.
  template <int dim>
  PointLocations<dim>
  locate_points(const Triangulation<dim>      &triangulation,
                const std::vector<Point<dim>> &points,
                const MaterialFilter          &is_preferred = {});

  /// Find the faces of some boundaries that points are on; of several ones that
  /// whose center has the least coordinates. Points that are on none are
  /// elsewhere on all ranks, and have a positive distance. Collective.
  template <int dim>
  PointLocations<dim>
  locate_on_boundary(const Triangulation<dim>           &triangulation,
                     const std::vector<Point<dim>>      &points,
                     const std::set<types::boundary_id> &ids);


  /// Throws ExcMessage that names @p entry and the nearest place unless all of
  /// some points are in the mesh. Collective.
  template <int dim>
  void
  check_points(const Triangulation<dim>      &triangulation,
               const std::vector<Point<dim>> &points,
               const std::string             &entry);
} // namespace Viscoplastic
