// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/plane_model.h>
#include <viscoplastic_contact/run/scene_data.h>

#include <regex>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    using Mean = std::optional<std::string>;



    /// Return a number as text with all of its digits.
    std::string
    exact(const double value)
    {
      return number(value, 17);
    }



    /// Apply a function to the components of a text; return nothing if the
    /// function returns nothing for all components.
    Mean
    by_component(const std::string                              &components,
                 const std::function<Mean(const std::string &)> &function)
    {
      std::istringstream text(components);
      std::string        result, separator;
      bool               differs = false;
      for (std::string component; std::getline(text, component, ';');)
        {
          component = Utilities::trim(component);
          // Components without a value have no mean.
          const Mean mean = component.empty() || component == "free" ?
                              Mean() :
                              function(component);
          differs |= mean.has_value();
          result += separator + mean.value_or(component);
          separator = "; ";
        }
      return differs ? Mean(result) : Mean();
    }



    /// Return the two Gauss points of an interval with their weights.
    std::vector<std::pair<double, double>>
    gauss(const double begin, const double end)
    {
      const double k = end - begin, shift = std::sqrt(1. / 12.);
      return {{begin + (0.5 - shift) * k, 0.5 * k},
              {begin + (0.5 + shift) * k, 0.5 * k}};
    }
  } // namespace



  template <int dim>
  SceneData<dim>::SceneData(const Parameters &scene, const Mesh &triangulation)
    : parameters(scene)
    , triangulation(triangulation)
    , schedule(scene.time.phases)
    , times{0.}
  {
    // Steps of controlled size may be shorter than given ones.
    const unsigned int n_parts =
      scene.step_control.is_on() || scene.error_control.has_tolerance() ? 8 : 1;
    for (unsigned int n = 1; n <= schedule.n_steps(); ++n)
      {
        const TimeStep step = schedule.step(n);
        for (unsigned int i = 1; i < n_parts; ++i)
          times.push_back(step.t_old + step.k * i / n_parts);
        times.push_back(step.t);
      }
  }



  template <int dim>
  std::vector<std::pair<Point<dim>, double>>
  SceneData<dim>::quadrature(const Domain &domain) const
  {
    const Mapping<dim> &mapping =
      mapping_of<dim>(parameters.geometry.plane_model);
    const UpdateFlags     update = update_quadrature_points | update_JxW_values;
    const FE_Nothing<dim> fe;
    FEValues<dim>         of_cell(mapping, fe, QGauss<dim>(3), update);
    FEFaceValues<dim>     of_face(mapping, fe, QGauss<dim - 1>(3), update);
    std::vector<std::pair<Point<dim>, double>> result;
    const auto add = [&result](const FEValuesBase<dim> &values) {
      for (const unsigned int q : values.quadrature_point_indices())
        result.emplace_back(values.quadrature_point(q), values.JxW(q));
    };
    for (const auto &cell : triangulation.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        if (domain.kind == Domain::Kind::body ||
            (domain.kind == Domain::Kind::material &&
             domain.id == cell->material_id()))
          {
            of_cell.reinit(cell);
            add(of_cell);
          }
        if (domain.kind == Domain::Kind::boundary)
          for (const auto f : cell->face_indices())
            if (cell->face(f)->at_boundary() &&
                cell->face(f)->boundary_id() == domain.id)
              {
                of_face.reinit(cell, f);
                add(of_face);
              }
      }
    return result;
  }



  template <int dim>
  typename SceneData<dim>::Mean
  SceneData<dim>::over_space(const std::string &components,
                             const Domain      &domain) const
  {
    std::optional<std::vector<std::pair<Point<dim>, double>>> points;
    return by_component(components, [&](const std::string &text) -> Mean {
      const Expression<dim> datum(text, "its mean");
      if (!datum.depends_on_position())
        return {};
      if (!points)
        points = quadrature(domain);
      const auto at = [&](const double t) {
        double sum = 0., measure = 0.;
        for (const auto &[x, weight] : *points)
          {
            sum += weight * datum.value(x, t);
            measure += weight;
          }
        const MPI_Comm communicator = triangulation.get_communicator();
        sum                         = Utilities::MPI::sum(sum, communicator);
        measure = Utilities::MPI::sum(measure, communicator);
        return measure > 0. ? sum / measure : 0.;
      };
      if (!datum.depends_on_time())
        return exact(at(0.));
      std::vector<double> means;
      for (const double t : times)
        means.push_back(at(t));
      return piecewise_linear(times, means);
    });
  }



  template <int dim>
  typename SceneData<dim>::Mean
  SceneData<dim>::over_time(const std::string &components) const
  {
    return by_component(components, [this](const std::string &text) -> Mean {
      const Expression<dim> datum(text, "its mean");
      if (!datum.depends_on_time())
        return {};
      if (datum.depends_on_position())
        return time_mean_of_text(text);
      double sum = 0.;
      for (std::size_t i = 1; i < times.size(); ++i)
        for (const auto &[t, weight] : gauss(times[i - 1], times[i]))
          sum += weight * datum.value(Point<dim>(), t);
      return exact(sum / schedule.end_time());
    });
  }



  template <int dim>
  double
  SceneData<dim>::measure(const Domain &domain) const
  {
    double sum = 0.;
    for (const auto &point : quadrature(domain))
      sum += point.second;
    return Utilities::MPI::sum(sum, triangulation.get_communicator());
  }



  template <int dim>
  std::string
  SceneData<dim>::time_mean_of_text(const std::string &text) const
  {
    const std::regex time("\\bt\\b");
    std::string      sum;
    for (const TimeSchedule::Phase &phase : schedule.phases)
      {
        const unsigned int n_parts = std::min(8u, phase.n_steps);
        const double       k       = (phase.end - phase.start) / n_parts;
        for (unsigned int i = 0; i < n_parts; ++i)
          for (const auto &[t, weight] :
               gauss(phase.start + i * k, phase.start + (i + 1) * k))
            sum += (sum.empty() ? "" : "+") +
                   exact(weight / schedule.end_time()) + "*(" +
                   std::regex_replace(text, time, '(' + exact(t) + ')') + ')';
      }
    return sum;
  }



  std::string
  piecewise_linear(const std::vector<double> &times,
                   const std::vector<double> &values)
  {
    double largest = 0.;
    for (const double value : values)
      largest = std::max(largest, std::abs(value));
    const double tolerance = 1e-9 * largest;

    // A sum of ramps. The slope after a new node leads from the sum so far to
    // the next value, so that errors of points left out do not accumulate.
    std::string text = exact(values.front());
    double      node = times.front(), at_node = values.front(), slope = 0.;
    for (std::size_t i = 1; i < times.size(); ++i)
      {
        if (std::abs(at_node + slope * (times[i] - node) - values[i]) <=
            tolerance)
          continue;
        at_node += slope * (times[i - 1] - node);
        node                   = times[i - 1];
        const double new_slope = (values[i] - at_node) / (times[i] - node);
        text += '+' + ('(' + exact(new_slope - slope)) + ")*max(0,t-" +
                exact(node) + ')';
        slope = new_slope;
      }
    return text;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(SceneData);
} // namespace Viscoplastic
