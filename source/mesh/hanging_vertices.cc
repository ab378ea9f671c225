// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/mesh/hanging_vertices.h>

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    class HangingVertices
    {
    public:
      explicit HangingVertices(
        parallel::distributed::Triangulation<dim> &triangulation)
        : triangulation(triangulation)
      {}

      void
      move()
      {
        const std::vector<Point<dim>> before = triangulation.get_vertices();
        std::vector<bool>             is_moved(before.size(), false);
        const auto                    put = [&](const unsigned int vertex,
                             Point<dim>        &place,
                             const Point<dim>  &middle,
                             const double       size) {
          // Rounding moves nothing.
          if (place.distance(middle) > 1e-12 * size)
            {
              place            = middle;
              is_moved[vertex] = true;
            }
        };
        // From coarse to fine: the ends of an edge may hang themselves.
        for (unsigned int level = 0; level < triangulation.n_levels(); ++level)
          for (const auto &cell :
               triangulation.active_cell_iterators_on_level(level))
            {
              if (cell->is_artificial())
                continue;
              for (const unsigned int l : cell->line_indices())
                if (const auto line = cell->line(l); line->has_children())
                  put(line->child(0)->vertex_index(1),
                      line->child(0)->vertex(1),
                      line->center(),
                      line->diameter());
              if constexpr (dim == 3)
                for (const unsigned int f : cell->face_indices())
                  if (const auto face = cell->face(f); face->has_children())
                    put(face->child(0)->vertex_index(3),
                        face->child(0)->vertex(3),
                        face->center(),
                        face->diameter());
            }

        // Those of ghosts may hang on cells that are not known here.
        const std::vector<bool> is_owned =
          GridTools::get_locally_owned_vertices(triangulation);
        for (std::size_t v = 0; v < is_moved.size(); ++v)
          is_moved[v] = is_moved[v] && is_owned[v];
        triangulation.communicate_locally_moved_vertices(is_moved);

        for (unsigned int v = 0; v < before.size(); ++v)
          if (triangulation.get_vertices()[v] != before[v])
            places[v] = before[v];
      }

      void
      restore()
      {
        for (const auto &cell : triangulation.active_cell_iterators())
          for (const unsigned int v : cell->vertex_indices())
            if (const auto found = places.find(cell->vertex_index(v));
                found != places.end())
              cell->vertex(v) = found->second;
        places.clear();
      }

    private:
      parallel::distributed::Triangulation<dim> &triangulation;
      /// Where manifolds have put what is moved, by index.
      std::map<unsigned int, Point<dim>> places;
    };
  } // namespace



  template <int dim>
  void
  keep_hanging_vertices_on_coarser_cells(
    parallel::distributed::Triangulation<dim> &triangulation)
  {
    const auto manifolds = triangulation.get_manifold_ids();
    if (std::all_of(manifolds.begin(), manifolds.end(), [](const auto id) {
          return id == numbers::flat_manifold_id;
        }))
      return;
    const auto vertices = std::make_shared<HangingVertices<dim>>(triangulation);
    const auto restore  = [vertices] { vertices->restore(); };
    const auto move     = [vertices] { vertices->move(); };
    auto      &signals  = triangulation.signals;
    signals.pre_distributed_refinement.connect(restore);
    signals.post_distributed_refinement.connect(move);
    signals.pre_distributed_repartition.connect(restore);
    signals.post_distributed_repartition.connect(move);
    vertices->move();
  }



  template void
  keep_hanging_vertices_on_coarser_cells(
    parallel::distributed::Triangulation<2> &);
  template void
  keep_hanging_vertices_on_coarser_cells(
    parallel::distributed::Triangulation<3> &);
} // namespace Viscoplastic
