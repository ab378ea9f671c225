// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table_parser.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  namespace
  {
    /// The expression of `Boundary ids' or `Material ids'.
    template <int dim>
    class IdExpression
    {
    public:
      IdExpression(const std::string &text, const std::string &entry)
        : entry(entry)
        , parser(parse_expression(text, coordinate_names<dim> + ",id", entry))
      {}

      /// Return the new id of a face or cell; @p what names it in messages.
      template <int structdim>
      unsigned int
      operator()(const TriaAccessor<structdim, dim, dim> &object,
                 const unsigned int                       old_id,
                 const std::string                       &what)
      {
        // Evaluate at the center and near, not at, corners: neighbors share
        // these.
        Point<structdim> xi;
        for (unsigned int d = 0; d < structdim; ++d)
          xi[d] = 0.5;
        const Point<dim>   center = object.intermediate_point(xi);
        const unsigned int id     = value(center, old_id);
        for (unsigned int v = 0; v < GeometryInfo<structdim>::vertices_per_cell;
             ++v)
          {
            const Point<dim> x = object.intermediate_point(
              xi + 0.99 * (GeometryInfo<structdim>::unit_cell_vertex(v) - xi));
            const unsigned int id_here = value(x, old_id);
            if (id_here != id)
              refuse("'" + entry + "' gives " + std::to_string(id) + " and " +
                     std::to_string(id_here) + " in the " + what +
                     " with the center (" + as_text(center) +
                     "); an id may change only between " + what +
                     "s of the coarse mesh.");
          }
        return id;
      }

    private:
      unsigned int
      value(const Point<dim> &x, const unsigned int old_id)
      {
        std::copy(x.begin_raw(), x.end_raw(), parser->variables.begin());
        parser->variables.back() = old_id;
        const double result      = parser->value();
        if (std::abs(result - std::round(result)) <= 1e-6 && result > -0.5 &&
            result < largest_id + 0.5)
          return static_cast<unsigned int>(std::round(result));
        refuse("'" + entry + "' gives " + as_text(result) + " at (" +
               as_text(x) + "); ids are whole numbers from 0 to " +
               std::to_string(largest_id) + ".");
      }

      const std::string                       entry;
      const std::shared_ptr<ParserWithTables> parser;
    };
  } // namespace



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
                // Also set the ids of edges, as the generators do.
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
  std::map<unsigned int, std::set<types::boundary_id>>
  boundaries_at_vertices(const Triangulation<dim> &triangulation)
  {
    std::map<unsigned int, std::set<types::boundary_id>> result;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      {
        for (const unsigned int v : cell->vertex_indices())
          result[cell->vertex_index(v)];
        for (const unsigned int f : cell->face_indices())
          if (const auto face = cell->face(f); face->at_boundary())
            for (const unsigned int v : face->vertex_indices())
              result[face->vertex_index(v)].insert(face->boundary_id());
      }
    return result;
  }



  template <int dim>
  std::set<std::pair<types::boundary_id, types::boundary_id>>
  touching_boundaries(const Triangulation<dim> &triangulation)
  {
    std::set<std::pair<types::boundary_id, types::boundary_id>> result;
    for (const auto &[vertex, ids] : boundaries_at_vertices(triangulation))
      for (const types::boundary_id a : ids)
        for (const types::boundary_id b : ids)
          result.emplace(a, b);
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



  namespace
  {
    /// Return the angle in degrees between unit vectors at a distance @p chord;
    /// the arc cosine of their product cannot resolve angles below 1e-8.
    double
    angle_of_chord(const double chord)
    {
      return 2. * std::asin(std::min(1., chord / 2.)) * 180. / numbers::PI;
    }



    /// Call visit(normal, JxW) at points of all owned faces with an id.
    template <int dim, typename Visitor>
    void
    visit_normals(
      const parallel::distributed::Triangulation<dim> &triangulation,
      const types::boundary_id                         id,
      const Visitor                                   &visit)
    {
      // These points include the vertices, where warped faces deviate most.
      const FE_Nothing<dim> fe;
      FEFaceValues<dim>     face_values(fe,
                                    QGaussLobatto<dim - 1>(3),
                                    update_normal_vectors | update_JxW_values);
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
    }
  } // namespace



  template <int dim>
  PieceNormal<dim>
  piece_normal(const parallel::distributed::Triangulation<dim> &triangulation,
               const types::boundary_id                         id)
  {
    const MPI_Comm comm = triangulation.get_communicator();
    Tensor<1, dim> sum;
    double         area = 0.;
    visit_normals(triangulation, id, [&](const auto &normal, const double JxW) {
      sum += normal * JxW;
      area += JxW;
    });
    sum  = Utilities::MPI::sum(sum, comm);
    area = Utilities::MPI::sum(area, comm);
    // The normals cancel, as all around a body.
    if (sum.norm() <= 1e-10 * area)
      return {Tensor<1, dim>(), 180.};

    PieceNormal<dim> result{sum / sum.norm(), 0.};
    // Exact axes keep the rotated frames at nodes trivial.
    for (unsigned int d = 0; d < dim; ++d)
      if (std::abs(std::abs(result.normal[d]) - 1.) < 1e-12)
        {
          const double sign = result.normal[d] > 0. ? 1. : -1.;
          result.normal     = 0.;
          result.normal[d]  = sign;
        }
    double chord = 0.;
    visit_normals(triangulation, id, [&](const auto &normal, const double) {
      chord = std::max(chord, (normal - result.normal).norm());
    });
    chord            = Utilities::MPI::max(chord, comm);
    result.deviation = angle_of_chord(chord);
    return result;
  }



  template <int dim>
  double
  largest_angle(const parallel::distributed::Triangulation<dim> &triangulation,
                const types::boundary_id                         id)
  {
    // Ghost cells complete the cells around each vertex of an owned cell.
    std::map<unsigned int, std::vector<Tensor<1, dim>>> normals;
    double                                              chord = 0.;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (!cell->is_artificial())
        for (const unsigned int f : cell->face_indices())
          if (cell->at_boundary(f) && cell->face(f)->boundary_id() == id)
            {
              const auto           face = cell->face(f);
              const Tensor<1, dim> a =
                face->vertex(face->n_vertices() - 1) - face->vertex(0);
              Tensor<1, dim> normal;
              if constexpr (dim == 2)
                normal = cross_product_2d(a);
              else
                normal = cross_product_3d(a, face->vertex(2) - face->vertex(1));
              normal /= normal.norm();
              if (normal * (face->center() - cell->center()) < 0.)
                normal *= -1.;
              for (const unsigned int v : face->vertex_indices())
                {
                  auto &others = normals[face->vertex_index(v)];
                  for (const Tensor<1, dim> &other : others)
                    chord = std::max(chord, (normal - other).norm());
                  others.push_back(normal);
                }
            }
    chord = Utilities::MPI::max(chord, triangulation.get_communicator());
    return angle_of_chord(chord);
  }



  template <int dim>
  bool
  faces_towards(const parallel::distributed::Triangulation<dim> &triangulation,
                const types::boundary_id                         id,
                const Tensor<1, dim>                            &direction)
  {
    bool here = false;
    visit_normals(triangulation,
                  id,
                  [&](const Tensor<1, dim> &normal, const double) {
                    here |= normal * direction > 1e-6;
                  });
    return Utilities::MPI::logical_or(here, triangulation.get_communicator());
  }



  VISCOPLASTIC_INSTANTIATE(set_ids);
  VISCOPLASTIC_INSTANTIATE(boundary_ids);
  VISCOPLASTIC_INSTANTIATE(boundaries_at_vertices);
  VISCOPLASTIC_INSTANTIATE(touching_boundaries);
  VISCOPLASTIC_INSTANTIATE(material_ids);
  VISCOPLASTIC_INSTANTIATE(piece_normal);
  VISCOPLASTIC_INSTANTIATE(largest_angle);
  VISCOPLASTIC_INSTANTIATE(faces_towards);
} // namespace Viscoplastic
