// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/files/read_mesh_file.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/mesh/mesh_check.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>
#include <viscoplastic_contact/mesh/mesh_size.h>

#include <array>
#include <map>
#include <memory>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    void
    read(const GeometryParameters                  &geometry,
         parallel::distributed::Triangulation<dim> &triangulation)
    {
      const MeshFile file = read_mesh_file(geometry.file,
                                           dim,
                                           geometry.plane_model,
                                           triangulation.get_communicator());
      check_mesh_size(dim,
                      file.cells.size(),
                      file.cells.size(),
                      "The mesh file '" + geometry.file + "'",
                      triangulation.get_communicator());
      // Converts the order of a walk around a face to lexicographic order.
      constexpr std::array<unsigned int, 8> order{{0, 1, 3, 2, 4, 5, 7, 6}};

      std::vector<Point<dim>> vertices(file.nodes.size());
      for (std::size_t n = 0; n < file.nodes.size(); ++n)
        for (unsigned int d = 0; d < dim; ++d)
          vertices[n][d] = file.nodes[n][d];
      // Set the vertices of a cell or of a face.
      const auto set_vertices = [&](auto &object, const auto &element) {
        for (std::size_t n = 0; n < object.vertices.size(); ++n)
          object.vertices[n] = element.nodes[order[n]];
      };
      std::vector<CellData<dim>> cells;
      for (const auto &element : file.cells)
        {
          cells.emplace_back(1 << dim);
          set_vertices(cells.back(), element);
          cells.back().material_id = element.id;
        }
      SubCellData faces;
      const auto  add_faces = [&](auto &boundary_objects) {
        for (const auto &element : file.faces)
          {
            boundary_objects.emplace_back(1 << (dim - 1));
            set_vertices(boundary_objects.back(), element);
            boundary_objects.back().boundary_id = element.id;
          }
      };
      if constexpr (dim == 2)
        add_faces(faces.boundary_lines);
      else
        add_faces(faces.boundary_quads);

      try
        {
          GridTools::delete_unused_vertices(vertices, cells, faces);
          GridTools::invert_cells_with_negative_measure(vertices, cells);
          GridTools::consistently_order_cells(cells);
          triangulation.create_triangulation(vertices, cells, faces);
        }
      catch (const std::exception &exception)
        {
          refuse("The cells of the mesh file '" + geometry.file +
                 "' do not make a mesh: " + reason(exception));
        }
    }



    template <int dim>
    void
    move(const GeometryParameters                  &geometry,
         parallel::distributed::Triangulation<dim> &triangulation)
    {
      const bool mapped  = !Utilities::trim(geometry.coordinates).empty();
      const bool rotated = geometry.rotation_angle != 0.;
      const bool shifted = !geometry.translation.empty();
      if (!mapped && !rotated && !shifted)
        return;
      for (const types::manifold_id id : triangulation.get_manifold_ids())
        if (id != numbers::flat_manifold_id)
          refuse("'Geometry/Coordinates', 'Rotation angle' and 'Translation' "
                 "apply to meshes with straight edges only; '" +
                 geometry.generator + "' has curved ones.");
      if (mapped)
        {
          const VectorExpression<dim> coordinates(geometry.coordinates,
                                                  dim,
                                                  "Geometry/Coordinates");
          if (coordinates.depends_on_time())
            refuse("'Geometry/Coordinates' depends on t, but the mesh does not "
                   "change with time.");
          GridTools::transform(
            [&coordinates](const Point<dim> &x) {
              return Point<dim>(coordinates.vector(x, 0.));
            },
            triangulation);
        }
      if (rotated)
        {
          const double angle = geometry.rotation_angle * numbers::PI / 180.;
          if constexpr (dim == 2)
            GridTools::rotate(angle, triangulation);
          else
            {
              const Point<3> axis = parse_point<3>(geometry.rotation_axis,
                                                   "Geometry/Rotation axis");
              if (!(axis.norm() > 0.))
                refuse("'Geometry/Rotation axis' must not be zero.");
              GridTools::rotate(Tensor<1, 3>(axis / axis.norm()),
                                angle,
                                triangulation);
            }
        }
      if (shifted)
        GridTools::shift(parse_point<dim>(geometry.translation,
                                          "Geometry/Translation"),
                         triangulation);
    }



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
          // Ignore differences by rounding.
          if (place.distance(middle) > 1e-12 * size)
            {
              place            = middle;
              is_moved[vertex] = true;
            }
        };
        // Coarse cells first: the ends of an edge may be hanging themselves.
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

        // Vertices of ghost cells may hang on cells that this rank does not
        // know: take their places from the owners.
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
      /// The places that manifolds give to the moved vertices, by index.
      std::map<unsigned int, Point<dim>> places;
    };



    /// On meshes with curved manifolds, move each hanging vertex to the center
    /// of the edge or face of the coarser cell, here and after each later
    /// refinement. The manifold puts it beside that edge or face, which is
    /// straight in the coarser cell: cells would overlap or leave a gap, and
    /// functions that are continuous at nodes would not be so between them.
    /// Refinement itself starts from the places given by manifolds. Does
    /// nothing without manifolds. Collective.
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
      const auto vertices =
        std::make_shared<HangingVertices<dim>>(triangulation);
      const auto restore = [vertices] { vertices->restore(); };
      const auto move    = [vertices] { vertices->move(); };
      auto      &signals = triangulation.signals;
      signals.pre_distributed_refinement.connect(restore);
      signals.post_distributed_refinement.connect(move);
      signals.pre_distributed_repartition.connect(restore);
      signals.post_distributed_repartition.connect(move);
      vertices->move();
    }
  } // namespace



  template <int dim>
  void
  make_mesh(const GeometryParameters                  &geometry,
            parallel::distributed::Triangulation<dim> &triangulation)
  {
    if (geometry.file.empty())
      generate_mesh(geometry, triangulation);
    else
      read(geometry, triangulation);
    set_ids(geometry, triangulation);
    move(geometry, triangulation);
    check_mesh(triangulation);
    keep_hanging_vertices_on_coarser_cells(triangulation);
    refine_mesh(geometry, triangulation);
    if (triangulation.n_global_levels() > 1)
      check_mesh(triangulation);
  }



  VISCOPLASTIC_INSTANTIATE(make_mesh);
} // namespace Viscoplastic
