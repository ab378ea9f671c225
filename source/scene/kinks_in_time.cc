// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/scene/data_in_time.h>

#include <array>
#include <numeric>

namespace Viscoplastic
{
  namespace
  {
    /// The number of search windows per run, and the least number per phase.
    constexpr unsigned int n_windows = 400, least_windows = 40;
    /// Kinks and jumps are located up to this part of the end time.
    constexpr double accuracy = 1e-10;
    /// The least change of slope at a kink, relative to the mean size of the
    /// slope, and the least jump, relative to the sum of all changes.
    constexpr double least_share = 0.05;
    /// After three halvings of a window, second differences are at least 3/32
    /// times as large at a kink (there are windows with it well inside, as they
    /// begin at eighths), but 1/64 times where the datum is smooth.
    constexpr double       least_fall       = 0.04;
    constexpr unsigned int n_levels_to_tell = 3;
    /// After one halving the ratios are 3/8 and 1/4: most windows end there.
    constexpr double least_first_fall = 0.28;
    /// Candidates begin up to an eighth before the window and end up to an
    /// eighth after it, since rounding may put a jump at its end outside. Their
    /// ends and middles are at eighths.
    constexpr int n_eighths = 11, first_eighth = -1;
    /// A larger number of kinks is taken for noise.
    constexpr std::size_t most_kinks = 1000;
    /// The least share of the places at which a datum changes that have a kink.
    constexpr double least_places = 0.1;



    template <int dim>
    class Search
    {
    public:
      Search(const Expression<dim>         &datum,
             const std::vector<Point<dim>> &places,
             const TimeSchedule            &schedule)
        : datum(datum)
        , places(places)
        , schedule(schedule)
        , end_time(schedule.end_time())
      {
        std::vector<double> times{0.};
        const unsigned int  n =
          std::max(least_windows, n_windows / schedule.n_phases());
        for (const TimeSchedule::Phase &phase : schedule.phases)
          {
            for (unsigned int i = 1; i < n; ++i)
              times.push_back(phase.start + i * (phase.end - phase.start) / n);
            times.push_back(phase.end);
          }
        add_rows_of_tables(times);
        std::vector<double> before = values(0.);
        paths.resize(before.size());
        for (std::size_t i = 1; i < times.size(); ++i)
          {
            const std::vector<double> now = values(times[i]);
            for (std::size_t p = 0; p < paths.size(); ++p)
              paths[p] += std::fabs(now[p] - before[p]);
            before = now;
          }
        for (const double path : paths)
          n_moving += path > 0.;
        // Windows overlap by half: each kink is well inside of one.
        for (std::size_t i = 0; n_moving > 0 && i + 2 < times.size(); ++i)
          look_into(times[i], times[i + 2]);
      }

      std::vector<Kink> kinks;

    private:
      /// Add rows of the datum's tables as ends of windows, unless they are
      /// next to one of @p times and thereby well inside of a window.
      void
      add_rows_of_tables(std::vector<double> &times) const
      {
        std::set<double> all(times.begin(), times.end());
        for (const double t : datum.rows_of_tables())
          if (t > 0. && t < end_time)
            {
              const auto   next  = all.upper_bound(t);
              const double after = *next, before = *std::prev(next);
              if (std::min(t - before, after - t) > 0.01 * (after - before))
                all.insert(t);
            }
        times.assign(all.begin(), all.end());
      }

      std::vector<double>
      values(const double t) const
      {
        return values_at(datum, places, t);
      }

      /// Whether a predicate holds at enough of the places.
      template <typename Predicate>
      bool
      is_common(const Predicate &holds_at) const
      {
        unsigned int n = 0;
        for (std::size_t p = 0; p < paths.size(); ++p)
          n += holds_at(p);
        return n > 0 && n >= least_places * n_moving;
      }

      /// Return the absolute second differences at three times, by place.
      static std::vector<double>
      second_differences(std::vector<double>        left,
                         const std::vector<double> &middle,
                         const std::vector<double> &right)
      {
        for (std::size_t p = 0; p < left.size(); ++p)
          left[p] = std::fabs(left[p] - 2. * middle[p] + right[p]);
        return left;
      }

      static double
      sum(const std::vector<double> &differences)
      {
        return std::accumulate(differences.begin(), differences.end(), 0.);
      }

      /// Halve a window towards its largest second differences to find a kink.
      void
      look_into(double start, const double end)
      {
        double              width = end - start;
        std::vector<double> differences =
          second_differences(values(start),
                             values(start + 0.5 * width),
                             values(end));
        double       earlier = sum(differences);
        const double path    = sum(paths);
        for (unsigned int level = 1; width > accuracy * end_time; ++level)
          {
            // Stop where second differences are negligible against any kink.
            if (!(sum(differences) >
                  1e-6 * least_share * path * width / end_time))
              return;
            std::array<double, n_eighths>              t;
            std::array<std::vector<double>, n_eighths> at; // empty outside run
            for (int i = 0; i < n_eighths; ++i)
              {
                t[i] = start + (i + first_eighth) * width / 8.;
                if (t[i] >= 0. && t[i] <= end_time)
                  at[i] = values(t[i]);
              }
            differences.clear();
            for (int i = 0; i + 4 < n_eighths; ++i)
              if (!at[i].empty() && !at[i + 4].empty())
                {
                  auto there = second_differences(at[i], at[i + 2], at[i + 4]);
                  if (differences.empty() || sum(there) > sum(differences))
                    {
                      differences = std::move(there);
                      start       = t[i];
                    }
                }
            width *= 0.5;
            const double now = sum(differences);
            if (level == 1 && !(now > least_first_fall * earlier))
              return;
            if (level % n_levels_to_tell != 0)
              continue;
            const double largest =
              *std::max_element(differences.begin(), differences.end());
            if (!(now > least_fall * earlier) ||
                !is_common([&](const std::size_t p) {
                  return differences[p] > least_share * largest;
                }))
              return;
            earlier = now;
          }
        judge(start + 0.5 * width);
      }

