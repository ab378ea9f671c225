// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/files/read_mesh_file.h>
#include <viscoplastic_contact/mesh/hanging_vertices.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/mesh/mesh_check.h>
#include <viscoplastic_contact/mesh/mesh_generator.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>

#include <array>
#include <vector>

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
      // From nodes around a face to deal.II's lexicographic order.
      constexpr std::array<unsigned int, 8> order{{0, 1, 3, 2, 4, 5, 7, 6}};

      std::vector<Point<dim>> vertices(file.nodes.size());
      for (std::size_t n = 0; n < file.nodes.size(); ++n)
        for (unsigned int d = 0; d < dim; ++d)
          vertices[n][d] = file.nodes[n][d];
      // Both of cells and of faces.
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
          AssertThrow(false,
                      ExcMessage("The cells of the mesh file '" +
                                 geometry.file +
                                 "' do not make a mesh: " + reason(exception)));
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
        AssertThrow(id == numbers::flat_manifold_id,
                    ExcMessage("'Geometry/Coordinates', 'Rotation angle' and "
                               "'Translation' apply to meshes with straight "
                               "edges only; '" +
                               geometry.generator + "' has curved ones."));
      if (mapped)
        {
          const VectorExpression<dim> coordinates(geometry.coordinates,
                                                  dim,
                                                  "Geometry/Coordinates");
          AssertThrow(!coordinates.depends_on_time(),
                      ExcMessage("'Geometry/Coordinates' depends on t, but the "
                                 "mesh does not change with time."));
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
              AssertThrow(axis.norm() > 0.,
                          ExcMessage("'Geometry/Rotation axis' must not be "
                                     "zero."));
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



  template void
  make_mesh(const GeometryParameters &,
            parallel::distributed::Triangulation<2> &);
  template void
  make_mesh(const GeometryParameters &,
            parallel::distributed::Triangulation<3> &);
} // namespace Viscoplastic
