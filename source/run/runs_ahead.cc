// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>
#include <viscoplastic_contact/parameters/phases.h>
#include <viscoplastic_contact/run/runs_ahead.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

#include <algorithm>
#include <memory>

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



    template <int dim>
    Expectation
    make_pilot_run(const Parameters &parameters)
    {
      Console     silence(MPI_COMM_WORLD, /* quiet = */ true);
      Expectation expectation;
      try
        {
          const Parameters         pilot({}, assignments(parameters));
          ViscoplasticContact<dim> problem(pilot, silence, {});
          expectation.size =
            problem.run_without_files().controlled_errors().size;
        }
      catch (const std::exception &exception)
        {
          expectation.failure = reason(exception);
        }
      return expectation;
    }
  } // namespace



  template <int dim>
  RunsAhead<dim>
  runs_ahead(const Parameters &parameters, Console &console)
  {
    return [&](parallel::distributed::Triangulation<dim> &triangulation) {
      const Expectation expectation = make_pilot_run<dim>(parameters);
      if (parameters.error_control.quantity.empty() ||
          parameters.refinement.strategy == RefinementStrategy::none)
        return expectation;
      std::ostream &out = console.stream();
      out << "First without files, to find a mesh for all times:" << std::endl;
      std::unique_ptr<ViscoplasticContact<dim>> run, before;
      do
        {
          before = std::move(run);
          if (before)
            out << "Again from the beginning:" << std::endl;
          run = std::make_unique<ViscoplasticContact<dim>>(
            parameters, console, [&](auto &first_mesh) {
              if (before)
                refine_like(before->mesh(), first_mesh);
              before.reset();
              return expectation;
            });
          run->run_without_files();
        }
      while (!run->is_finished());
      refine_like(run->mesh(), triangulation);
      out << "Again from the beginning, on the mesh that has been found:"
          << std::endl;
      return expectation;
    };
  }



  template RunsAhead<2>
  runs_ahead<2>(const Parameters &, Console &);
  template RunsAhead<3>
  runs_ahead<3>(const Parameters &, Console &);
} // namespace Viscoplastic
