// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>
#include <viscoplastic_contact/mesh/mesh_size.h>
#include <viscoplastic_contact/scene/support.h>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// The largest distance from a vertex, relative to the size of the body.
    constexpr double vertex_tolerance = 1e-6;



    /// Return the displacement entry of the held components: `0; free' for `x'.
    template <int dim>
    std::string
    displacement_of(const std::string &components,
                    const std::string &entry,
                    const std::string &support)
    {
      std::array<bool, dim> is_held{};
      bool                  any = false;
      for (const std::string &name :
           Utilities::split_string_list(components, ' '))
        {
          if (name.empty())
            continue;
          const std::size_t d = std::string("xyz").substr(0, dim).find(name);
          if (name.size() != 1 || d == std::string::npos)
            refuse("'" + entry + "': '" + excerpt(support) + "' holds '" +
                   excerpt(name) + "', but components are " +
                   (dim == 2 ? "x and y." : "x, y and z."));
          is_held[d] = any = true;
        }
      if (!any)
        refuse("'" + entry + "': '" + excerpt(support) +
               "' holds nothing; write `" +
               (entry == "Supports/Points" ? "coordinates" : "boundary ids") +
               ": components', such as x y.");
      std::string result;
      for (unsigned int d = 0; d < dim; ++d)
        result += std::string(d == 0 ? "" : "; ") + (is_held[d] ? "0" : "free");
      return result;
    }



    std::set<types::boundary_id>
    read_ids(const std::string &text, const std::string &support)
    {
      std::set<types::boundary_id> result;
      for (const std::string &id : Utilities::split_string_list(text, ','))
        {
          if (id.empty() || id.size() >= 10 ||
              id.find_first_not_of("0123456789") != std::string::npos)
            refuse("'Supports/Edges': '" + excerpt(id) + "' in '" +
                   excerpt(support) + "' is no boundary id.");
          result.insert(Utilities::string_to_int(id));
        }
      if (result.size() <= 1)
        refuse("'Supports/Edges': '" + excerpt(support) +
               "' names one boundary; an edge is where at least two meet, such "
               "as `1, 3: y'.");
      return result;
    }



    template <int dim>
    Support<dim>
    read_support(const std::string       &text,
                 const std::string       &entry,
                 const types::boundary_id id)
    {
      const std::size_t  colon = text.find(':');
      BoundaryParameters held;
      held.role                    = BoundaryRole::displacement;
      held.entries["Displacement"] = displacement_of<dim>(
        colon == std::string::npos ? "" : text.substr(colon + 1), entry, text);
      Support<dim>      result{"", {}, {}, BoundaryCondition<dim>(id, held)};
      const std::string where = text.substr(0, colon);
      if (entry == "Supports/Points")
        {
          result.position = parse_point<dim>(where, entry);
          result.place    = "the point (" + as_text(*result.position) + ')';
        }
      else
        {
          result.boundaries = read_ids(where, text);
          result.place = "the meeting of boundaries " + list(result.boundaries);
        }
      return result;
    }
  } // namespace



  std::string
  name_in_columns(const types::boundary_id id)
  {
    return id < first_support_id ?
             std::to_string(id) :
           id < first_edge_id ?
             "point" + std::to_string(id - first_support_id) :
             "edge" + std::to_string(id - first_edge_id);
  }



  template <int dim>
  std::vector<Support<dim>>
  read_supports(const SupportParameters &parameters)
  {
    std::vector<Support<dim>> result;
    for (const auto &[entry, first_id, text] :
         {std::make_tuple("Supports/Points",
                          first_support_id,
                          &parameters.points),
          std::make_tuple("Supports/Edges", first_edge_id, &parameters.edges)})
      {
        types::boundary_id id = first_id;
        for (const std::string &support :
             Utilities::split_string_list(*text, ';'))
          if (!support.empty())
            result.push_back(read_support<dim>(support, entry, id++));
      }
    return result;
  }



  template <int dim>
  std::vector<std::string>
  place_supports(
    const parallel::distributed::Triangulation<dim>            &triangulation,
    const std::map<types::boundary_id, BoundaryCondition<dim>> &boundary,
    std::vector<Support<dim>>                                  &supports)
  {
    std::vector<std::string> warnings;
    if (supports.empty())
      return warnings;
    const auto   vertices = boundaries_at_vertices(triangulation);
    const double size     = body_diagonal(triangulation);
    for (Support<dim> &support : supports)
      {
        // The boundaries on which all nodes of the support lie.
        std::set<types::boundary_id> here = support.boundaries;
        if (support.position)
          {
            const Point<dim> given   = *support.position;
            double           nearest = std::numeric_limits<double>::max();
            for (const auto &[vertex, ids] : vertices)
              {
                const Point<dim> &x = triangulation.get_vertices()[vertex];
                if (x.distance(given) < nearest)
                  {
                    nearest          = x.distance(given);
                    support.position = x;
                    here             = ids;
                  }
              }
            if (!(nearest <= vertex_tolerance * size))
              refuse("'Supports/Points': there is no vertex of the coarse mesh "
                     "at (" +
                     as_text(given) + "); the nearest one is at (" +
                     as_text(*support.position) +
                     "). More cells in the coarse mesh have more vertices.");
          }
        else
          {
            for (const types::boundary_id id : here)
              if (boundary.count(id) != 1)
                refuse("'Supports/Edges': there is no boundary " +
                       std::to_string(id) + "; the mesh has the ids " +
                       list(boundary_ids(triangulation)) + ".");
            if (!std::any_of(vertices.begin(),
                             vertices.end(),
                             [&here](const auto &vertex) {
                               return std::includes(vertex.second.begin(),
                                                    vertex.second.end(),
                                                    here.begin(),
                                                    here.end());
                             }))
              refuse("'Supports/Edges': boundaries " + list(here) +
                     " do not meet.");
          }
        for (const types::boundary_id id : here)
          if (const BoundaryCondition<dim> &other = boundary.at(id);
              other.constrains() || other.has_contact_points())
            warnings.push_back(
              "The support at " + support.place + " is on boundary " +
              std::to_string(id) + ", which has " +
              (other.role == BoundaryRole::contact ?
                 "contact" :
                 "prescribed displacements") +
              " there; the support holds what is left free, and " +
              (other.has_contact_points() ?
                 "contact and friction see nothing of what it holds." :
                 "nothing where that holds all of it."));
      }
    return warnings;
  }



  VISCOPLASTIC_INSTANTIATE(read_supports);
  VISCOPLASTIC_INSTANTIATE(place_supports);
} // namespace Viscoplastic
