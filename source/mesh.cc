// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/function_parser.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/expression.h>
#include <viscoplastic_contact/mesh.h>
#include <viscoplastic_contact/mesh_check.h>
#include <viscoplastic_contact/mesh_file.h>
#include <viscoplastic_contact/messages.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <regex>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// deal.II takes negative numbers of cells for huge ones.
    void
    check_numbers_of_cells(const GeometryParameters &geometry)
    {
      // Which of the arguments, counted from 0, are numbers of cells.
      std::size_t place = numbers::invalid_unsigned_int;
      if (geometry.generator.compare(0, 11, "subdivided_") == 0)
        place = 0;
      else if (geometry.generator.find("hyper_shell") != std::string::npos)
        place = 3;
      const auto arguments =
        Utilities::split_string_list(geometry.arguments, ':');
      if (place >= arguments.size())
        return;
      constexpr double most  = 10000000;
      double           total = 1.;
      for (const std::string &text :
           Utilities::split_string_list(arguments[place], ','))
        {
          char        *end   = nullptr;
          const double value = std::strtod(text.c_str(), &end);
          if (*end != '\0')
            return; // deal.II says it
          // Zero cells of a shell let deal.II choose.
          total *= value < 0. ? 2. * most : std::max(1., value);
        }
      AssertThrow(total <= most,
                  ExcMessage("'Geometry/Arguments' = " + geometry.arguments +
                             " asks for " + arguments[place] +
                             " cells; possible are 1 to 10000000 (refinements "
                             "make more)."));
    }



    template <int dim>
    void
    generate(const GeometryParameters                  &geometry,
             parallel::distributed::Triangulation<dim> &triangulation)
    {
      check_numbers_of_cells(geometry);
      try
        {
          GridGenerator::generate_from_name_and_arguments(triangulation,
                                                          geometry.generator,
                                                          geometry.arguments);
        }
      catch (const std::exception &exception)
        {
          AssertThrow(false,
                      ExcMessage("The mesh generator '" + geometry.generator +
                                 "' refuses the arguments '" +
                                 geometry.arguments +
                                 "': " + reason(exception)));
        }
      AssertThrow(triangulation.all_reference_cells_are_hyper_cube(),
                  ExcMessage("The mesh must consist of quadrilaterals or "
                             "hexahedra; simplices are not supported."));
    }



    template <int dim>
    void
    read(const GeometryParameters                  &geometry,
         parallel::distributed::Triangulation<dim> &triangulation)
    {
      const MeshFile file =
        read_mesh_file(geometry.file, geometry.file_format, dim);
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



    /// The function of `Boundary ids' or `Material ids'.
    template <int dim>
    class IdExpression
    {
    public:
      IdExpression(const std::string &text, const std::string &entry)
        : entry(entry)
        , parser(parse_expression<dim>(
            text,
            FunctionParser<dim>::default_variable_names() + ",id",
            entry))
      {}

      /// The new id of a face or cell; @p what it is, for error messages.
      template <int structdim>
      unsigned int
      operator()(const TriaAccessor<structdim, dim, dim> &object,
                 const unsigned int                       old_id,
                 const std::string                       &what)
      {
        // The centre, and near the corners, which neighbours share.
        Point<structdim> xi;
        for (unsigned int d = 0; d < structdim; ++d)
          xi[d] = 0.5;
        const Point<dim>   centre = object.intermediate_point(xi);
        const unsigned int id     = value(centre, old_id);
        for (unsigned int v = 0; v < GeometryInfo<structdim>::vertices_per_cell;
             ++v)
          {
            const Point<dim> x = object.intermediate_point(
              xi + 0.99 * (GeometryInfo<structdim>::unit_cell_vertex(v) - xi));
            const unsigned int id_here = value(x, old_id);
            std::ostringstream message;
            message << "'" << entry << "' gives " << id << " and " << id_here
                    << " in the " << what << " with the centre (" << centre
                    << "); an id may change only between " << what
                    << "s of the coarse mesh.";
            AssertThrow(id_here == id, ExcMessage(message.str()));
          }
        return id;
      }

    private:
      unsigned int
      value(const Point<dim> &x, const unsigned int old_id)
      {
        parser->set_time(old_id);
        const double       result = parser->value(x);
        std::ostringstream message;
        message << "'" << entry << "' gives " << result << " at (" << x
                << "); ids are whole numbers from 0 to " << largest_id << ".";
        AssertThrow(std::abs(result - std::round(result)) <= 1e-6 &&
                      result > -0.5 && result < largest_id + 0.5,
                    ExcMessage(message.str()));
        return static_cast<unsigned int>(std::round(result));
      }

      const std::string                          entry;
      const std::unique_ptr<FunctionParser<dim>> parser;
    };



    template <int dim>
    void
    set_ids(const GeometryParameters                  &geometry,
            parallel::distributed::Triangulation<dim> &triangulation)
    {
      if (!Utilities::trim(geometry.boundary_ids).empty())
        {
          IdExpression<dim> id(geometry.boundary_ids, "Geometry/Boundary ids");
          for (const auto &cell : triangulation.cell_iterators_on_level(0))
            for (const unsigned int f : cell->face_indices())
              if (cell->at_boundary(f))
                {
                  const auto face = cell->face(f);
                  // With the edges, as the generators do.
                  face->set_all_boundary_ids(
                    id(*face, face->boundary_id(), "face"));
                }
        }
      if (!Utilities::trim(geometry.material_ids).empty())
        {
          IdExpression<dim> id(geometry.material_ids, "Geometry/Material ids");
          for (const auto &cell : triangulation.cell_iterators_on_level(0))
            cell->set_material_id(id(*cell, cell->material_id(), "cell"));
        }
    }



    template <int dim>
    void
    move(const GeometryParameters                  &geometry,
         parallel::distributed::Triangulation<dim> &triangulation)
    {
      const bool rotated = geometry.rotation_angle != 0.;
      const bool shifted = !geometry.translation.empty();
      if (!rotated && !shifted)
        return;
      for (const types::manifold_id id : triangulation.get_manifold_ids())
        AssertThrow(id == numbers::flat_manifold_id,
                    ExcMessage("'Geometry/Rotation angle' and 'Translation' "
                               "apply to meshes with straight edges only; '" +
                               geometry.generator + "' has curved ones."));
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



    template <typename Id>
    std::string
    list(const std::set<Id> &ids)
    {
      std::string result;
      for (const Id id : ids)
        result += (result.empty() ? "" : ", ") + std::to_string(id);
      return result;
    }



    /// `Boundary refinements': how often by boundary id.
    template <int dim>
    std::map<types::boundary_id, unsigned int>
    boundary_refinements(
      const std::string                               &text,
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      const std::string entry = "'Geometry/Boundary refinements' = " + text;
      std::map<types::boundary_id, unsigned int> result;
      const std::set<types::boundary_id> ids = boundary_ids(triangulation);
      const std::regex                   pair("(\\d{1,9})\\s*:\\s*(\\d{1,2})");
      for (const std::string &part : Utilities::split_string_list(text, ','))
        {
          std::smatch match;
          AssertThrow(std::regex_match(part, match, pair),
                      ExcMessage(entry +
                                 " consists of `boundary id: times' separated "
                                 "by commas, but has '" +
                                 part + "'."));
          const types::boundary_id id = std::stoul(match[1]);
          AssertThrow(ids.count(id) == 1,
                      ExcMessage(
                        entry + " names the boundary id " + std::to_string(id) +
                        ", but the mesh has the ids " + list(ids) + "."));
          AssertThrow(result.emplace(id, std::stoul(match[2])).second,
                      ExcMessage(entry + " names the boundary id " +
                                 std::to_string(id) + " twice."));
        }
      return result;
    }



    template <int dim>
    void
    refine(const GeometryParameters                  &geometry,
           parallel::distributed::Triangulation<dim> &triangulation)
    {
      std::map<types::boundary_id, unsigned int> times;
      if (!Utilities::trim(geometry.boundary_refinements).empty())
        times =
          boundary_refinements(geometry.boundary_refinements, triangulation);

      // Halving is exact and indices suffice up to here.
      const unsigned int global = geometry.global_refinements;
      unsigned int       local  = 0;
      for (const auto &pair : times)
        local = std::max(local, pair.second);
      const unsigned int n_levels = 18;
      AssertThrow(global <= n_levels && global + local <= n_levels,
                  ExcMessage("'Geometry/Global refinements' = " +
                             std::to_string(global) + " with " +
                             std::to_string(local) +
                             " further ones at boundaries; together, " +
                             std::to_string(n_levels) + " are possible."));
      const double n_unknowns =
        dim * std::ldexp(triangulation.n_cells(0), dim * global);
      std::ostringstream message;
      message << "'Geometry/Global refinements' = " << global
              << " would make about " << n_unknowns
              << " unknowns, more than can be numbered.";
      AssertThrow(n_unknowns <
                    std::numeric_limits<types::global_dof_index>::max(),
                  ExcMessage(message.str()));

      triangulation.refine_global(global);
      for (unsigned int pass = 0; pass < local; ++pass)
        {
          // A cell may touch the boundary in a vertex or an edge only.
          std::vector<bool> touches(triangulation.n_vertices(), false);
          for (const auto &cell : triangulation.active_cell_iterators())
            if (!cell->is_artificial())
              for (const unsigned int f : cell->face_indices())
                if (cell->at_boundary(f))
                  {
                    const auto face  = cell->face(f);
                    const auto found = times.find(face->boundary_id());
                    if (found != times.end() && pass < found->second)
                      for (const unsigned int v : face->vertex_indices())
                        touches[face->vertex_index(v)] = true;
                  }
          for (const auto &cell : triangulation.active_cell_iterators())
            if (cell->is_locally_owned())
              for (const unsigned int v : cell->vertex_indices())
                if (touches[cell->vertex_index(v)])
                  cell->set_refine_flag();
          triangulation.execute_coarsening_and_refinement();
        }
    }
  } // namespace



  template <int dim>
  void
  make_mesh(const GeometryParameters                  &geometry,
            parallel::distributed::Triangulation<dim> &triangulation)
  {
    if (geometry.file.empty())
      generate(geometry, triangulation);
    else
      read(geometry, triangulation);
    set_ids(geometry, triangulation);
    move(geometry, triangulation);
    check_mesh(triangulation);
    refine(geometry, triangulation);
    if (triangulation.n_global_levels() > 1)
      check_mesh(triangulation);
  }



  template <int dim>
  std::set<types::boundary_id>
  boundary_ids(const parallel::distributed::Triangulation<dim> &triangulation)
  {
    std::set<types::boundary_id> result;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      for (const unsigned int f : cell->face_indices())
        if (cell->at_boundary(f))
          result.insert(cell->face(f)->boundary_id());
    return result;
  }



  template <int dim>
  std::set<types::material_id>
  material_ids(const parallel::distributed::Triangulation<dim> &triangulation)
  {
    std::set<types::material_id> result;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      result.insert(cell->material_id());
    return result;
  }



  template <int dim>
  PieceNormal<dim>
  piece_normal(const parallel::distributed::Triangulation<dim> &triangulation,
               const types::boundary_id                         id)
  {
    const MPI_Comm comm = triangulation.get_communicator();
    // These points include the vertices, where warped faces deviate most.
    const FE_Nothing<dim> fe;
    FEFaceValues<dim>     face_values(fe,
                                  QGaussLobatto<dim - 1>(3),
                                  update_normal_vectors | update_JxW_values);
    const auto            for_each_normal = [&](const auto &visit) {
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          for (const unsigned int f : cell->face_indices())
            if (cell->at_boundary(f) && cell->face(f)->boundary_id() == id)
              {
                face_values.reinit(cell, f);
                for (const unsigned int q :
                     face_values.quadrature_point_indices())
                  visit(face_values.normal_vector(q), face_values.JxW(q));
              }
    };

    Tensor<1, dim> sum;
    double         area = 0.;
    for_each_normal([&](const Tensor<1, dim> &normal, const double JxW) {
      sum += normal * JxW;
      area += JxW;
    });
    sum  = Utilities::MPI::sum(sum, comm);
    area = Utilities::MPI::sum(area, comm);
    // All around a body the normals cancel.
    if (sum.norm() <= 1e-10 * area)
      return {Tensor<1, dim>(), 180.};

    PieceNormal<dim> result{sum / sum.norm(), 0.};
    // Exact axes keep the nodal frames of axis-parallel bodies trivial.
    for (unsigned int d = 0; d < dim; ++d)
      if (std::abs(std::abs(result.normal[d]) - 1.) < 1e-12)
        {
          const double sign = result.normal[d] > 0. ? 1. : -1.;
          result.normal     = 0.;
          result.normal[d]  = sign;
        }
    // By the chord, since an arc cosine knows no angles below 1e-8.
    double chord = 0.;
    for_each_normal([&](const Tensor<1, dim> &normal, const double) {
      chord = std::max(chord, (normal - result.normal).norm());
    });
    chord = Utilities::MPI::max(chord, comm);
    result.deviation =
      2. * std::asin(std::min(1., chord / 2.)) * 180. / numbers::PI;
    return result;
  }



  template void
  make_mesh(const GeometryParameters &,
            parallel::distributed::Triangulation<2> &);
  template void
  make_mesh(const GeometryParameters &,
            parallel::distributed::Triangulation<3> &);
  template std::set<types::boundary_id>
  boundary_ids(const parallel::distributed::Triangulation<2> &);
  template std::set<types::boundary_id>
  boundary_ids(const parallel::distributed::Triangulation<3> &);
  template std::set<types::material_id>
  material_ids(const parallel::distributed::Triangulation<2> &);
  template std::set<types::material_id>
  material_ids(const parallel::distributed::Triangulation<3> &);
  template PieceNormal<2>
  piece_normal(const parallel::distributed::Triangulation<2> &,
               const types::boundary_id);
  template PieceNormal<3>
  piece_normal(const parallel::distributed::Triangulation<3> &,
               const types::boundary_id);
} // namespace Viscoplastic
