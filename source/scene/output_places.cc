// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/scene/output_places.h>

namespace Viscoplastic
{
  namespace
  {
    // All points are kept in memory; a larger number is probably a mistake.
    constexpr int most_points_of_line = 100000;



    RecordedField
    read_field(const std::string &name)
    {
      const std::vector<std::string> names =
        Utilities::split_string_list(choices<RecordedField>, '|');
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
        {
          const std::string nearest = nearest_name(name, names);
          refuse("'Output/Integrals': there is no field '" + excerpt(name) +
                 "'; " +
                 (nearest.empty() ? "the fields are " + enumeration(names) :
                                    "did you mean " + nearest) +
                 (nearest.empty() ? "." : "?"));
        }
      return static_cast<RecordedField>(found - names.begin());
    }



    /// The integral over the place with this name, without fields.
    OutputIntegral
    read_domain(const std::string &place, const PlaceNames &names)
    {
      using Domain = OutputIntegral::Domain;
      OutputIntegral result;
      if (place == "body")
        return result;
      const auto found = names.find(place);
      if (!found || (found->kind != "boundary" && found->kind != "material"))
        refuse(
          "'Output/Integrals': '" + excerpt(place) +
          "' is no place to integrate over; write `boundary ID: fields', "
          "`material ID: fields' or `body: fields', or the name of the place.");
      result.domain =
        found->kind == "boundary" ? Domain::boundary : Domain::material;
      result.id = found->number;
      return result;
    }
  } // namespace



  template <int dim>
  std::vector<Point<dim>>
  OutputLine<dim>::points() const
  {
    std::vector<Point<dim>> result;
    for (unsigned int i = 0; i < n_points; ++i)
      {
        // This form is exact at both ends.
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
        result.push_back(
          parse_point<dim>(split_name(point).second, "Output/Points"));
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
        const auto parts =
          Utilities::split_string_list(split_name(line).second, ':');
        if (parts.size() != 3)
          refuse("'Output/Lines': '" + excerpt(line) +
                 "' is no line; write `begin : end : number of points'.");
        const double n_points = number_of(parts[2]).value_or(0.);
        if (!(n_points >= 2.) || !(n_points <= most_points_of_line) ||
            n_points != std::floor(n_points))
          refuse("'Output/Lines': a line has a number of points from 2 to " +
                 std::to_string(most_points_of_line) + ", not '" +
                 excerpt(parts[2]) + "'.");
        result.push_back({parse_point<dim>(parts[0], "Output/Lines"),
                          parse_point<dim>(parts[1], "Output/Lines"),
                          static_cast<unsigned int>(n_points)});
        if (result.back().begin == result.back().end)
          refuse("'Output/Lines': the line '" + excerpt(line) +
                 "' begins where it ends.");
      }
    return result;
  }



  std::vector<OutputIntegral>
  read_output_integrals(const std::string &text, const PlaceNames &names)
  {
    std::vector<OutputIntegral> result;
    for (const std::string &entry : Utilities::split_string_list(text, ';'))
      {
        if (entry.empty())
          continue;
        const std::size_t colon = entry.find(':');
        OutputIntegral    integral =
          read_domain(Utilities::trim(entry.substr(0, colon)), names);
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
          if (integral.domain != OutputIntegral::Domain::boundary &&
              is_of_boundary(field))
            refuse("'Output/Integrals': `" + name_of(field) +
                   "' is a field of boundaries, and " + entry.substr(0, colon) +
                   " is none.");
        if (integral.energies &&
            integral.domain == OutputIntegral::Domain::boundary)
          refuse("'Output/Integrals': `energies' are those of materials or the "
                 "body, not of " +
                 entry.substr(0, colon) + ".");
        for (const OutputIntegral &other : result)
          if (other.name() == integral.name())
            refuse("'Output/Integrals' has " + entry.substr(0, colon) +
                   " twice; give its fields once, separated by commas.");
        result.push_back(integral);
      }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(read_output_points);
  VISCOPLASTIC_INSTANTIATE(read_output_lines);
} // namespace Viscoplastic
