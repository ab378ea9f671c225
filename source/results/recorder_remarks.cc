// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/memory_bound.h>
#include <viscoplastic_contact/mesh/mesh_size.h>
#include <viscoplastic_contact/results/recorder.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

// What the numbers of a run have to be taken with: sentences for the user.

namespace Viscoplastic
{
  template <int dim>
  void
  Recorder<dim>::judge(const AcceptedStep<dim>   &step,
                       const StepQuantities<dim> &quantities)
  {
    // The contact tolerance bounds the error in the energy norm, in which
    // nearly incompressible bodies hide large errors of reactions.
    const double      defect    = balance_defect(quantities);
    const std::string time_unit = scene.unit(Quantity::time);
    constexpr double  lost = 1e-3, far = 1e3;
    const double      times =
      quantities.max_displacement /
      body_diagonal(discretization->space.dof_handler.get_triangulation());
    std::ostringstream loss;
    // Loads that are not rounding, of which rounding loses a part.
    if (const double missing = stable_norm(quantities.sum_of_forces);
        missing > lost * std::max(largest_force, quantities.load_size) &&
        missing < quantities.load_size &&
        missing <= quantities.rounding_of_forces)
      loss << "forces miss the loads by " << missing / quantities.load_size
           << " of them";
    else if (quantities.load_size > 0. && times > far &&
             step.report.relative_error > lost)
      loss << "the error is " << step.report.relative_error
           << " of the solution";
    if (!loss.str().empty())
      {
        loss << ", which is rounding of displacements";
        if (times > far)
          loss << " of " << times << " times the size of the body: "
               << (discretization->space.is_held_by_contact() ?
                     "contact hardly holds it, or not at all. Let the loads "
                     "press the body onto its foundation, or prescribe "
                     "displacements that hold it." :
                     "it flows without end, or gives way far too easily. Look "
                     "at the units of its material and its loads.");
        else
          loss << " where the body is stiffest: materials whose stiffness "
                  "differs by less, or prescribed displacements where it is "
                  "stiff, mend that.";
        throw StepFailure(step.time_step.n, step.time_step.t, loss.str());
      }
    // Beside stresses that balance each other the forces may be nothing.
    const bool is_beside_stresses =
      quantities.largest_force * quantities.max_displacement <
      std::min(1., 1e3 * step.report.tolerance) * quantities.stored_energy;
    if (step.time_step.n > 0 && !balance_is_doubtful && !is_beside_stresses &&
        defect > std::max(1e-8, std::min(1e3 * step.report.tolerance, 1e-2)))
      {
        balance_is_doubtful = true;
        std::ostringstream text;
        text << "Warning: forces balance only to " << defect
             << " of the largest at t = " << step.time_step.t << time_unit
             << "; a smaller 'Solver/Contact tolerance' mends this unless "
                "Poisson's ratio is next to 1/2 or the body hardly resists.";
        console.remark(text.str());
      }
    if (!solver_error_is_told && step.report.tolerance > 0. &&
        step.report.relative_error > 1.01 * step.report.tolerance)
      {
        solver_error_is_told = true;
        std::ostringstream text;
        text << "Warning: rounding leaves an error of the solver of "
             << step.report.relative_error << " at t = " << step.time_step.t
             << time_unit << ", more than its tolerance of "
             << step.report.tolerance
             << ": cells that are less flat, stiffness that differs less or "
                "Poisson's ratio farther from 1/2 would leave less.";
        console.remark(text.str());
      }
    constexpr unsigned int most_doubts = 3; // that are told
    if (!step.report.doubt.empty() && run.doubtful_steps.size() < most_doubts)
      {
        std::ostringstream text;
        text << "the step to t = " << step.time_step.t << time_unit
             << " may have several solutions, and the body may jump in it: "
             << step.report.doubt << '.';
        run.doubtful_steps.push_back(text.str());
        console.remark("Warning: " + text.str());
      }
    if (!is_loose && step.time_step.n > 0 &&
        discretization->space.is_held_by_contact())
      {
        double pushes = 0.;
        for (const auto &multiplier : step.end.state.contact.multiplier)
          pushes += multiplier.norm();
        is_loose =
          Utilities::MPI::sum(pushes, discretization->space.communicator) <=
          1e-8 * step.end.forces.internal.l1_norm();
        if (is_loose)
          {
            std::ostringstream text;
            text << "Note: at t = " << step.time_step.t << time_unit
                 << " nothing presses the body onto its foundation, so that "
                    "its rigid motions are arbitrary; a small load that "
                    "presses it determines them.";
            console.remark(text.str());
          }
      }
    // Beside the nodal forces of the stress: loads may balance each other.
    if (!scene.supports.empty() && !support_carries && step.time_step.n > 0)
      {
        const double size = step.end.forces.internal.l1_norm();
        for (const Support<dim> &support : scene.supports)
          {
            const double force =
              stable_norm(quantities.reactions.at(support.condition.id));
            if (support_carries || force <= 1e-3 * size)
              continue;
            support_carries = true;
            std::ostringstream text;
            text
              << "Note: at t = " << step.time_step.t << time_unit
              << " the support at " << support.place << " carries a force, of "
              << force << scene.unit(Quantity::force)
              << "; there is no bounded stress there, and the body gives way "
                 "at the support without bound as the mesh is refined.";
            console.remark(text.str());
          }
      }
    if (run.capped_volume.value == 0. && step.capped_volume > 0.)
      {
        std::ostringstream text;
        text << "Warning: the stress has passed the cap of a law, in the "
                "volume "
             << step.capped_volume << scene.unit(Quantity::volume)
             << " at t = " << step.time_of_rate() << time_unit
             << "; beyond it the law is continued linearly.";
        console.remark(text.str());
      }
  }



