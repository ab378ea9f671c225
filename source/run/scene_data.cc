// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/mesh/plane_model.h>
#include <viscoplastic_contact/parameters/time_schedule.h>
#include <viscoplastic_contact/run/scene_data.h>
#include <viscoplastic_contact/scene/scene.h>

#include <numeric>
#include <regex>

namespace Viscoplastic
{
  namespace
  {
    /// Return a number as text with all of its digits.
    std::string
    exact(const double value)
    {
      return number(value, 17);
    }



    /// Apply a function to the components of a text; return nothing if the
    /// function returns nothing for all components.
    std::optional<std::string>
    by_component(
      const std::string &components,
      const std::function<std::optional<std::string>(const std::string &)>
        &function)
    {
      std::string result;
      bool        differs = false;
      std::size_t begin   = 0;
      for (;;)
        {
          const std::size_t end = components.find(';', begin);
          const std::string component =
            Utilities::trim(components.substr(begin, end - begin));
          // Components without a value have no mean.
          const auto mean = component.empty() || component == "free" ?
                              std::optional<std::string>() :
                              function(component);
          differs |= mean.has_value();
          result += mean.value_or(component);
          if (end == std::string::npos)
            break;
          result += "; ";
          begin = end + 1;
        }
      return differs ? std::optional<std::string>(result) : std::nullopt;
    }



    template <int dim>
    class SceneOnMesh : public SceneData
    {
    public:
      SceneOnMesh(const Parameters &scene, const MPI_Comm communicator)
        : parameters(scene)
        , schedule(scene.time.phases)
        , communicator(communicator)
        , triangulation(communicator)
        , mapping(mapping_of<dim>(scene.geometry.plane_model))
      {
        make_mesh(scene.geometry, triangulation);
        const bool chooses_steps =
          scene.step_control.is_on() || scene.error_control.has_tolerance();
        times.push_back(0.);
        for (unsigned int n = 1; n <= schedule.n_steps(); ++n)
          {
            const TimeStep step = schedule.step(n);
            // Steps of controlled size may be shorter than given ones.
            const unsigned int n_parts = chooses_steps ? 8 : 1;
            for (unsigned int i = 1; i < n_parts; ++i)
              times.push_back(step.t_old + step.k * i / n_parts);
            times.push_back(step.t);
          }
      }

      std::optional<std::string>
      over_boundary(const std::string &components,
                    const unsigned int id) const override
      {
        return over_space(components, [this, id](Places &places) {
          add_boundary(id, places);
        });
      }

      std::optional<std::string>
      over_body(const std::string                &components,
                const std::optional<unsigned int> material) const override
      {
        return over_space(components, [&](Places &places) {
          FEValues<dim> values(mapping,
                               fe,
                               QGauss<dim>(3),
                               update_quadrature_points | update_JxW_values);
          for (const auto &cell : triangulation.active_cell_iterators())
            if (cell->is_locally_owned() &&
                (!material || cell->material_id() == *material))
              {
                values.reinit(cell);
                places.add(values);
              }
        });
      }

      std::optional<std::string>
      over_time(const std::string &components) const override
      {
        return by_component(
          components,
          [this](const std::string &text) -> std::optional<std::string> {
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

      double
      area(const unsigned int id) const override
      {
        Places places;
        add_boundary(id, places);
        return Utilities::MPI::sum(std::accumulate(places.weights.begin(),
                                                   places.weights.end(),
                                                   0.),
                                   communicator);
      }

      VolumetricIntegration
      volumetric_integration() const override
      {
        Scene<dim> scene(parameters);
        scene.inspect(triangulation);
        double max_nu = -1.;
        for (const auto &cell : triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            max_nu = std::max(max_nu,
                              scene.material(cell->material_id())
                                .stiffness(cell->center())
                                .poissons_ratio());
        max_nu = Utilities::MPI::max(max_nu, communicator);
        return uses_mean_dilatation(scene, max_nu) ?
                 VolumetricIntegration::mean_dilatation :
                 VolumetricIntegration::full;
      }

    private:
      /// Quadrature points and weights on this rank.
      struct Places
      {
        std::vector<Point<dim>> points;
        std::vector<double>     weights;

        void
        add(const FEValuesBase<dim> &values)
        {
          for (const unsigned int q : values.quadrature_point_indices())
            {
              points.push_back(values.quadrature_point(q));
              weights.push_back(values.JxW(q));
            }
        }
      };

      void
      add_boundary(const unsigned int id, Places &places) const
      {
        FEFaceValues<dim> values(mapping,
                                 fe,
                                 QGauss<dim - 1>(3),
                                 update_quadrature_points | update_JxW_values);
        for (const auto &cell : triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            for (const auto f : cell->face_indices())
              if (cell->face(f)->at_boundary() &&
                  cell->face(f)->boundary_id() == id)
                {
                  values.reinit(cell, f);
                  places.add(values);
                }
      }

      std::optional<std::string>
      over_space(const std::string                   &components,
                 const std::function<void(Places &)> &collect) const
      {
        std::optional<Places> places;
        return by_component(
          components,
          [&](const std::string &text) -> std::optional<std::string> {
            const Expression<dim> datum(text, "its mean");
            if (!datum.depends_on_position())
              return {};
            if (!places)
              collect(places.emplace());
            const auto at = [&](const double t) {
              double sum = 0., measure = 0.;
              for (std::size_t i = 0; i < places->points.size(); ++i)
                {
                  sum += places->weights[i] * datum.value(places->points[i], t);
                  measure += places->weights[i];
                }
              sum     = Utilities::MPI::sum(sum, communicator);
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

      /// Return the two Gauss points of an interval with their weights.
      static std::vector<std::pair<double, double>>
      gauss(const double begin, const double end)
      {
        const double k = end - begin, shift = std::sqrt(1. / 12.);
        return {{begin + (0.5 - shift) * k, 0.5 * k},
                {begin + (0.5 + shift) * k, 0.5 * k}};
      }

      /// Return the quadrature in time of an expression, with numbers for t.
      std::string
      time_mean_of_text(const std::string &text) const
      {
        const std::regex time("\\bt\\b");
        std::string      sum;
        double           begin = 0.;
        while (begin < schedule.end_time())
          {
            const auto        &phase   = schedule.phase_at(begin);
            const unsigned int n_parts = std::min(8u, phase.n_steps);
            const double       k       = (phase.end - phase.start) / n_parts;
            for (unsigned int i = 0; i < n_parts; ++i)
              for (const auto &[t, weight] :
                   gauss(phase.start + i * k, phase.start + (i + 1) * k))
                sum += (sum.empty() ? "" : "+") +
                       exact(weight / schedule.end_time()) + "*(" +
                       std::regex_replace(text, time, '(' + exact(t) + ')') +
                       ')';
            begin = phase.end;
          }
        return sum;
      }

      const Parameters                         &parameters;
      const TimeSchedule                        schedule;
      const MPI_Comm                            communicator;
      parallel::distributed::Triangulation<dim> triangulation;
      const FE_Nothing<dim>                     fe;
      const Mapping<dim>                       &mapping;
      /// Zero and the ends of steps.
      std::vector<double> times;
    };
  } // namespace



  std::unique_ptr<const SceneData>
  SceneData::of(const Parameters &scene, const MPI_Comm communicator)
  {
    if (scene.dimension == 2)
      return std::make_unique<SceneOnMesh<2>>(scene, communicator);
    return std::make_unique<SceneOnMesh<3>>(scene, communicator);
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
} // namespace Viscoplastic
