// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "body.h"

#include <cmath>
#include <memory>
#include <sstream>
#include <string>

namespace Viscoplastic::Testing
{
  using namespace dealii;

  /// A quadrilateral (times (0,1)) with a corner of 150 degrees at the origin;
  /// the sides there are boundaries 0 and 2, the others 1 and 3 (4 and 5).
  template <int dim>
  std::string
  corner()
  {
    const double      c = std::cos(5. * numbers::PI / 6.);
    std::stringstream text;
    text.precision(17);
    for (const unsigned int z : {0, 1})
      if (z == 0 || dim == 3)
        {
          const std::string end =
            dim == 3 ? ", " + std::to_string(z) : std::string();
          text << (z == 1 ? "; " : "") << "0, 0" << end << "; 1, 0" << end
               << "; " << c << ", 0.5" << end << "; 0.25, 1.25" << end;
        }
    text << " : true";
    return geometry("general_cell", text.str());
  }



  inline const std::string tresca =
    "set Role = contact\nset Friction law = tresca\n"
    "set Friction bound = 1\n";
  inline const std::string coulomb =
    "set Role = contact\nset Friction law = coulomb\n"
    "set Friction coefficient = 0.5\nset Normal stress = -1\n";



  template <int dim>
  bool
  on_edge(const Point<dim> &x)
  {
    return x[0] * x[0] + x[1] * x[1] < 1e-20;
  }



  /// A rotated box, refined near one corner of its contact face (boundary 2).
  template <int dim>
  std::unique_ptr<Body<dim>>
  rotated_body(const std::string &contact,
               const std::string &top = "set Role = clamped")
  {
    std::string text = box<dim>(2, oblique<dim>());
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id,
                       id == 2 ? contact :
                       id == 3 ? top :
                                 "set Role = free");
    auto             body   = std::make_unique<Body<dim>>(text);
    const Point<dim> marked = body->triangulation.begin(0)->vertex(0);
    for (const double radius : {0.9, 0.5})
      body->refine_where([&marked, radius](const Point<dim> &x) {
        return (x - marked).norm() < radius;
      });
    body->set_up();
    return body;
  }



  /// Call visit(x, dof) for each vertex of owned faces of a boundary.
  template <int dim, typename Visitor>
  void
  for_each_vertex_on(const Body<dim>         &body,
                     const types::boundary_id id,
                     const Visitor           &visit)
  {
    for (const auto &cell : body.dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (cell->at_boundary(f) && cell->face(f)->boundary_id() == id)
            for (const unsigned int v : cell->face(f)->vertex_indices())
              visit(cell->face(f)->vertex(v),
                    cell->face(f)->vertex_dof_index(v, 0));
  }
} // namespace Viscoplastic::Testing
