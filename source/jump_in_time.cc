// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/jump_in_time.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// Of the largest values in the run: less is not called a jump.
    constexpr double smallest_share = 0.05;
    /// Of the end time: where a change within that is called a jump.
    constexpr double width = 1e-12;
    /// Intervals between which jumps are looked for, in all and in a phase.
    constexpr unsigned int n_intervals = 200, least_intervals = 10;
    /// Intervals that are halved.
    constexpr unsigned int n_candidates = 4;
    /// So many places, or a few more, stand for a piece of the boundary or for
    /// the body.
    constexpr unsigned int n_places = 64;

    struct Interval
    {
      double              left, right;
      std::vector<double> at_left, at_right; // by place

      double
      change() const
      {
        double sum = 0.;
        for (std::size_t i = 0; i < at_left.size(); ++i)
          sum += std::fabs(at_right[i] - at_left[i]);
        return sum;
      }
    };



    std::vector<double>
    sample_times(const TimeSchedule &schedule)
    {
      const unsigned int n =
        std::max(least_intervals, n_intervals / schedule.n_phases());
      std::vector<double> times{0.};
      while (times.back() < schedule.end_time())
        {
          const TimeSchedule::Phase &phase = schedule.phase_at(times.back());
          for (unsigned int i = 1; i < n; ++i)
            times.push_back(phase.start + i * (phase.end - phase.start) / n);
          times.push_back(phase.end);
        }
      return times;
    }



    double
    sum_of_sizes(const std::vector<double> &values)
    {
      double sum = 0.;
      for (const double value : values)
        sum += std::fabs(value);
      return sum;
    }



    /// Places in cells or faces of dimension @p n, spread evenly.
    template <int n, int dim, typename Iterator>
    std::vector<Point<dim>>
    places_in(const std::vector<Iterator> &parts)
    {
      if (parts.empty())
        return {};
      const std::size_t stride =
        std::max<std::size_t>(1, parts.size() / n_places);
      const double       in_each = double(n_places) * stride / parts.size();
      const QIterated<n> lattice(QMidpoint<1>(),
                                 std::ceil(std::pow(in_each, 1. / n)));
      std::vector<Point<dim>> places;
      for (std::size_t i = 0; i < parts.size(); i += stride)
        for (const Point<n> &point : lattice.get_points())
          {
            Point<dim> x;
            for (const unsigned int v : parts[i]->vertex_indices())
              x += GeometryInfo<n>::d_linear_shape_function(point, v) *
                   parts[i]->vertex(v);
            places.push_back(x);
          }
      return places;
    }



    /// On the coarse mesh, which all ranks know.
    template <int dim>
    std::vector<Point<dim>>
    places_on_boundary(const Triangulation<dim> &triangulation,
                       const types::boundary_id  id)
    {
      std::vector<typename Triangulation<dim>::face_iterator> faces;
      for (const auto &cell : triangulation.cell_iterators_on_level(0))
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary() &&
              cell->face(f)->boundary_id() == id)
            faces.push_back(cell->face(f));
      return places_in<dim - 1, dim>(faces);
    }



    template <int dim>
    std::vector<Point<dim>>
    places_in_body(const Triangulation<dim> &triangulation)
    {
      std::vector<typename Triangulation<dim>::cell_iterator> cells;
      for (const auto &cell : triangulation.cell_iterators_on_level(0))
        cells.push_back(cell);
      return places_in<dim, dim>(cells);
    }
  } // namespace



  template <int dim>
  std::optional<double>
  find_jump(const Expression<dim>         &datum,
            const std::vector<Point<dim>> &places,
            const TimeSchedule            &schedule)
  {
    if (!datum.may_jump() || places.empty())
      return {};
    const auto values = [&](const double t) {
      std::vector<double> result;
      for (const Point<dim> &x : places)
        result.push_back(datum.value(x, t));
      return result;
    };
    try
      {
        std::vector<Interval> intervals;
        double                left    = 0.;
        auto                  at_left = values(left);
        double                size    = sum_of_sizes(at_left);
        for (const double right : sample_times(schedule))
          if (right > left)
            {
              auto at_right = values(right);
              size          = std::max(size, sum_of_sizes(at_right));
              intervals.push_back({left, right, at_left, at_right});
              left    = right;
              at_left = std::move(at_right);
            }

        const auto n = std::min<std::size_t>(n_candidates, intervals.size());
        std::partial_sort(intervals.begin(),
                          intervals.begin() + n,
                          intervals.end(),
                          [](const Interval &a, const Interval &b) {
                            return a.change() > b.change();
                          });
        for (std::size_t c = 0; c < n; ++c)
          {
            Interval &interval = intervals[c];
            while (interval.change() > smallest_share * size &&
                   interval.right - interval.left > width * schedule.end_time())
              {
                const double middle    = 0.5 * (interval.left + interval.right);
                const auto   at_middle = values(middle);
                Interval     first{interval.left,
                               middle,
                               interval.at_left,
                               at_middle},
                  second{middle, interval.right, at_middle, interval.at_right};
                interval = first.change() > second.change() ? first : second;
              }
            if (interval.change() > smallest_share * size)
              return interval.right;
          }
      }
    catch (const ExceptionBase &)
      {
        // No value at a time that perhaps no step has.
      }
    return {};
  }



  template <int dim>
  std::string
  warning_of_jumps(const Scene<dim>         &scene,
                   const Triangulation<dim> &triangulation)
  {
    std::ostringstream    found;
    std::set<std::string> entries; // components have the same one
    const auto            inspect = [&](const Expression<dim>         &datum,
                             const std::vector<Point<dim>> &places) {
      const auto time = find_jump(datum, places, scene.schedule);
      if (time && entries.insert(datum.name_of_entry()).second)
        found << (entries.size() > 1 ? ", '" : "'") << datum.name_of_entry()
              << "' at t = " << *time;
    };

    for (const auto &[id, condition] : scene.boundary)
      {
        std::vector<Point<dim>> places;
        for (const Expression<dim> *datum : condition.data())
          if (datum->may_jump())
            {
              if (places.empty())
                places = places_on_boundary(triangulation, id);
              inspect(*datum, places);
            }
      }
    for (unsigned int d = 0; d < dim; ++d)
      if (scene.body_force && (*scene.body_force)[d].may_jump())
        inspect((*scene.body_force)[d], places_in_body(triangulation));

    return entries.empty() ?
             "" :
             "Data jump in time (" + found.str() +
               "), but the theory asks for Lipschitz continuous ones, (2.10): "
               "equilibrium after a jump is exact, what creeps in its step is "
               "not, and error estimates may miss that; give it a short step of "
               "its own in 'Time/Phases', or make it a ramp.";
  }



  template std::optional<double>
  find_jump(const Expression<2> &,
            const std::vector<Point<2>> &,
            const TimeSchedule &);
  template std::optional<double>
  find_jump(const Expression<3> &,
            const std::vector<Point<3>> &,
            const TimeSchedule &);
  template std::string
  warning_of_jumps(const Scene<2> &, const Triangulation<2> &);
  template std::string
  warning_of_jumps(const Scene<3> &, const Triangulation<3> &);
} // namespace Viscoplastic
