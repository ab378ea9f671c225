// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/known_solution.h>
#include <viscoplastic_contact/error/reference_fields.h>
#include <viscoplastic_contact/error/space_estimator.h>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// The density of friction multipliers; empty without contact points.
    template <int dim>
    std::optional<DistributedVector>
    multiplier_density(const Discretization<dim> &discretization,
                       const State<dim>          &state)
    {
      if (!discretization.face)
        return {};
      return discretization.face->density(state.contact,
                                          /* of_friction_alone = */ true);
    }
  } // namespace



  template <int dim>
  KnownSolution<dim>::KnownSolution(const Scene<dim> &scene, TimerOutput &timer)
    : scene(scene)
    , timer(timer)
    , reference_directory(scene.parameters.exact_solution.reference_directory)
  {}



  template <int dim>
  void
  KnownSolution<dim>::check() const
  {
    if (reference_directory.empty())
      return;
    TimerOutput::Scope scope(timer, "errors");
    if (scene.exact_solution)
      refuse("'Exact solution/Reference directory' and 'Exact "
             "solution/Displacement' are both given; errors can be measured "
             "against one of them.");
    for (unsigned int i = 1; i <= scene.schedule.n_phases(); ++i)
      read_samples<dim>(samples_file(reference_directory, i), MPI_COMM_WORLD);
  }



  template <int dim>
  SolutionErrors
  KnownSolution<dim>::errors(const Discretization<dim> &discretization,
                             const State<dim>          &state) const
  {
    const unsigned int phase     = scene.schedule.phase_ending_at(state.t);
    const bool     has_reference = !reference_directory.empty() && phase > 0;
    SolutionErrors result;
    result.error.fill(std::numeric_limits<double>::quiet_NaN());
    result.exact  = result.error;
    result.memory = result.recovery = result.error.energy;
    if (!scene.exact_solution && !has_reference)
      return result;

    TimerOutput::Scope scope(timer, "errors");
    const auto         multipliers = multiplier_density(discretization, state);
    const DistributedVector *density = multipliers ? &*multipliers : nullptr;
    const double             recovery =
      total_estimate(squared_recovery_estimate(discretization.stress_space,
                                               state),
                     discretization.space.dof_handler.get_triangulation());
    if (scene.exact_solution)
      {
        result = solution_errors(discretization.stress_space, state, density);
        result.recovery = recovery;
        return result;
      }
    const FieldSamples<dim> reference =
      read_samples<dim>(samples_file(reference_directory, phase),
                        discretization.space.communicator);
    if (!(std::abs(reference.t - state.t) <= 1e-10 * std::abs(state.t)))
      refuse("'Exact solution/Reference directory': phase " + as_text(phase) +
             " of the reference ends at t = " + as_text(reference.t) +
             ", that of this run at t = " + as_text(state.t) +
             "; 'Time/Phases' must have the same end times.");
    const double unknown = result.memory;
    result =
      differences(reference, discretization.stress_space, state, density);
    result.memory   = unknown;
    result.recovery = recovery;
    return result;
  }



  template <int dim>
  void
  KnownSolution<dim>::write_reference(const Discretization<dim> &discretization,
                                      const State<dim>          &state,
                                      const std::string &directory) const
  {
    const unsigned int phase = scene.schedule.phase_ending_at(state.t);
    if (!scene.parameters.output.reference_fields || phase == 0)
      return;
    TimerOutput::Scope scope(timer, "errors");
    const auto         multipliers = multiplier_density(discretization, state);
    write_samples(sample_fields(discretization.stress_space,
                                state,
                                multipliers ? &*multipliers : nullptr),
                  samples_file(directory, phase),
                  discretization.space.communicator);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(KnownSolution);
} // namespace Viscoplastic
