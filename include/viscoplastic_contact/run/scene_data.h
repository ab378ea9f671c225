// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/time_schedule.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  /// A boundary, a material or the body.
  struct Domain
  {
    enum class Kind
    {
      body,
      boundary,
      material
    };

    Kind         kind = Kind::body;
    unsigned int id   = 0;
  };



  /// Means of the data of a scene over space or time. Means are expressions of
  /// x and t, by component of a vector, which can replace those of the
  /// parameter file; absent if data equal their means. Throws ExcMessage for
  /// unparsable data.
  template <int dim>
  class SceneData
  {
  public:
    using Mesh = parallel::distributed::Triangulation<dim>;
    using Mean = std::optional<std::string>;

    /// Keeps references to both arguments.
    SceneData(const Parameters &scene, const Mesh &triangulation);

    /// The mean over a domain, as an expression of t that is exact at the ends
    /// of all steps and linear between them. Collective.
    Mean
    over_space(const std::string &components, const Domain &domain) const;

    /// The mean over the run, as an expression of x. Data that are uniform in
    /// space are integrated by two Gauss points per step, others by two Gauss
    /// points in each of up to eight parts of a phase.
    Mean
    over_time(const std::string &components) const;

    /// The volume, area or, in 2D, length of a domain. Collective.
    double
    measure(const Domain &domain) const;

  private:
    /// Quadrature points of a domain with their weights, on this rank.
    std::vector<std::pair<Point<dim>, double>>
    quadrature(const Domain &domain) const;

    /// Return the quadrature in time of an expression, with numbers for t.
    std::string
    time_mean_of_text(const std::string &text) const;

    const Parameters   &parameters;
    const Mesh         &triangulation;
    const TimeSchedule  schedule;
    std::vector<double> times; // zero and the ends of steps
  };


  /// Return the function of t that interpolates these values linearly as an
  /// expression; constant before the first time and linear after the last.
  /// Points on a line between others are left out.
  std::string
  piecewise_linear(const std::vector<double> &times,
                   const std::vector<double> &values);
} // namespace Viscoplastic
