// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold_lib.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/mesh/mesh_size.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>

namespace Viscoplastic
{
  namespace
  {
    /// Boundary ids of body b (counted from 0) begin with b times this.
    constexpr types::boundary_id ids_per_body = 20;



    /// The arguments of a generator, counted from 0, that are numbers of cells.
    struct CellCounts
    {
      std::vector<std::size_t> arguments;
      enum
      {
        /// The number of cells is their product.
        product,
        /// The number of cells is the dim-th power of the only one.
        power,
        /// The number of cells is their sum.
        sum
      } kind = product;
    };



    const std::map<std::string, CellCounts> cell_counts{
      {"channel_with_cylinder", {{1}}},
      {"cheese", {{0}}},
      {"concentric_hyper_shells", {{3, 5}}},
      {"cylinder_shell", {{3, 4}}},
      {"eccentric_hyper_shell", {{4}}},
      {"half_hyper_shell", {{3}}},
      {"hyper_cross", {{0}, CellCounts::sum}},
      {"hyper_cube_with_cylindrical_hole", {{3}}},
      {"hyper_shell", {{3}}},
      {"moebius", {{0}}},
      {"plate_with_a_hole", {{10}}},
      {"quarter_hyper_shell", {{3}}},
      {"subdivided_cylinder", {{0}}},
      {"subdivided_hyper_cube", {{0}, CellCounts::power}},
      {"subdivided_hyper_rectangle", {{0}}},
      {"torus", {{2}}}};



    /// Return the numbers in a list; an empty one if any is no number.
    std::vector<double>
    list_of_numbers(const std::string &text)
    {
      std::vector<double> values;
      for (const std::string &part : Utilities::split_string_list(text, ','))
        {
          const auto value = number_of(part);
          if (!value || !std::isfinite(*value))
            return {};
          values.push_back(*value);
        }
      return values;
    }



    /// Check the numbers of cells: deal.II converts negative ones to huge ones,
    /// and tries to allocate the memory for huge ones.
    void
    check_numbers_of_cells(const GeometryParameters &geometry,
                           const unsigned int        dim,
                           const MPI_Comm            communicator)
    {
      const auto found = cell_counts.find(geometry.generator);
      if (found == cell_counts.end())
        return;
      const CellCounts &counts = found->second;
      const auto        arguments =
        Utilities::split_string_list(geometry.arguments, ':');
      double      total       = counts.kind == CellCounts::sum ? 0. : 1.;
      bool        is_negative = false;
      std::string numbers;
      for (const std::size_t place : counts.arguments)
        {
          if (place >= arguments.size())
            return; // deal.II reports it
          numbers += (numbers.empty() ? "" : ", ") + arguments[place];
          const std::vector<double> values = list_of_numbers(arguments[place]);
          if (values.empty())
            return; // deal.II reports it
          for (const double value : values)
            {
              is_negative = is_negative || value < 0.;
              // Zero, where allowed, lets deal.II choose a small number.
              if (counts.kind == CellCounts::sum)
                total += value;
              else
                total *= std::pow(std::max(1., value),
                                  counts.kind == CellCounts::power ? dim : 1);
            }
        }
      constexpr unsigned int most = 10000000;
      if (is_negative || !(total <= most))
        refuse("'Geometry/Arguments' = " + geometry.arguments + " asks for " +
               (is_negative ? numbers : as_text(total)) +
               " cells; possible are 1 to " + std::to_string(most) +
               " (refinements make more).");
      check_mesh_size(dim,
                      total,
                      total,
                      "'Geometry/Arguments' = " + excerpt(geometry.arguments),
                      communicator);
    }



