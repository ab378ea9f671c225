// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/scene/data_in_time.h>

namespace Viscoplastic
{
  namespace
  {
    /// Changes of less than this part of the largest values are negligible.
    constexpr double smallest_share = 0.05;
    /// A change is unseen if values leave the range between both ends of a step
    /// by more than this part of their range in the run. A sine does so with
    /// about two steps per period, but not with three.
    constexpr double unseen_share = 0.4;
    /// The number of sampled steps, and the sample times in shares of a step:
    /// not equidistant, since changes that steps miss may repeat with them.
    constexpr unsigned int          n_steps_sampled = 200;
    constexpr std::array<double, 6> inside{
      {0.081, 0.233, 0.397, 0.514, 0.709, 0.887}};

    /// Return some steps of each phase, its last one included.
    std::vector<TimeStep>
    sample_steps(const TimeSchedule &schedule)
    {
      const unsigned int most =
        std::max(1u, n_steps_sampled / schedule.n_phases());
      std::vector<TimeStep> steps;
      unsigned int          last = 0; // step of the phases so far
      for (const TimeSchedule::Phase &phase : schedule.phases)
        {
          const unsigned int stride = (phase.n_steps + most - 1) / most,
                             first  = last + 1;
          last += phase.n_steps;
          for (unsigned int n = first; n <= last; n += stride)
            steps.push_back(schedule.step(n));
          if (steps.back().n < last)
            steps.push_back(schedule.step(last));
        }
      return steps;
    }
  } // namespace



  template <int dim>
  std::optional<double>
  find_unseen_change(const Expression<dim>         &datum,
                     const std::vector<Point<dim>> &places,
                     const TimeSchedule            &schedule)
  {
    if (!datum.depends_on_time() || places.empty())
      return {};
    std::vector<double> least, most; // in the run, by place
    double              size           = 0.;
    const auto          values_for_run = [&](const double t) {
      std::vector<double> values = values_at(datum, places, t);
      if (least.empty())
        least = most = values;
      double sum = 0.;
      for (std::size_t i = 0; i < values.size(); ++i)
        {
          least[i] = std::min(least[i], values[i]);
          most[i]  = std::max(most[i], values[i]);
          sum += std::fabs(values[i]);
        }
      size = std::max(size, sum);
      return values;
    };
    double largest = 0., time = 0.;
    try
      {
        for (const TimeStep &step : sample_steps(schedule))
          {
            const auto at_start = values_for_run(step.t_old),
                       at_end   = values_for_run(step.t);
            for (const double share : inside)
              {
                const double t      = step.t_old + share * step.k;
                const auto   values = values_for_run(t);
                double       beyond = 0.;
                for (std::size_t i = 0; i < values.size(); ++i)
                  {
                    const auto [low, high] =
                      std::minmax(at_start[i], at_end[i]);
                    beyond += std::max({0., values[i] - high, low - values[i]});
                  }
                if (beyond > (1. + 1e-6) * largest) // keep the first of equals
                  {
                    largest = beyond;
                    time    = t;
                  }
              }
          }
      }
    catch (const ExceptionBase &)
      {
        return {}; // undefined at a time where perhaps no step ends
      }
    double range = 0.;
    for (std::size_t i = 0; i < least.size(); ++i)
      range += most[i] - least[i];
    if (largest > unseen_share * range && largest > smallest_share * size)
      return time;
    return {};
  }



  namespace
  {
    /// Whether a foundation slides at the end of a sampled step.
    template <int dim>
    bool
    slides(const BoundaryCondition<dim>  &condition,
           const std::vector<Point<dim>> &places,
           const TimeSchedule            &schedule)
    {
      if (!condition.foundation_motion)
        return false;
      try
        {
          for (const TimeStep &step : sample_steps(schedule))
            for (const Point<dim> &x : places)
              {
                const auto  &w = *condition.foundation_motion;
                const double size =
                  (w.vector(x, step.t) - w.vector(x, 0.)).norm();
                // The tolerance allows for rounding of the normal.
                if (condition.sliding(x, step.t).norm() > 1e-10 * size)
                  return true;
              }
        }
      catch (const ExceptionBase &)
        {
          return true; // undefined at a place where perhaps no node is
        }
      return false;
    }



    /// Whether steps are chosen by their error.
    bool
    chooses_steps(const Parameters &parameters)
    {
      return parameters.step_control.is_on() ||
             parameters.error_control.has_tolerance();
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  warnings_of_data_in_time(const Scene<dim>         &scene,
                           const Triangulation<dim> &triangulation)
  {
    // Components of a vector share an entry, which is listed once.
    struct Finding
    {
      std::set<std::string> entries;
      std::string           list;

      void
      add(const std::string &entry, const std::optional<double> &t)
      {
        if (!t || !entries.insert(entry).second)
          return;
        list +=
          (list.empty() ? "'" : ", '") + entry + "' at t = " + as_text(*t);
      }
    };
    Finding jumps, unseen;
    // Steps are not checked where error control chooses them, nor where data
    // follow from a manufactured solution, whose test chooses them.
    const bool looks_into_steps =
      !chooses_steps(scene.parameters) &&
      !(scene.exact_solution && scene.exact_solution->makes_data);
    for (const auto &[datum, places] : data_in_time(scene, triangulation))
      {
        jumps.add(datum.name_of_entry(),
                  find_jump(datum, places, scene.schedule));
        if (looks_into_steps)
          unseen.add(datum.name_of_entry(),
                     find_unseen_change(datum, places, scene.schedule));
      }

    std::vector<std::string> warnings;
    for (const auto &[id, condition] : scene.boundary)
      {
        const std::string entry =
          "Boundary " + std::to_string(id) + "/Foundation motion";
        if ((condition.has_friction() || condition.is_glued()) &&
            optional_vector<dim>(scene.parameters.boundaries.at(id).entries.at(
                                   "Foundation motion"),
                                 dim,
                                 entry) &&
            !slides(condition,
                    places_on_boundary(triangulation, id),
                    scene.schedule))
          warnings.push_back(
            "'" + entry +
            "' moves nothing: what counts is how its tangential part changes "
            "in time, which it does not; 'Foundation displacement' moves the "
            "foundation in normal direction.");
      }

    // The assumption (2.10) excludes jumps in time.
    if (!jumps.list.empty())
      warnings.push_back(
        "Data jump in time (" + jumps.list +
        "), but the theory asks for Lipschitz continuous ones, (2.10): "
        "equilibrium after a jump is exact, what creeps in its step is "
        "not, and error estimates may miss that; " +
        std::string(chooses_steps(scene.parameters) &&
                        scene.parameters.step_control.land_on_kinks ?
                      "it gets a short step of its own." :
                      "give it a short step of its own in 'Time/Phases', or "
                      "make it a ramp."));
    if (!unseen.list.empty())
      warnings.push_back(
        "Data come and go unseen within time steps (" + unseen.list +
        "): a run takes data at the ends of steps. Take more steps in "
        "'Time/Phases', not in time with the data, or set 'Step "
        "control/Tolerance'.");
    return warnings;
  }



  VISCOPLASTIC_INSTANTIATE(find_unseen_change);
  VISCOPLASTIC_INSTANTIATE(warnings_of_data_in_time);
} // namespace Viscoplastic
