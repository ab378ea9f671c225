// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>
#include <viscoplastic_contact/mesh/point_location.h>
#include <viscoplastic_contact/scene/scene.h>

#include <algorithm>

namespace Viscoplastic
{
  namespace
  {
    // Beyond that it is rather a mistake; the points are kept in memory.
    constexpr int most_points_of_line = 100000;



    RecordedField
    read_field(const std::string &name)
    {
      const std::vector<std::string> names =
        Utilities::split_string_list(choices(RecordedField()), '|');
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
        {
          const std::string nearest = nearest_name(name, names);
          AssertThrow(false,
                      ExcMessage("'Output/Integrals': there is no field '" +
                                 excerpt(name) + "'; " +
                                 (nearest.empty() ?
                                    "the fields are " + enumeration(names) :
                                    "did you mean " + nearest) +
                                 (nearest.empty() ? "." : "?")));
        }
      return static_cast<RecordedField>(found - names.begin());
    }



    /// The integral over what @p place names, without fields.
    OutputIntegral
    read_domain(const std::string &place)
    {
      using Domain = OutputIntegral::Domain;
      OutputIntegral    result;
      const std::size_t blank = place.find(' ');
      const std::string kind  = place.substr(0, blank);
      bool              fits  = kind == "body" && blank == std::string::npos;
      if ((kind == "boundary" || kind == "material") &&
          blank != std::string::npos)
        {
          result.domain =
            kind == "boundary" ? Domain::boundary : Domain::material;
          const std::string id = Utilities::trim(place.substr(blank));
          fits                 = !id.empty() && id.size() < 9 &&
                 id.find_first_not_of("0123456789") == std::string::npos;
          if (fits)
            result.id = Utilities::string_to_int(id);
        }
      AssertThrow(fits,
                  ExcMessage("'Output/Integrals': '" + excerpt(place) +
                             "' is no place to integrate over; write "
                             "`boundary ID: fields', `material ID: fields' or "
                             "`body: fields'."));
      return result;
    }



    /// Throw unless the scene has the fields of contact and friction that @p
    /// entry asks for.
    template <int dim>
    void
    check_fields(const Scene<dim>              &scene,
                 const std::set<RecordedField> &fields,
                 const std::string             &entry)
    {
      for (const RecordedField field : fields)
        {
          AssertThrow(!is_of_contact(field) || scene.has_contact(),
                      ExcMessage("'" + entry + "': there is no `" +
                                 name_of(field) +
                                 "' where no boundary has the role contact."));
          AssertThrow(!is_of_friction(field) || scene.has_friction(),
                      ExcMessage("'" + entry + "': there is no `" +
                                 name_of(field) +
                                 "' where no boundary has friction."));
          AssertThrow(!is_of_unilateral_contact(field) ||
                        scene.has_unilateral_contact(),
                      ExcMessage("'" + entry + "': there is no `" +
                                 name_of(field) +
                                 "' where no boundary has unilateral "
                                 "contact."));
        }
    }



    /// Throw likewise for places, of which some have to be on Gamma_3 if there
    /// are fields of the boundary.
    template <int dim>
    void
    check_fields_at(
      const Scene<dim>                                &scene,
      const parallel::distributed::Triangulation<dim> &triangulation,
      const std::vector<Point<dim>>                   &points,
      const std::set<RecordedField>                   &fields,
      const std::string                               &entry,
      const std::string                               &places)
    {
      check_fields(scene, fields, entry);
      const auto field =
        std::find_if(fields.begin(), fields.end(), is_of_boundary);
      if (points.empty() || field == fields.end())
        return;
      const auto found =
        locate_on_boundary(triangulation, points, scene.contact_boundaries());
      AssertThrow(std::count(found.distances.begin(),
                             found.distances.end(),
                             0.) > 0,
                  ExcMessage("'" + entry + "': `" + name_of(*field) +
                             "' is a field of boundaries with the role "
                             "contact, and " +
                             places + "."));
    }
  } // namespace



  template <int dim>
  std::vector<Point<dim>>
  OutputLine<dim>::points() const
  {
    std::vector<Point<dim>> result;
    for (unsigned int i = 0; i < n_points; ++i)
      {
        // Exactly the ends.
        const double share = double(i) / (n_points - 1);
        result.push_back(Point<dim>((1. - share) * begin + share * end));
      }
    return result;
  }



  std::string
  OutputIntegral::name() const
  {
    return domain == Domain::body ?
             "body" :
             (domain == Domain::boundary ? "boundary_" : "material_") +
               std::to_string(id);
  }



  template <int dim>
  std::vector<Point<dim>>
  read_output_points(const std::string &text)
  {
    std::vector<Point<dim>> result;
    for (const std::string &point : Utilities::split_string_list(text, ';'))
      if (!point.empty())
        result.push_back(parse_point<dim>(point, "Output/Points"));
    return result;
  }



  template <int dim>
  std::vector<OutputLine<dim>>
  read_output_lines(const std::string &text)
  {
    std::vector<OutputLine<dim>> result;
    for (const std::string &line : Utilities::split_string_list(text, ';'))
      {
        if (line.empty())
          continue;
        const auto parts = Utilities::split_string_list(line, ':');
        AssertThrow(parts.size() == 3,
                    ExcMessage("'Output/Lines': '" + excerpt(line) +
                               "' is no line; write `begin : end : number of "
                               "points'."));
        int n_points = 0;
        try
          {
            n_points = Utilities::string_to_int(parts[2]);
          }
        catch (const std::exception &)
          {
            n_points = 0; // refused below
          }
        AssertThrow(n_points >= 2 && n_points <= most_points_of_line,
                    ExcMessage("'Output/Lines': a line has a number of points "
                               "from 2 to " +
                               std::to_string(most_points_of_line) + ", not '" +
                               excerpt(parts[2]) + "'."));
        result.push_back({parse_point<dim>(parts[0], "Output/Lines"),
                          parse_point<dim>(parts[1], "Output/Lines"),
                          static_cast<unsigned int>(n_points)});
        AssertThrow(result.back().begin != result.back().end,
                    ExcMessage("'Output/Lines': the line '" + excerpt(line) +
                               "' begins where it ends."));
      }
    return result;
  }



