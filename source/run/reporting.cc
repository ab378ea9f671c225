// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/blas_kernel.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/error/reference_fields.h>
#include <viscoplastic_contact/error/solution_errors.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  template <int dim>
  void
  ViscoplasticContact<dim>::announce() const
  {
    out << "viscoplastic_contact " << VISCOPLASTIC_CONTACT_VERSION << " ("
        << VISCOPLASTIC_CONTACT_GIT_REVISION << "), " << parameters.file
        << " on " << Utilities::MPI::n_mpi_processes(communicator)
        << " MPI rank(s)\nEffects:\n";
    for (const std::string &effect : scene.effects())
      out << "  " << effect << '\n';
    for (const std::string &warning : scene.warnings)
      console.remark("Warning: " + warning);
    const std::string advice = advice_on_blas_kernel();
    if (!advice.empty())
      out << "Note: " << advice << '\n';
    out << std::flush;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::announce_mesh() const
  {
    out << "Mesh: " << triangulation.n_global_active_cells() << " cells, "
        << dof_handler.n_dofs() << " degrees of freedom";
    if (discretization->face)
      out << ", " << discretization->face->layout().points.size()
          << " friction points";
    out << (discretization->mean_dilatation ? ", mean dilatation\n" : "\n");
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::announce_held_faces()
  {
    if (!discretization->face)
      return;
    for (const types::boundary_id id : discretization->face->held_boundaries())
      if (announced_held_faces.insert(id).second)
        console.remark(
          "Note: nothing slips on boundary " + std::to_string(id) +
          ", although it has friction: other conditions hold all of its nodes "
          "on the present mesh; refine it there, or release another boundary.");
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::announce_solver()
  {
    const std::string name = time_stepper->method().solver_name();
    if (name.empty() || name == announced_solver)
      return;
    announced_solver = name;
    out << "Linear solver: " << announced_solver << std::endl;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::check_references() const
  {
    const std::string &directory =
      parameters.exact_solution.reference_directory;
    if (directory.empty())
      return;
    AssertThrow(!scene.exact_solution,
                ExcMessage("'Exact solution/Reference directory' and 'Exact "
                           "solution/Displacement' are both given; errors "
                           "can be measured against one of them."));
    for (unsigned int i = 1; i <= scene.schedule.n_phases(); ++i)
      read_samples<dim>(samples_file(directory, i), communicator);
  }



  template <int dim>
  SolutionErrors
  ViscoplasticContact<dim>::measure_errors(const State<dim> &of)
  {
    const unsigned int phase = scene.schedule.phase_ending_at(of.t);
    const std::string &reference =
      parameters.exact_solution.reference_directory;
    SolutionErrors result;
    result.error.fill(std::numeric_limits<double>::quiet_NaN());
    result.exact  = result.error;
    result.memory = result.error.energy;
    // A run without files has no output.
    const bool writes =
      output && parameters.output.reference_fields && phase > 0;
    if (!writes && !scene.exact_solution && (reference.empty() || phase == 0))
      return result;

    TimerOutput::Scope         scope(timer, "errors");
    const Discretization<dim> &d = *discretization;
    DistributedVector          multipliers;
    const DistributedVector   *density = nullptr;
    if (d.face)
      {
        multipliers = d.face->density(of.friction);
        density     = &multipliers;
      }
    if (writes)
      write_samples(sample_fields(d.stress_space, of, density),
                    samples_file(output->directory(), phase),
                    communicator);
    if (scene.exact_solution)
      result = solution_errors(d.stress_space, of, density);
    else if (!reference.empty() && phase > 0)
      {
        const auto samples =
          read_samples<dim>(samples_file(reference, phase), communicator);
        std::ostringstream message;
        message << "'Exact solution/Reference directory': phase " << phase
                << " of the reference ends at t = " << samples.t
                << ", that of this run at t = " << of.t
                << "; 'Time/Phases' must have the same end times.";
        AssertThrow(std::abs(samples.t - of.t) <= 1e-10 * std::abs(of.t),
                    ExcMessage(message.str()));
        const double nothing = result.memory;
        result        = differences(samples, d.stress_space, of, density);
        result.memory = nothing;
      }
    return result;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::close()
  {
    recorder.check_sizes(/* at_end = */ true);
    std::vector<std::string> remarks = console.remarks();
    for (const std::string &remark : recorder.remarks(accepted.state))
      remarks.push_back(remark);
    recorder.print(console.stream(),
                   coarser_summary ? &*coarser_summary : nullptr);
    if (coarser_summary && Utilities::MPI::this_mpi_process(communicator) == 0)
      write_uncertainties(output->directory() + "uncertainty.csv",
                          recorder.summary(),
                          *coarser_summary);
    if (const auto &errors = recorder.summary().errors)
      output->record_errors(*errors);
    for (const std::string &remark : remarks)
      out << remark << '\n';
    out << "Results in " << output->directory() << std::endl;
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
