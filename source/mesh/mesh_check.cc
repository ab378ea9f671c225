// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/geometry_info.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/mesh_check.h>

#include <cmath>
#include <limits>
#include <vector>

namespace Viscoplastic
{
  namespace
  {
    /// Return the scaled Jacobian of a cell: the minimum over its vertices and
    /// Gauss points of the determinant of the Jacobian matrix divided by the
    /// lengths of its columns (1 in a box, the sine of the angle in a
    /// parallelogram).
    template <int dim, typename CellIterator>
    double
    least_scaled_jacobian(const CellIterator            &cell,
                          const std::vector<Point<dim>> &reference_points)
    {
      double least = 1.;
      for (const Point<dim> &xi : reference_points)
        {
          Tensor<2, dim> jacobian;
          for (const unsigned int v : cell->vertex_indices())
            jacobian += outer_product(
              Tensor<1, dim>(cell->vertex(v)),
              GeometryInfo<dim>::d_linear_shape_function_gradient(xi, v));
          double scale = 1.;
          for (unsigned int d = 0; d < dim; ++d)
            scale *= transpose(jacobian)[d].norm();
          // The scale is zero if vertices coincide, and may overflow.
          if (!(scale > 0.) || !std::isfinite(scale))
            return 0.;
          least = std::min(least, determinant(jacobian) / scale);
        }
      return least;
    }



    /// Check the lengths of the coarse cells, which all ranks know. Refinement
    /// does not change their orders of magnitude enough to matter.
    template <int dim>
    void
    check_lengths(
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      double largest = 0., smallest = std::numeric_limits<double>::infinity();
      for (const auto &cell : triangulation.cell_iterators_on_level(0))
        {
          double extent = 0.;
          for (const unsigned int v : cell->vertex_indices())
            for (unsigned int d = 0; d < dim; ++d)
              {
                largest = std::max(largest, std::abs(cell->vertex(v)[d]));
                extent =
                  std::max(extent,
                           std::abs(cell->vertex(v)[d] - cell->vertex(0)[d]));
              }
          smallest = std::min(smallest, extent);
        }
      require_in_range("The largest coordinate of the mesh",
                       largest,
                       -largest_length,
                       largest_length);
      // Coinciding vertices are refused by check_cells().
      if (smallest > 0.)
        require_in_range("The size of the smallest cell",
                         smallest,
                         least_length,
                         largest_length);
    }



    template <int dim, typename Cells>
    void
    check_cells(const Cells &cells, const MPI_Comm &comm)
    {
      std::vector<Point<dim>> reference_points = QGauss<dim>(2).get_points();
      for (unsigned int v = 0; v < GeometryInfo<dim>::vertices_per_cell; ++v)
        reference_points.push_back(GeometryInfo<dim>::unit_cell_vertex(v));

      double     worst = 1.;
      Point<dim> where;
      for (const auto &cell : cells)
        if (cell->level() == 0 || cell->is_locally_owned())
          {
            const double value = least_scaled_jacobian(cell, reference_points);
            if (value < worst)
              {
                worst = value;
                where = cell->center();
              }
          }

      // Above the rounding errors of coordinates in single precision.
      const double limit   = 1e-6;
      const auto   extreme = Utilities::MPI::min_max_avg(worst, comm);
      if (extreme.min > limit)
        return;
      where = Utilities::MPI::broadcast(comm, where, extreme.min_index);
      refuse("The cell of the mesh with the center (" + as_text(where) +
             ") is inverted or degenerate: the determinant of its Jacobian, "
             "divided by the lengths of its columns, is " +
             as_text(extreme.min) +
             " somewhere in it; it has to be positive (1 in a " +
             (dim == 2 ? "rectangle" : "box") + ").");
    }
  } // namespace



  template <int dim>
  ConnectedParts
  connected_parts(
    const Triangulation<dim>                            &triangulation,
    const std::function<bool(const types::material_id)> &is_present)
  {
    constexpr unsigned int none = numbers::invalid_unsigned_int;
    ConnectedParts         result;
    result.of_cell.assign(triangulation.n_cells(0), none);
    const auto part_of = [&result](const auto &cell) -> unsigned int & {
      return result.of_cell[cell->id().get_coarse_cell_id()];
    };
    for (const auto &first : triangulation.cell_iterators_on_level(0))
      {
        if (part_of(first) != none || !is_present(first->material_id()))
          continue;
        std::vector<typename Triangulation<dim>::cell_iterator> open{first};
        while (!open.empty())
          {
            const auto cell = open.back();
            open.pop_back();
            if (part_of(cell) != none || !is_present(cell->material_id()))
              continue;
            part_of(cell) = result.n;
            for (const unsigned int f : cell->face_indices())
              if (!cell->at_boundary(f))
                open.push_back(cell->neighbor(f));
          }
        ++result.n;
      }
    return result;
  }



  template <int dim>
  void
  check_connection(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    const ConnectedParts parts =
      connected_parts<dim>(triangulation,
                           [](const types::material_id) { return true; });
    if (parts.n == 1)
      return;
    std::vector<Point<dim>> centers; // of the first cells of parts
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      if (parts.of_cell[cell->id().get_coarse_cell_id()] == centers.size())
        centers.push_back(cell->center());
    refuse("The mesh consists of " + std::to_string(parts.n) +
           " parts that share no faces, e.g. the cells with the centers (" +
           as_text(centers.front()) + ") and (" + as_text(centers.back()) +
           ") are not connected. Bodies of their own need contact with each "
           "other ('Against'); the cells of one body have their nodes in "
           "common (merge nodes that are at the same place).");
  }



  template <int dim>
  void
  check_mesh(const parallel::distributed::Triangulation<dim> &triangulation)
  {
    const MPI_Comm comm = triangulation.get_communicator();
    check_lengths(triangulation);
    check_cells<dim>(triangulation.cell_iterators_on_level(0), comm);
    // Refinement along straight lines keeps the shape of cells, but new
    // vertices on curved boundaries are moved.
    if (triangulation.n_global_levels() > 1)
      check_cells<dim>(triangulation.active_cell_iterators(), comm);
  }



  VISCOPLASTIC_INSTANTIATE(check_mesh);
  VISCOPLASTIC_INSTANTIATE(connected_parts);
  VISCOPLASTIC_INSTANTIATE(check_connection);
} // namespace Viscoplastic
