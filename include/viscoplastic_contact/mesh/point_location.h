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

    /// The cell by its number in owned_cells(); `elsewhere' on all other ranks.
    std::size_t cell = elsewhere;
    Point<dim>  unit;
    /// The face of the cell on which the point has been searched for, if any.
    unsigned int face = numbers::invalid_unsigned_int;

    bool
    is_mine() const
    {
      return cell != elsewhere;
    }
  };


  /// The cells and reference coordinates of points on a mesh and, on all ranks,
  /// the distances of points outside of it.
  template <int dim>
  struct PointLocations
  {
    std::vector<CellPoint<dim>> points;
    /// The distance of each point from its place in the mesh; 0 inside.
    std::vector<double> distances;
  };


  /// Whether cells of a material are preferred; an empty function prefers all.
  using MaterialFilter = std::function<bool(const types::material_id)>;

  /// Find the cells of some points. Among several cells that contain a point,
  /// the one whose center has the least coordinates (x first) is chosen,
  /// independently of the number of ranks. Cells of materials that are not @p
  /// is_preferred count only if there is no other. A point outside of the mesh
  /// is replaced by the nearest place on the boundary. Collective.
  template <int dim>
  PointLocations<dim>
  locate_points(const Triangulation<dim>      &triangulation,
                const std::vector<Point<dim>> &points,
                const MaterialFilter          &is_preferred = {});

  /// Find the faces of some boundaries that contain points; among several
  /// faces, the one whose center has the least coordinates. Points on none of
  /// them are `elsewhere' on all ranks and have a positive distance.
  /// Collective.
  template <int dim>
  PointLocations<dim>
  locate_on_boundary(const Triangulation<dim>           &triangulation,
                     const std::vector<Point<dim>>      &points,
                     const std::set<types::boundary_id> &ids);


  /// Throw ExcMessage that names @p entry and the nearest place in the mesh if
  /// a point is outside of the mesh. Collective.
  template <int dim>
  void
  check_points(const Triangulation<dim>      &triangulation,
               const std::vector<Point<dim>> &points,
               const std::string             &entry);
} // namespace Viscoplastic