  template <int dim>
  std::string
  Recorder<dim>::remark_on_tolerance() const
  {
    const ErrorSummary &summary = run.controlled_errors();
    const ErrorParts   &errors  = summary.largest;
    const double        size    = summary.size;
    const auto n_cells = discretization->space.dof_handler.get_triangulation()
                           .n_global_active_cells();
    const RefinementParameters &refinement = scene.parameters.refinement;
    const unsigned int          n_in_memory =
      refinement.memory_budget > 0. ?
                 cells_in_memory(*discretization, 1e9 * refinement.memory_budget) :
                 std::numeric_limits<unsigned int>::max();
    std::ostringstream text;
    text << std::setprecision(3)
         << "Warning: 'Error control/Tolerance' = " << budget->tolerance
         << " has not been kept: at t = " << summary.t
         << scene.unit(Quantity::time) << " the error is estimated as "
         << summary.relative() << " of the "
         << (scene.quantity ?
               "largest " + scene.names.quantity(scene.quantity->name) :
               "solution")
         << ", of it " << errors.space / size << " by the mesh, "
         << errors.history / size << " by the history, "
         << (errors.time + errors.friction) / size << " by the time steps and "
         << errors.initial / size << " by the initial data; ";
    if (errors.time + errors.friction > 0.5 * errors.total())
      text << "steps of the smallest size are too long, so that the data jump "
              "or 'Step control/Smallest step' is too large.";
    else if (errors.history_adds && errors.history > 0.5 * errors.total())
      text << "'Material/Stress history' = cell means lets no stress flow that "
              "varies within cells.";
    else if (!scene.is_adaptive())
      text << "the mesh is fixed by 'Mesh refinement/Strategy'.";
    else if (budget->unavoidable > 0. && scene.has_viscosity())
      text << "finer meshes do not lower what earlier ones have left in the "
              "history: begin with more 'Geometry/Global refinements', or with "
              "'Material/Stress history' = quadrature points.";
    else if (n_in_memory < refinement.cell_budget &&
             n_cells > 0.8 * n_in_memory)
      text << "it takes more memory than 'Mesh refinement/Memory budget' = "
           << refinement.memory_budget << " GB.";
    else if (n_cells > 0.8 * refinement.cell_budget)
      text << "it takes more cells than 'Mesh refinement/Cell budget' = "
           << refinement.cell_budget << '.';
    else if (discretization->space.dof_handler.get_triangulation()
               .n_global_levels() > refinement.maximal_level)
      text << "it takes cells beyond 'Mesh refinement/Maximal level' = "
           << refinement.maximal_level << '.';
    else if (budget->unavoidable > 0.)
      text << "finer meshes do not lower it.";
    else if (budget->expected_size > size)
      text << "the run on the first mesh has expected "
           << budget->expected_size / size
           << " times as large a solution: begin with more 'Geometry/Global "
              "refinements'.";
    else
      text << "later meshes do not lower what earlier steps and the initial "
              "data have left.";
    return text.str();
  }



