// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/function_parser.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>

#include <cmath>
#include <memory>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
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

      /// Return the new id of a face or cell; @p what names it in messages.
      template <int structdim>
      unsigned int
      operator()(const TriaAccessor<structdim, dim, dim> &object,
                 const unsigned int                       old_id,
                 const std::string                       &what)
      {
        // At the center, and near the corners, which neighbors share.
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
            if (id_here == id)
              continue;
            std::ostringstream message;
            message << "'" << entry << "' gives " << id << " and " << id_here
                    << " in the " << what << " with the center (" << center
                    << "); an id may change only between " << what
                    << "s of the coarse mesh.";
            AssertThrow(false, ExcMessage(message.str()));
          }
        return id;
      }

    private:
      unsigned int
      value(const Point<dim> &x, const unsigned int old_id)
      {
        parser->set_time(old_id);
        const double result = parser->value(x);
        if (std::abs(result - std::round(result)) <= 1e-6 && result > -0.5 &&
            result < largest_id + 0.5)
          return static_cast<unsigned int>(std::round(result));
        std::ostringstream message;
        message << "'" << entry << "' gives " << result << " at (" << x
                << "); ids are whole numbers from 0 to " << largest_id << ".";
        AssertThrow(false, ExcMessage(message.str()));
        return 0;
      }

      const std::string                          entry;
      const std::unique_ptr<FunctionParser<dim>> parser;
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



  VISCOPLASTIC_INSTANTIATE(set_ids);
  VISCOPLASTIC_INSTANTIATE(boundary_ids);
  VISCOPLASTIC_INSTANTIATE(material_ids);
} // namespace Viscoplastic
