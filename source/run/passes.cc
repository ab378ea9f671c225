// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/run/passes.h>

#include <iomanip>

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int most_steps = 8;



    /// What a pilot run has in the place of the scene's values.
    std::vector<std::string>
    assignments(const Parameters &parameters)
    {
      std::vector<std::string> result;
      for (const auto &[entry, value] : parameters.values())
        result.push_back(entry + "=" + value);
      std::vector<StepsUntil> phases = read_phases(parameters.time.phases);
      for (StepsUntil &phase : phases)
        phase.n_steps = std::min(phase.n_steps, most_steps);
      for (const std::string &assignment :
           {std::string("Error control/Tolerance=0"),
            std::string("Error control/Two-level comparison=false"),
            std::string("Exact solution/Reference directory="),
            std::string("Mesh refinement/Strategy=none"),
            "Time/Phases=" + write_phases(phases),
            "Time/Scheme=" + name_of(parameters.time.scheme),
            "Time/Stiffness policy=" +
              name_of(StiffnessPolicy::backward_euler)})
        result.push_back(assignment);
      return result;
    }
  } // namespace



  template <int dim>
  PilotRun
  pilot_run(const Parameters &parameters)
  {
    return [&parameters] {
      Console     silence(MPI_COMM_WORLD, /* quiet = */ true);
      Expectation expectation;
      try
        {
          const Parameters         pilot({}, assignments(parameters));
          ViscoplasticContact<dim> problem(pilot, silence, {});
          RunSummary<dim>          summary = problem.run_without_files();
          expectation.size                 = summary.controlled_errors().size;
          expectation.dual_times           = std::move(summary.dual_times);
          expectation.dual_norms           = std::move(summary.dual_norms);
        }
      catch (const std::exception &exception)
        {
          expectation.failure = reason(exception);
        }
      return expectation;
    };
  }



  template <int dim>
  std::string
  run_in_passes(const Parameters          &parameters,
                Console                   &console,
                const CommandLine::Restart restart,
                const RunSummary<dim>     *coarser)
  {
    auto pass =
      std::make_unique<ViscoplasticContact<dim>>(parameters,
                                                 console,
                                                 pilot_run<dim>(parameters));
    std::string interruption = pass->run(restart, coarser);
    while (pass->needs_another_pass())
      {
        console.stream() << "Again from the beginning, on the mesh that has "
                            "been found:"
                         << std::endl;
        auto next = std::make_unique<ViscoplasticContact<dim>>(parameters,
                                                               console,
                                                               PilotRun());
        next->follow(*pass);
        pass         = std::move(next); // which has let go of the directories
        interruption = pass->run(CommandLine::Restart::no, coarser);
      }
    return interruption;
  }



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



  VISCOPLASTIC_INSTANTIATE(pilot_run);
  VISCOPLASTIC_INSTANTIATE(run_in_passes);
  VISCOPLASTIC_INSTANTIATE(run_coarser_scene);
} // namespace Viscoplastic