    /// Check the arguments of a box: deal.II takes anything but a list of whole
    /// numbers of cells for lists of step sizes, one per direction, and checks
    /// neither the number of lists nor the length of the list of numbers in
    /// release mode.
    void
    check_box(const GeometryParameters &geometry, const unsigned int dim)
    {
      const auto arguments =
        Utilities::split_string_list(geometry.arguments, ':');
      if (geometry.generator != "subdivided_hyper_rectangle" ||
          arguments.size() < 3)
        return; // deal.II reports it
      const auto lists = Utilities::split_string_list(arguments[0], ';');
      const auto refuse_unless = [&](const bool good, const std::string &what) {
        if (!good)
          refuse("'Geometry/Arguments' = " + excerpt(geometry.arguments) +
                 ": '" + excerpt(arguments[0]) + "' has to be " + what + ".");
      };
      const std::string n = std::to_string(dim);
      if (lists.size() < 2)
        {
          const std::vector<double> counts = list_of_numbers(arguments[0]);
          const bool                are_whole =
            arguments[0].find_first_not_of("0123456789, ") == std::string::npos;
          refuse_unless(counts.size() == dim && are_whole,
                        n + " whole numbers of cells separated by commas, or " +
                          n + " lists of step sizes separated by semicolons");
          return;
        }

      refuse_unless(lists.size() == dim,
                    n + " lists of step sizes separated by semicolons");
      const std::vector<double> first = list_of_numbers(arguments[1]),
                                last  = list_of_numbers(arguments[2]);
      if (first.size() != dim || last.size() != dim)
        return; // deal.II reports it
      for (unsigned int d = 0; d < dim; ++d)
        {
          const std::vector<double> steps  = list_of_numbers(lists[d]);
          const double              length = std::abs(last[d] - first[d]);
          double                    sum    = 0.;
          bool                      good   = !steps.empty();
          for (const double step : steps)
            {
              good = good && step > 0.;
              sum += step;
            }
          refuse_unless(good && std::abs(sum - length) <= 1e-6 * length,
                        "lists of positive step sizes that add up to the "
                        "lengths of the sides");
        }
    }



    /// Reorder the vertices of the cells of a coarse mesh so that each line has
    /// the same direction in all cells; meshes for which this is impossible (a
    /// Moebius strip) stay. Without consistent directions (in a quarter of a
    /// ball), p4est balances refined 3D meshes differently from deal.II, so
    /// that their cells differ: some refinements end in a crash.
    void
    orient_cells(parallel::distributed::Triangulation<3> &triangulation)
    {
      bool are_oriented = true;
      for (const auto &cell : triangulation.active_cell_iterators())
        for (const unsigned int l : cell->line_indices())
          are_oriented =
            are_oriented &&
            cell->line(l)->vertex_index(0) ==
              cell->vertex_index(GeometryInfo<3>::line_to_cell_vertices(l, 0));
      if (are_oriented)
        return;
      auto [vertices, cells, faces] =
        GridTools::get_coarse_mesh_description(triangulation);
      try
        {
          GridTools::consistently_order_cells(cells);
        }
      catch (const ExcMeshNotOrientable &)
        {
          return;
        }
      std::map<types::manifold_id, std::unique_ptr<Manifold<3>>> manifolds;
      for (const types::manifold_id id : triangulation.get_manifold_ids())
        if (id != numbers::flat_manifold_id)
          manifolds[id] = triangulation.get_manifold(id).clone();
      triangulation.clear();
      triangulation.create_triangulation(vertices, cells, faces);
      // Transfinite manifolds refer to the triangulation and to other
      // manifolds: set them last and initialize them again.
      using Interpolation = TransfiniteInterpolationManifold<3>;
      for (const bool interpolates : {false, true})
        for (const auto &[id, manifold] : manifolds)
          {
            auto *interpolation = dynamic_cast<Interpolation *>(manifold.get());
            if ((interpolation != nullptr) != interpolates)
              continue;
            if (interpolates)
              interpolation->initialize(triangulation);
            triangulation.set_manifold(id, *manifold);
          }
    }



    template <int dim>
    void
    generate_body(const GeometryParameters &geometry,
                  const MPI_Comm            communicator,
                  Triangulation<dim>       &triangulation)
    {
      check_numbers_of_cells(geometry, dim, communicator);
      check_box(geometry, dim);
      try
        {
          GridGenerator::generate_from_name_and_arguments(triangulation,
                                                          geometry.generator,
                                                          geometry.arguments);
        }
      catch (const std::exception &exception)
        {
          // deal.II's messages on wrong arguments are long lists of C++ types.
          std::string why = reason(exception);
          if (why.find("does not match the pattern") != std::string::npos)
            why = "they must be separated by colons and of the types that "
                  "deal.II's GridGenerator documents.";
          else if (why.find("not implemented") != std::string::npos)
            why = "there is no such generator in " + std::to_string(dim) + "D.";
          refuse("The mesh generator '" + excerpt(geometry.generator) +
                 "' refuses the arguments '" + excerpt(geometry.arguments) +
                 "': " + why);
        }
      if (!triangulation.all_reference_cells_are_hyper_cube())
        refuse("The mesh must consist of quadrilaterals or hexahedra; "
               "simplices are not supported.");
    }