      /// Add a kink or jump at @p t if values at some distance differ enough.
      void
      judge(const double t)
      {
        const double near = 10. * accuracy * end_time, far = 1e-5 * end_time;
        if (t - 2. * far < 0. || t + 2. * far > end_time ||
            (!kinks.empty() && std::fabs(t - kinks.back().t) < far))
          return;
        const auto before = values(t - near), after = values(t + near),
                   left = values(t - far), right = values(t + far),
                   farther_left  = values(t - 2. * far),
                   farther_right = values(t + 2. * far);
        const bool is_jump       = is_common([&](const std::size_t p) {
          return std::fabs(after[p] - before[p]) > least_share * paths[p];
        });
        const bool is_kink       = is_common([&](const std::size_t p) {
          return std::fabs((farther_right[p] - right[p]) -
                           (left[p] - farther_left[p])) >
                 least_share * paths[p] * far / end_time;
        });
        if (is_jump || is_kink)
          kinks.push_back({without_rounding(t), is_jump});
      }

      /// Return the end of a phase or the short decimal number at @p t, if any.
      double
      without_rounding(const double t) const
      {
        const TimeSchedule::Phase &phase = schedule.phase_at(t);
        for (const double end : {phase.start, phase.end})
          if (std::fabs(end - t) < 2. * accuracy * end_time)
            return end;
        for (double scale = 1.; scale * accuracy * end_time < 0.01;
             scale *= 10.)
          {
            const double rounded = std::round(t * scale) / scale;
            if (std::fabs(rounded - t) < 2. * accuracy * end_time)
              return rounded;
          }
        return t;
      }

      const Expression<dim>         &datum;
      const std::vector<Point<dim>> &places;
      const TimeSchedule            &schedule;
      const double                   end_time;
      /// The total variation by place; the number of places where it is not 0.
      std::vector<double> paths;
      unsigned int        n_moving = 0;
    };
  } // namespace



  template <int dim>
  std::vector<Kink>
  find_kinks(const Expression<dim>         &datum,
             const std::vector<Point<dim>> &places,
             const TimeSchedule            &schedule)
  {
    if (!datum.may_have_kinks() || places.empty())
      return {};
    try
      {
        std::vector<Kink> kinks = Search<dim>(datum, places, schedule).kinks;
        if (kinks.size() > most_kinks)
          kinks.clear();
        return kinks;
      }
    catch (const ExceptionBase &)
      {
        return {}; // undefined at a time where perhaps no step ends
      }
  }



  template <int dim>
  std::optional<double>
  find_jump(const Expression<dim>         &datum,
            const std::vector<Point<dim>> &places,
            const TimeSchedule            &schedule)
  {
    if (!datum.may_jump() || places.empty())
      return {};
    for (const Kink &kink : find_kinks(datum, places, schedule))
      if (kink.is_jump)
        return kink.t;
    // Jumps at the ends of the run are not among the kinks.
    const double end = schedule.end_time(), near = 10. * accuracy * end;
    try
      {
        double size = 0.;
        for (const double share : {0., 0.1, 0.3, 0.5, 0.7, 0.9, 1.})
          for (const double value : values_at(datum, places, share * end))
            size = std::max(size, std::fabs(value));
        for (const auto &[left, right] :
             {std::make_pair(0., near), std::make_pair(end - near, end)})
          {
            const auto before = values_at(datum, places, left),
                       after  = values_at(datum, places, right);
            double change     = 0.;
            for (std::size_t p = 0; p < before.size(); ++p)
              change += std::fabs(after[p] - before[p]);
            if (change > least_share * size * before.size())
              return left > 0. ? end : 0.;
          }
      }
    catch (const ExceptionBase &)
      {} // undefined at a time where perhaps no step ends
    return {};
  }



  template <int dim>
  KinksOfScene
  kinks_of_scene(const Scene<dim>         &scene,
                 const Triangulation<dim> &triangulation)
  {
    KinksOfScene result;
    for (const auto &[datum, places] : data_in_time(scene, triangulation))
      {
        const auto found = find_kinks(datum, places, scene.schedule);
        result.kinks.insert(result.kinks.end(), found.begin(), found.end());
        auto &entries = result.entries;
        if (!found.empty() &&
            std::find(entries.begin(), entries.end(), datum.name_of_entry()) ==
              entries.end())
          entries.push_back(datum.name_of_entry());
      }

    // Merge kinks of several data at the same time.
    std::vector<Kink> &kinks = result.kinks;
    std::sort(kinks.begin(), kinks.end(), [](const Kink &a, const Kink &b) {
      return a.t < b.t;
    });
    const double      near = 100. * accuracy * scene.schedule.end_time();
    std::vector<Kink> merged;
    for (const Kink &kink : kinks)
      if (merged.empty() || kink.t - merged.back().t > near)
        merged.push_back(kink);
      else
        merged.back().is_jump |= kink.is_jump;
    kinks = merged;
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(find_kinks);
  VISCOPLASTIC_INSTANTIATE(find_jump);
  VISCOPLASTIC_INSTANTIATE(kinks_of_scene);
} // namespace Viscoplastic