  template <int dim>
  std::vector<std::string>
  Recorder<dim>::remarks(const State<dim> &state) const
  {
    std::vector<std::string> result;
    const std::string        time_unit = scene.unit(Quantity::time);
    const double             fluctuation =
      scene.has_viscosity() ?
                    relative_stress_fluctuation(discretization->stress_space, state) :
                    0.;
    if (fluctuation > 0.2 &&
        scene.parameters.stress.stress_history == StressHistory::cell_means)
      {
        std::ostringstream text;
        text << std::setprecision(3)
             << "Note: the stress varies within cells by " << fluctuation
             << " of its norm, so that cell means may be too stiff in long "
                "creep; refine the mesh or set 'Material/Stress history' = "
                "quadrature points.";
        result.push_back(text.str());
      }

    if (run.tension_share.value > 0.01)
      {
        std::ostringstream text;
        text << "Note: at t = " << run.tension_share.t << time_unit
             << " the foundation pulls at the body on "
             << std::lround(100. * run.tension_share.value)
             << " % of the face in bilateral contact, which does not open; "
                "'Contact law' = unilateral does.";
        result.push_back(text.str());
      }

    if (run.slide.value > 1.)
      {
        std::ostringstream text;
        text << std::setprecision(2) << "Note: at t = " << run.slide.t
             << time_unit << " two bodies have slid along each other by "
             << run.slide.value
             << " times the width of a face, and still touch where they did "
                "at first.";
        result.push_back(text.str());
      }
    if (discretization->slide)
      for (const auto &[id, share] : discretization->slide->uncovered_shares())
        if (share > 0.005)
          result.push_back(
            "Note: " + std::to_string(std::lround(100. * share)) + " % of " +
            scene.names.of("boundary", id) +
            " has nothing opposite and touches nothing; 'Boundary " +
            std::to_string(id) + "/Against' belongs to the smaller face.");

    if (run.missed_bounds > 0.01 * run.computed_bounds)
      {
        std::ostringstream text;
        text << std::setprecision(2)
             << "Note: the bounds of Coulomb friction, of the pressure of the "
                "step before, miss those of the pressure of their step by "
             << 100. * run.missed_bounds / run.computed_bounds
             << " % on average; smaller steps or 'Solver/Coulomb pressure' = "
                "Newton mend this.";
        result.push_back(text.str());
      }

    // What is missing is the work of friction, see EnergyBalance.
    if (const double missing = std::abs(balance.defect()),
        friction             = balance.friction_dissipation();
        run.has_friction && !scene.has_stages() && missing > 0.1 * friction &&
        missing > 1e-3 * balance.scale())
      {
        std::ostringstream text;
        text
          << std::setprecision(2) << "Note: the energy balance is missing "
          << 100. * missing / friction
          << " % of the friction dissipation, which may be wrong by about that: "
             "it takes the friction at the ends of steps, which changes "
             "within them; shorter steps mend this, which 'Error "
             "control/Quantity' = friction_dissipation chooses.";
        result.push_back(text.str());
      }

    if (run.has_zero_quantity())
      result.push_back("Warning: '" +
                       scene.names.quantity(scene.quantity->name) +
                       "' is zero throughout, but for rounding; no tolerance "
                       "relative to it means anything.");
    else if (budget && run.controlled_errors().relative() > budget->tolerance)
      result.push_back(remark_on_tolerance());

    for (const std::string &what : effects.that_never_acted(scene, run))
      result.push_back("Note: " + what);

    // What meshes do is no physics.
    if (std::abs(balance.adaptation_energy()) > 0.1 * balance.scale())
      {
        std::ostringstream text;
        text << std::setprecision(3)
             << "Warning: changes of the mesh have added "
             << balance.adaptation_energy()
             << " to the stored energy beyond the work of the loads, beside "
             << balance.scale()
             << " of the loads and the initial state: some meshes were so "
                "coarse that energies, and what flowed on them, are not to be "
                "trusted. Begin with a finer mesh ('Geometry/Global "
                "refinements').";
        result.push_back(text.str());
      }

    const double size =
      body_diagonal(discretization->space.dof_handler.get_triangulation());
    const bool is_far = run.displacement.value > size;
    // Scenes without units are mathematics, where sizes mean nothing.
    if (is_far ||
        run.strain.value > (scene.parameters.units.are_declared() ? 0.1 : 1.))
      {
        std::ostringstream text;
        text << std::setprecision(3)
             << "Note: at t = " << (is_far ? run.displacement.t : run.strain.t)
             << time_unit;
        if (is_far)
          text << " the largest displacement is "
               << run.displacement.value / size
               << " times the size of the body";
        else
          text << " the norm of the strain is " << run.strain.value
               << " in the mean of what is deformed";
        if (run.strain.value > 1. && run.displacement.value < 0.05 * size)
          text << ", although displacements are small: a point alone carries "
                  "force, as where a symmetry ends, and strains there grow as "
                  "cells become smaller (the stress is largest at x = ("
               << run.von_mises_position << ")).";
        else
          text << "; small strains are assumed, so that "
               << (is_far || run.strain.value > 1. ?
                     "this is flow without end or a load far too large, and "
                     "only its onset means something." :
                     "results may be wrong by about that, relatively, which no "
                     "error bar has.");
        result.push_back(text.str());
      }
    return result;
  }



  template void
  Recorder<2>::judge(const AcceptedStep<2> &, const StepQuantities<2> &);
  template void
  Recorder<3>::judge(const AcceptedStep<3> &, const StepQuantities<3> &);
  template std::vector<std::string>
  Recorder<2>::remarks(const State<2> &) const;
  template std::vector<std::string>
  Recorder<3>::remarks(const State<3> &) const;
} // namespace Viscoplastic
