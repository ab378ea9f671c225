// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/run/two_level.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  std::vector<std::string>
  coarser_scene(const Parameters &parameters)
  {
    const unsigned int refinements = parameters.geometry.global_refinements;
    AssertThrow(refinements > 0,
                ExcMessage("'Error control/Two-level comparison' needs a mesh "
                           "of twice the width, but 'Geometry/Global "
                           "refinements' is 0; take one refinement more and "
                           "half the subdivisions."));
    std::string phases;
    for (const std::string &phase :
         Utilities::split_string_list(parameters.time.phases, ','))
      {
        const auto parts = Utilities::split_string_list(phase, ':');
        AssertDimension(parts.size(), 2); // the schedule has been read
        const int n_steps = Utilities::string_to_int(parts[1]);
        phases += (phases.empty() ? "" : ", ") + parts[0] + ": " +
                  std::to_string(std::max(1, n_steps / 2));
      }
    const auto assign = [](const std::string &entry, const unsigned int value) {
      return entry + "=" + std::to_string(value);
    };
    const auto less = [](const unsigned int level) {
      return level > 0 ? level - 1 : 0;
    };
    const RefinementParameters &refinement = parameters.refinement;
    // Steps by their error: twice as long with twice the error per time, or
    // four times in the second order.
    const double factor = parameters.time.scheme == TimeScheme::heun ? 4. : 2.;
    std::ostringstream tolerance;
    tolerance << std::setprecision(17)
              << factor * parameters.step_control.tolerance;
    return {
      "Error control/Two-level comparison=false",
      "Step control/Tolerance=" + tolerance.str(),
      // Nobody reads it unless it chooses the steps, and without it the
      // iterations go on to a fixed tolerance.
      parameters.step_control.is_on() ? "Error control/Error bar=true" :
                                        "Error control/Error bar=false",
      assign("Geometry/Global refinements", refinements - 1),
      "Time/Phases=" + phases,
      assign("Mesh refinement/Minimal level", less(refinement.minimal_level)),
      assign("Mesh refinement/Maximal level", less(refinement.maximal_level)),
      assign("Mesh refinement/Cell budget",
             std::max(1u, refinement.cell_budget >> parameters.dimension))};
  }



  template <int dim>
  RunSummary<dim>
  run_coarser_scene(const Parameters  &parameters,
                    const CommandLine &command_line)
  {
    std::vector<std::string> overrides = command_line.overrides;
    for (const std::string &assignment : coarser_scene(parameters))
      overrides.push_back(assignment);
    Console silence(MPI_COMM_WORLD, /* quiet = */ true);
    try
      {
        const Parameters         coarser(command_line.files, overrides);
        ViscoplasticContact<dim> problem(coarser, silence);
        return problem.run_without_files();
      }
    catch (const std::exception &exception)
      {
        AssertThrow(false,
                    ExcMessage("The run with twice the mesh width and twice "
                               "the time steps that 'Error control/Two-level "
                               "comparison' needs has failed: " +
                               reason(exception)));
        throw;
      }
  }



  template RunSummary<2>
  run_coarser_scene<2>(const Parameters &, const CommandLine &);
  template RunSummary<3>
  run_coarser_scene<3>(const Parameters &, const CommandLine &);
} // namespace Viscoplastic
