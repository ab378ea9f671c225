// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/study/study_report.h>

#include <ctime>
#include <fstream>
#include <sstream>

namespace Viscoplastic
{
  std::vector<WayResult>
  analyse(const Study &study)
  {
    std::vector<WayResult> result;
    for (const RunKey &way : study.ways())
      {
        WayResult of;
        of.way     = way;
        of.records = of_way(study.records(), way);
        of.measure = best_measure(of.records, study.reference());
        if (!of.measure.empty())
          {
            of.market = make_market(study.runs,
                                    of.records,
                                    of.measure,
                                    study.reference());
            of.prices = list_prices(*of.market,
                                    Utilities::string_to_double(
                                      Utilities::split_string_list(
                                        study.parameters.target_errors, ',')),
                                    study.parameters.budget);
          }
        result.push_back(of);
      }
    return result;
  }



  std::string
  prices_in_words(const Study &study)
  {
    std::ostringstream text;
    for (const WayResult &way : analyse(study))
      {
        if (!way.market)
          continue;
        text << "Prices (" << way.way.way() << "), by the "
             << measure_in_words(way.measure) << ":\n";
        for (const Price &price : way.prices)
          text << "  " << in_words(*way.market, price, study.parameters.budget)
               << '\n';
      }
    return text.str();
  }



  Origin
  origin()
  {
    Origin result;
    result.program =
      VISCOPLASTIC_CONTACT_VERSION " (" VISCOPLASTIC_CONTACT_GIT_REVISION ")";
    result.n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);

    result.machine = "unknown machine";
    std::ifstream file("/proc/cpuinfo");
    std::string   line;
    while (std::getline(file, line))
      if (line.compare(0, 10, "model name") == 0)
        result.machine = Utilities::trim(line.substr(line.find(':') + 1));

    const std::time_t now = std::time(nullptr);
    char              text[32];
    std::strftime(text, sizeof(text), "%FT%TZ", std::gmtime(&now));
    result.date = text;
    return result;
  }
} // namespace Viscoplastic
