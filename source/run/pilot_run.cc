// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/parameters/phases.h>
#include <viscoplastic_contact/run/pilot_run.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

#include <algorithm>

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
  double
  size_in_pilot_run(const Parameters &parameters, std::string &failure)
  {
    Console silence(MPI_COMM_WORLD, /* quiet = */ true);
    try
      {
        const Parameters         pilot({}, assignments(parameters));
        ViscoplasticContact<dim> problem(pilot, silence);
        return problem.run_without_files().controlled_errors().size;
      }
    catch (const std::exception &exception)
      {
        failure = reason(exception);
        return 0.;
      }
  }



  template double
  size_in_pilot_run<2>(const Parameters &, std::string &);
  template double
  size_in_pilot_run<3>(const Parameters &, std::string &);
} // namespace Viscoplastic
