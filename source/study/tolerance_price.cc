// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/conditional_ostream.h>

#include <viscoplastic_contact/study/pilot_runs.h>
#include <viscoplastic_contact/study/tolerance_price.h>

namespace Viscoplastic
{
  namespace
  {
    /// The smallest tolerance of a pilot over the one that is priced.
    constexpr double      pilot_factor = 1.4;
    constexpr std::size_t n_pilots     = 2;
    /// Coarser runs are too coarse to say how the finest go on.
    constexpr std::size_t n_fitted = 4;



    ToleranceModel
    fit(const StudyRuns   &runs,
        const PilotRuns   &pilots,
        const std::string &measure)
    {
      Records last = pilots.all();
      if (last.size() > n_fitted)
        last.erase(last.begin(), last.end() - n_fitted);
      return fit_tolerance_runs(runs, last, measure, nullptr);
    }
  } // namespace



  ToleranceQuote
  price_to_tolerance(StudyRuns &runs, const double eps, Console &console)
  {
    ConditionalOStream out(console.stream(),
                           Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) ==
                             0);
    const double       budget = runs.scene.study.budget;
    ToleranceQuote     quote;
    PilotRuns          pilots;
    RunKey             key = runs.scene_key();
    key.variant.strategy   = MeshStrategy::tolerance;
    runs.lock_directory();
    for (int level = runs.coarsest_tolerance_level();; ++level)
      {
        key.mesh_level = key.time_level = level;
        if (pilots.records.size() >= n_pilots)
          {
            quote.measure = best_measure(pilots.all(), nullptr, n_pilots);
            AssertThrow(!quote.measure.empty(), ExcMessage(no_error_to_go_by));
            const ToleranceModel model = fit(runs, pilots, quote.measure);
            const double         next  = runs.tolerance(key);
            if (next < pilot_factor * model.tolerance_for(eps) ||
                model.predict(next).seconds > 0.5 * budget)
              break;
          }
        if (!add_pilot_run(runs, key, console, pilots))
          {
            quote.interruption = pilots.interruption;
            AssertThrow(pilots.failure.empty(),
                        ExcMessage("The pilot runs for --price fail: " +
                                   pilots.failure));
            return quote;
          }
      }

    const ToleranceModel model = fit(runs, pilots, quote.measure);
    out << "Pilot runs to larger tolerances:\n"
        << in_words(pilots.records, quote.measure) << "Prices by the "
        << measure_in_words(quote.measure) << ", from pilots of "
        << seconds_in_words(pilots.seconds()) << ":\n";
    for (const double error : {2. * eps, eps, 0.5 * eps})
      out << "  " << in_words(model, price_of(model, error, budget), budget)
          << '\n';
    out << exponents_in_words(model) << std::endl;
    quote.price = price_of(model, eps, budget);
    AssertThrow(quote.price.is_in_budget,
                ExcMessage(in_words(model, quote.price, budget) +
                           " Raise 'Study/Budget' or take a larger error."));
    return quote;
  }
} // namespace Viscoplastic