  std::vector<OutputIntegral>
  read_output_integrals(const std::string &text)
  {
    std::vector<OutputIntegral> result;
    for (const std::string &entry : Utilities::split_string_list(text, ';'))
      {
        if (entry.empty())
          continue;
        const std::size_t colon = entry.find(':');
        OutputIntegral    integral =
          read_domain(Utilities::trim(entry.substr(0, colon)));
        const std::string fields =
          colon == std::string::npos ? "" : entry.substr(colon + 1);
        for (const std::string &field : Utilities::split_string_list(fields))
          {
            if (field == "energies")
              integral.energies = true;
            else if (!field.empty())
              integral.fields.insert(read_field(field));
          }
        for (const RecordedField field : integral.fields)
          AssertThrow(integral.domain == OutputIntegral::Domain::boundary ||
                        !is_of_boundary(field),
                      ExcMessage("'Output/Integrals': `" + name_of(field) +
                                 "' is a field of boundaries, and " +
                                 entry.substr(0, colon) + " is none."));
        AssertThrow(!integral.energies ||
                      integral.domain != OutputIntegral::Domain::boundary,
                    ExcMessage("'Output/Integrals': `energies' are those of "
                               "materials or the body, not of " +
                               entry.substr(0, colon) + "."));
        for (const OutputIntegral &other : result)
          AssertThrow(other.name() != integral.name(),
                      ExcMessage("'Output/Integrals' has " +
                                 entry.substr(0, colon) +
                                 " twice; give its fields once, separated by "
                                 "commas."));
        result.push_back(integral);
      }
    return result;
  }



  template <int dim>
  std::vector<std::string>
  check_output_places(
    const Scene<dim>                                &scene,
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    const OutputParameters &asked = scene.parameters.output;
    check_points(triangulation, scene.output_points, "Output/Points");
    check_fields_at(scene,
                    triangulation,
                    scene.output_points,
                    asked.point_fields,
                    "Output/Point fields",
                    "none of 'Output/Points' is on one");
    std::vector<Point<dim>> points_of_lines;
    for (const OutputLine<dim> &line : scene.output_lines)
      for (const Point<dim> &x : line.points())
        points_of_lines.push_back(x);
    check_points(triangulation, points_of_lines, "Output/Lines");
    check_fields_at(scene,
                    triangulation,
                    points_of_lines,
                    asked.line_fields,
                    "Output/Line fields",
                    "none of 'Output/Lines' has a point on one");

    using Domain                                 = OutputIntegral::Domain;
    const std::string                  entry     = "Output/Integrals";
    const std::set<types::material_id> materials = material_ids(triangulation);
    for (const OutputIntegral &integral : scene.output_integrals)
      {
        const std::string id = std::to_string(integral.id);
        AssertThrow(integral.domain != Domain::material ||
                      materials.count(integral.id) == 1,
                    ExcMessage("'" + entry + "': no cell has the material id " +
                               id + "; the mesh has the material ids " +
                               list({materials.begin(), materials.end()}) +
                               "."));
        if (integral.domain != Domain::boundary)
          continue;
        const auto boundary = scene.boundary.find(integral.id);
        AssertThrow(boundary != scene.boundary.end(),
                    ExcMessage("'" + entry + "': there is no boundary " + id +
                               "; the mesh has the ids " +
                               list(boundary_ids(triangulation)) + "."));
        for (const RecordedField field : integral.fields)
          AssertThrow(
            (!is_of_contact(field) ||
             boundary->second.role == BoundaryRole::contact) &&
              (!is_of_friction(field) || boundary->second.has_friction()) &&
              (!is_of_unilateral_contact(field) ||
               boundary->second.is_unilateral()),
            ExcMessage("'" + entry + "': boundary " + id + " has no `" +
                       name_of(field) + "', which takes " +
                       (is_of_friction(field) ? "friction." :
                        is_of_unilateral_contact(field) ?
                                                "unilateral contact." :
                                                "the role contact.")));
      }

    std::vector<std::string> warnings;
    if (!asked.point_fields.empty() && scene.output_points.empty())
      warnings.push_back(
        "'Output/Point fields' is not used without 'Output/Points'.");
    if (!asked.line_fields.empty() && scene.output_lines.empty())
      warnings.push_back(
        "'Output/Line fields' is not used without 'Output/Lines'.");
    return warnings;
  }



  template struct OutputLine<2>;
  template struct OutputLine<3>;
  template std::vector<Point<2>>
  read_output_points(const std::string &);
  template std::vector<Point<3>>
  read_output_points(const std::string &);
  template std::vector<OutputLine<2>>
  read_output_lines(const std::string &);
  template std::vector<OutputLine<3>>
  read_output_lines(const std::string &);
  template std::vector<std::string>
  check_output_places(const Scene<2> &,
                      const parallel::distributed::Triangulation<2> &);
  template std::vector<std::string>
  check_output_places(const Scene<3> &,
                      const parallel::distributed::Triangulation<3> &);
} // namespace Viscoplastic
