// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/parameters/phases.h>
#include <viscoplastic_contact/run/passes.h>
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
    const std::string only_one = "Error control/Two-level comparison=false";
    const double      tolerance_of_run = parameters.error_control.tolerance;
    const auto        assign_tolerance = [](const std::string &section,
                                     const double       tolerance) {
      std::ostringstream assignment;
      assignment << section << "/Tolerance=" << std::setprecision(17)
                 << tolerance;
      return assignment.str();
    };
    if (tolerance_of_run > 0.)
      return {only_one,
              assign_tolerance("Error control",
                               std::min(1., 2. * tolerance_of_run))};

    const unsigned int refinements = parameters.geometry.global_refinements;
    AssertThrow(refinements > 0,
                ExcMessage("'Error control/Two-level comparison' needs a mesh "
                           "of twice the width, but 'Geometry/Global "
                           "refinements' is 0; take one refinement more and "
                           "half the subdivisions."));
    std::vector<StepsUntil> phases = read_phases(parameters.time.phases);
    for (StepsUntil &phase : phases)
      phase.n_steps = std::max(1u, phase.n_steps / 2);
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
    return {
      only_one,
      assign_tolerance("Step control",
                       factor * parameters.step_control.tolerance),
      // Nobody reads it unless it chooses the steps, and without it the
      // iterations go on to a fixed tolerance.
      parameters.step_control.is_on() ? "Error control/Error bar=true" :
                                        "Error control/Error bar=false",
      "Error control/Quantity=",
      assign("Geometry/Global refinements", refinements - 1),
      "Time/Phases=" + write_phases(phases),
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
        ViscoplasticContact<dim> problem(coarser,
                                         silence,
                                         pilot_run<dim>(coarser));
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