    /// Generate several bodies in one mesh, without common nodes.
    template <int dim>
    void
    generate_bodies(const GeometryParameters                  &geometry,
                    const std::vector<std::string>            &generators,
                    const std::vector<std::string>            &arguments,
                    parallel::distributed::Triangulation<dim> &triangulation)
    {
      if (generators.size() != arguments.size())
        refuse("'Geometry/Generator' has " + std::to_string(generators.size()) +
               " bodies, but 'Arguments' are those of " +
               std::to_string(arguments.size()) +
               "; both are lists separated by `|'.");
      std::vector<Point<dim>>                     vertices;
      std::vector<CellData<dim>>                  cells;
      SubCellData                                 faces;
      std::vector<std::unique_ptr<Manifold<dim>>> manifolds;
      for (std::size_t b = 0; b < generators.size(); ++b)
        {
          GeometryParameters of_body = geometry;
          of_body.generator          = generators[b];
          of_body.arguments          = arguments[b];
          Triangulation<dim> body;
          generate_body(of_body, triangulation.get_communicator(), body);
          // Manifold ids become indices into the common list `manifolds`.
          std::map<types::manifold_id, types::manifold_id> new_id{
            {numbers::flat_manifold_id, numbers::flat_manifold_id}};
          for (const types::manifold_id id : body.get_manifold_ids())
            if (id != numbers::flat_manifold_id)
              {
                new_id[id] = manifolds.size();
                manifolds.push_back(body.get_manifold(id).clone());
                if (dynamic_cast<const TransfiniteInterpolationManifold<dim> *>(
                      manifolds.back().get()) != nullptr)
                  refuse("The mesh generator '" + excerpt(generators[b]) +
                         "' cannot be one of several bodies, since it "
                         "interpolates between curved edges; use a mesh file.");
              }
          auto [body_vertices, body_cells, body_faces] =
            GridTools::get_coarse_mesh_description(body);
          const auto take = [&](auto &objects, auto &to) {
            for (auto &object : objects)
              {
                for (unsigned int &vertex : object.vertices)
                  vertex += vertices.size();
                object.manifold_id = new_id.at(object.manifold_id);
                to.push_back(object);
              }
          };
          for (auto &cell : body_cells)
            cell.material_id = b;
          const auto renumber = [&](auto &faces) {
            for (auto &face : faces)
              if (face.boundary_id != numbers::internal_face_boundary_id)
                face.boundary_id += ids_per_body * b;
          };
          renumber(body_faces.boundary_lines);
          renumber(body_faces.boundary_quads);
          take(body_cells, cells);
          take(body_faces.boundary_lines, faces.boundary_lines);
          take(body_faces.boundary_quads, faces.boundary_quads);
          vertices.insert(vertices.end(),
                          body_vertices.begin(),
                          body_vertices.end());
        }
      triangulation.create_triangulation(vertices, cells, faces);
      for (std::size_t id = 0; id < manifolds.size(); ++id)
        triangulation.set_manifold(id, *manifolds[id]);
    }
  } // namespace



  template <int dim>
  void
  generate_mesh(const GeometryParameters                  &geometry,
                parallel::distributed::Triangulation<dim> &triangulation)
  {
    const auto generators =
                 Utilities::split_string_list(geometry.generator, '|'),
               arguments =
                 Utilities::split_string_list(geometry.arguments, '|');
    if (generators.size() > 1 || arguments.size() > 1)
      generate_bodies(geometry, generators, arguments, triangulation);
    else
      generate_body(geometry, triangulation.get_communicator(), triangulation);
    if constexpr (dim == 3)
      orient_cells(triangulation);
  }



  VISCOPLASTIC_INSTANTIATE(generate_mesh);
} // namespace Viscoplastic
