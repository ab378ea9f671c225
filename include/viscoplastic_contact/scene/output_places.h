// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <viscoplastic_contact/parameters/choices.h>
#include <viscoplastic_contact/scene/place_names.h>

#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// A line of `Output/Lines': equidistant points including both ends.
  template <int dim>
  struct OutputLine
  {
    Point<dim>   begin, end;
    unsigned int n_points;

    double
    distance(const unsigned int i) const
    {
      return begin.distance(end) * i / (n_points - 1);
    }

    std::vector<Point<dim>>
    points() const;
  };


  /// One integral of `Output/Integrals', over a boundary, a material or the
  /// body.
  struct OutputIntegral
  {
    enum class Domain
    {
      boundary,
      material,
      body
    };

    Domain                  domain = Domain::body;
    unsigned int            id     = 0; // of a boundary or material
    std::set<RecordedField> fields;
    /// Whether energies are asked for, over a material or the body.
    bool energies = false;

    /// Return the place as in names of columns: `boundary_3', `material_2',
    /// `body'.
    std::string
    name() const;
  };


  /// Read `Output/Points'. Throws ExcMessage, as the functions below do.
  template <int dim>
  std::vector<Point<dim>>
  read_output_points(const std::string &text);

  template <int dim>
  std::vector<OutputLine<dim>>
  read_output_lines(const std::string &text);

  std::vector<OutputIntegral>
  read_output_integrals(const std::string &text, const PlaceNames &names);
} // namespace Viscoplastic
