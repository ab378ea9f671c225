// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/run/passes.h>

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int most_steps = 8;



    /// Return the assignments of a pilot run, which override values of the
    /// scene; @p refinements are added to those of the scene's mesh.
    std::vector<std::string>
    assignments(const Parameters &parameters, const unsigned int refinements)
    {
      std::vector<std::string> result;
      for (const auto &[entry, value] : parameters.values())
        result.push_back(entry + "=" + value);
      std::string phases;
      for (const auto &phase : TimeSchedule(parameters.time.phases).phases)
        phases += (phases.empty() ? "" : ", ") + number(phase.end, 17) + ": " +
                  std::to_string(std::min(phase.n_steps, most_steps));
      for (const std::string &assignment :
           {std::string("Error control/Tolerance=0"),
            std::string("Exact solution/Reference directory="),
            std::string("Mesh refinement/Strategy=none"),
            "Geometry/Global refinements=" +
              std::to_string(parameters.geometry.global_refinements +
                             refinements),
            "Time/Phases=" + phases,
            "Time/Scheme=" + name_of(parameters.time.scheme),
            "Time/Stiffness policy=" +
              name_of(StiffnessPolicy::backward_euler)})
        result.push_back(assignment);
      return result;
    }



    /// Whether the quantity may differ much on finer meshes, as the force of
    /// contact that closes only there.
    template <int dim>
    bool
    is_too_coarse(const RunSummary<dim> &run)
    {
      constexpr double       much_of_something = 0.5, much_of_nothing = 0.1;
      constexpr unsigned int most_cells = 20000; // of the next one
      return !run.quantity.empty() && run.errors &&
             run.errors->relative() > (run.quantity_errors.size > 0. ?
                                         much_of_something :
                                         much_of_nothing) &&
             (run.n_cells << dim) <= most_cells;
    }



    /// Estimate the size of a scene's solution by a run without files on its
    /// first mesh, with at most 8 steps per phase: see
    /// ViscoplasticContact::PilotRun.
    template <int dim>
    std::string
    pilot_run(const Parameters                          &parameters,
              ErrorBudget                               &budget,
              StepControl                               &control,
              parallel::distributed::Triangulation<dim> &triangulation)
    {
      Console      silence(MPI_COMM_WORLD, /* quiet = */ true);
      double       size        = 0.;
      unsigned int refinements = 0;
      std::string  quantity, failure;
      try
        {
          const unsigned int most =
            parameters.refinement.strategy != RefinementStrategy::none ?
              5 - dim :
              0;
          for (unsigned int n = 0; n <= most; ++n)
            {
              const Parameters         pilot({}, assignments(parameters, n));
              ViscoplasticContact<dim> problem(pilot, silence, nullptr);
              const RunSummary<dim>    summary = problem.run_without_files();
              if (size == 0.)
                refinements = n;
              size     = summary.controlled_errors().size;
              quantity = summary.quantity;
              control.expect_dual_norms(summary.dual_times, summary.dual_norms);
              if (!is_too_coarse(summary))
                break;
            }
        }
      catch (const std::exception &exception)
        {
          // If a finer mesh fails, the result of the coarser one is used.
          failure = reason(exception);
        }
      budget.expect_size(size);
      if (size == 0.)
        return failure.empty() ?
                 "" :
                 "Note: the run on the first mesh that tells how large the "
                 "solution becomes has failed, so that errors will be relative "
                 "to what it has been so far: " +
                   failure;
      triangulation.refine_global(refinements);
      return refinements == 0 ?
               "" :
               "Note: '" + PlaceNames(parameters).quantity(quantity) +
                 "' is zero on the scene's first mesh, which errs much; this "
                 "run begins with 'Geometry/Global refinements' = " +
                 std::to_string(parameters.geometry.global_refinements +
                                refinements) +
                 '.';
    }
  } // namespace



  template <int dim>
  std::string
  run_in_passes(const Parameters          &parameters,
                Console                   &console,
                const CommandLine::Restart restart)
  {
    auto        pass = std::make_unique<ViscoplasticContact<dim>>(parameters,
                                                           console,
                                                           pilot_run<dim>);
    std::string interruption = pass->run(restart);
    while (pass->needs_another_pass())
      {
        console.stream() << "Again from the beginning, on the mesh that has "
                            "been found:"
                         << std::endl;
        auto next = std::make_unique<ViscoplasticContact<dim>>(parameters,
                                                               console,
                                                               nullptr);
        next->follow(*pass);
        pass         = std::move(next); // which unlocks the directories
        interruption = pass->run(CommandLine::Restart::no);
      }
    return interruption;
  }



  VISCOPLASTIC_INSTANTIATE(run_in_passes);
} // namespace Viscoplastic
