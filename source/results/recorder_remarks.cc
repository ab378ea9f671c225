// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/error/memory_bound.h>
#include <viscoplastic_contact/mesh/mesh_size.h>
#include <viscoplastic_contact/results/recorder.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

// Sentences for the user that qualify the results of a run.

namespace Viscoplastic
{
  namespace
  {
    /// Return the loss by rounding in a step, as the reason of a failure; empty
    /// if it is small.
    template <int dim>
    std::string
    loss_by_rounding(const Discretization<dim> &discretization,
                     const AcceptedStep<dim>   &step,
                     const StepQuantities<dim> &quantities,
                     const double               largest_force)
    {
      if (quantities.load_size == 0.) // forces add up
        return "";
      constexpr double lost = 1e-3, far = 1e3;
      const double     times =
        quantities.max_displacement /
        body_diagonal(discretization.space.dof_handler.get_triangulation());
      std::string loss;
      // The loads are not rounding themselves, but lose a part by rounding.
      if (const double missing = stable_norm(quantities.sum_of_forces);
          missing > lost * std::max(largest_force, quantities.load_size) &&
          missing < quantities.load_size &&
          missing <= quantities.rounding_of_forces)
        loss = "forces miss the loads by " +
               number(missing / quantities.load_size, 6) + " of them";
      else if (times > far && step.report.relative_error > lost)
        loss = "the error is " + number(step.report.relative_error, 6) +
               " of the solution";
      if (loss.empty())
        return loss;
      loss += ", which is rounding of displacements";
      if (times > far)
        loss += " of " + number(times, 6) + " times the size of the body: " +
                (discretization.space.is_held_by_contact() ?
                   "contact hardly holds it, or not at all. Let the loads "
                   "press the body onto its foundation, or prescribe "
                   "displacements that hold it." :
                   "it flows without end, or gives way far too easily. Look "
                   "at the units of its material and its loads.");
      else
        loss += " where the body is stiffest: materials whose stiffness "
                "differs by less, or prescribed displacements where it is "
                "stiff, mend that.";
      return loss;
    }



    /// Return a remark on strains or displacements that are too large for the
    /// assumption of small strains; empty if they are not.
    template <int dim>
    std::string
    remark_on_strain(const Scene<dim>      &scene,
                     const RunSummary<dim> &run,
                     const double           size)
    {
      const bool is_far = run.displacement.value > size;
      // Without units, scenes may be mathematical problems of any size.
      if (!is_far && !(run.strain.value >
                       (scene.parameters.units.are_declared() ? 0.1 : 1.)))
        return "";
      const std::string what =
        "Note: at t = " +
        number(is_far ? run.displacement.t : run.strain.t, 3) +
        scene.unit(Quantity::time) +
        (is_far ? " the largest displacement is " +
                    number(run.displacement.value / size, 3) +
                    " times the size of the body" :
                  " the norm of the strain is " + number(run.strain.value, 3) +
                    " in the mean of what is deformed");
      if (run.strain.value > 1. && run.displacement.value < 0.05 * size)
        return what +
               ", although displacements are small: a point alone carries "
               "force, as where a symmetry ends, and strains there grow as "
               "cells become smaller (the stress is largest at x = (" +
               as_text(run.von_mises.position, 3) + ")).";
      return what + "; small strains are assumed, so that " +
             (is_far || run.strain.value > 1. ?
                "this is flow without end or a load far too large, and "
                "only its onset means something." :
                "results may be wrong by about that, relatively, which no "
                "error bar has.");
    }



    /// Return center and width of the finest cell; of several, that with the
    /// lexicographically first center. Collective.
    template <int dim>
    std::pair<Point<dim>, double>
    finest_cell(const Triangulation<dim> &triangulation)
    {
      std::array<double, dim + 2> best; // -level, center, width
      best.fill(std::numeric_limits<double>::infinity());
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          {
            std::array<double, dim + 2> found;
            found[0] = -cell->level();
            for (unsigned int d = 0; d < dim; ++d)
              found[d + 1] = cell->center()[d];
            found[dim + 1] = cell->minimum_vertex_distance();
            best           = std::min(best, found);
          }
      const auto of_ranks =
        Utilities::MPI::all_gather(triangulation.get_communicator(), best);
      best = *std::min_element(of_ranks.begin(), of_ranks.end());
      Point<dim> center;
      for (unsigned int d = 0; d < dim; ++d)
        center[d] = best[d + 1];
      return {center, best[dim + 1]};
    }
  } // namespace



  template <int dim>
  void
  Recorder<dim>::judge(const AcceptedStep<dim>   &step,
                       const StepQuantities<dim> &quantities)
  {
    // The contact tolerance bounds the error in the energy norm, in which
    // nearly incompressible bodies hide large errors of reactions.
    const double      defect = balance_defect(quantities);
    const std::string when =
      "at t = " + number(step.time_step.t, 6) + scene.unit(Quantity::time);
    if (const std::string loss =
          loss_by_rounding(*discretization, step, quantities, largest_force);
        !loss.empty())
      throw StepFailure(step.time_step.n, step.time_step.t, loss);
    const auto remark_once = [this](const std::string &subject,
                                    const std::string &sentence) {
      if (told.insert(subject).second)
        console.remark(sentence);
    };
    // Forces may be negligible beside stresses that balance each other.
    const bool is_beside_stresses =
      quantities.largest_force * quantities.max_displacement <
      std::min(1., 1e3 * step.report.tolerance) * quantities.stored_energy;
    if (step.time_step.n > 0 && !is_beside_stresses &&
        defect > std::max(1e-8, std::min(1e3 * step.report.tolerance, 1e-2)))
      remark_once("balance",
                  "Warning: forces balance only to " + number(defect, 6) +
                    " of the largest " + when +
                    "; a smaller 'Solver/Contact tolerance' mends this unless "
                    "Poisson's ratio is next to 1/2 or the body hardly "
                    "resists.");
    if (step.report.tolerance > 0. &&
        step.report.relative_error > 1.01 * step.report.tolerance)
      remark_once("error of the solver",
                  "Warning: rounding leaves an error of the solver of " +
                    number(step.report.relative_error, 6) + ' ' + when +
                    ", more than its tolerance of " +
                    number(step.report.tolerance, 6) +
                    ": cells that are less flat, stiffness that differs less "
                    "or Poisson's ratio farther from 1/2 would leave less.");
    constexpr unsigned int most_doubts = 3; // largest number printed
    if (!step.report.doubt.empty() && run.doubtful_steps.size() < most_doubts)
      {
        run.doubtful_steps.push_back(
          "the step to t = " + number(step.time_step.t, 6) +
          scene.unit(Quantity::time) +
          " may have several solutions, and the body may jump in it: " +
          step.report.doubt + '.');
        console.remark("Warning: " + run.doubtful_steps.back());
      }
    if (step.time_step.n > 0 && discretization->space.is_held_by_contact())
      {
        double pushes = 0.;
        for (const auto &multiplier : step.end.state.contact.multiplier)
          pushes += multiplier.norm();
        if (Utilities::MPI::sum(pushes, discretization->space.communicator) <=
            1e-8 * step.end.forces.internal.l1_norm())
          remark_once("loose body",
                      "Note: " + when +
                        " nothing presses the body onto its foundation, so "
                        "that its rigid motions are arbitrary; a small load "
                        "that presses it determines them.");
      }
    // Compare with the nodal forces of the stress, since loads may cancel.
    if (!scene.supports.empty() && step.time_step.n > 0)
      {
        const double size = step.end.forces.internal.l1_norm();
        for (const Support<dim> &support : scene.supports)
          if (const double force =
                stable_norm(quantities.reactions.at(support.condition.id));
              force > 1e-3 * size)
            remark_once("support",
                        "Note: " + when + " the support at " + support.place +
                          " carries a force, of " + number(force, 6) +
                          scene.unit(Quantity::force) +
                          "; there is no bounded stress there, and the body "
                          "gives way at the support without bound as the mesh "
                          "is refined.");
      }
    if (run.capped_volume.value == 0. && step.capped_volume > 0.)
      console.remark("Warning: the stress has passed the cap of a law, in the "
                     "volume " +
                     number(step.capped_volume, 6) +
                     scene.unit(Quantity::volume) +
                     " at t = " + number(step.time_of_rate(), 6) +
                     scene.unit(Quantity::time) +
                     "; beyond it the law is continued as `Stress cap' says.");
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
      text << (scene.quantity ?
                 "the quantity feels what steps have left before it depends on "
                 "them: set 'Step control/Largest step' to less; or " :
                 "")
           << "steps of the smallest size are too long, so that the data jump "
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
      {
        const auto [place, width] =
          finest_cell(discretization->space.dof_handler.get_triangulation());
        text << "it takes cells beyond 'Mesh refinement/Maximal level' = "
             << refinement.maximal_level << "; at x = (" << place
             << ") they are " << width << scene.unit(Quantity::length)
             << " wide. Where a single node holds or loads the body, "
                "displacements grow without bound with ever smaller cells: "
                "spread that over a face, or choose the level by how wide it "
                "is.";
      }
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
    const auto               at = [this](const double t) {
      return "Note: at t = " + number(t, 6) + scene.unit(Quantity::time);
    };
    const double fluctuation =
      scene.has_viscosity() ?
        relative_stress_fluctuation(discretization->stress_space, state) :
        0.;
    if (fluctuation > 0.2 &&
        scene.parameters.stress.stress_history == StressHistory::cell_means)
      result.push_back("Note: the stress varies within cells by " +
                       number(fluctuation, 3) +
                       " of its norm, so that cell means may be too stiff in "
                       "long creep; refine the mesh or set 'Material/Stress "
                       "history' = quadrature points.");
    if (run.tension_share.value > 0.01)
      result.push_back(
        at(run.tension_share.t) + " the foundation pulls at the body on " +
        std::to_string(std::lround(100. * run.tension_share.value)) +
        " % of the face in bilateral contact, which does not open; 'Contact "
        "law' = unilateral does.");
    if (run.slide.value > 1.)
      result.push_back(at(run.slide.t) +
                       " two bodies have slid along each other by " +
                       number(run.slide.value, 2) +
                       " times the width of a face, and still touch where "
                       "they did at first.");
    if (discretization->slide)
      for (const auto &[id, share] : discretization->slide->uncovered_shares())
        if (share > 0.005)
          result.push_back(
            "Note: " + std::to_string(std::lround(100. * share)) + " % of " +
            scene.names.of("boundary", id) +
            " has nothing opposite and touches nothing; 'Boundary " +
            std::to_string(id) + "/Against' belongs to the smaller face.");

    if (run.missed_bounds > 0.01 * run.computed_bounds)
      result.push_back(
        "Note: the bounds of Coulomb friction, of the pressure "
        "of the step before, miss those of the pressure of "
        "their step by " +
        number(100. * run.missed_bounds / run.computed_bounds, 2) +
        " % on average; smaller steps or 'Solver/Coulomb "
        "pressure' = Newton mend this.");

    // The defect is an error of the work of friction, see EnergyBalance.
    if (const double missing = balance.defect(),
        friction             = balance.friction_dissipation;
        scene.has_friction() && !scene.has_stages() &&
        std::abs(missing) > 0.05 * friction &&
        std::abs(missing) > 1e-3 * balance.scale())
      result.push_back(
        "Note: friction has dissipated " + number(friction) +
        scene.unit(Quantity::energy) + ", by the balance of energy rather " +
        number(std::max(friction + missing, 0.), 3) +
        scene.unit(Quantity::energy) +
        ": what is true lies between, as a rule. The sum takes the friction "
        "at the ends of steps, which changes within them; shorter steps mend "
        "this, which 'Error control/Quantity' = friction_dissipation "
        "chooses.");

    if (run.has_zero_quantity())
      result.push_back("Warning: '" +
                       scene.names.quantity(scene.quantity->name) +
                       "' is zero throughout, but for rounding and iterations; "
                       "no tolerance relative to it means anything. Where it "
                       "should not be, begin with a finer mesh "
                       "('Geometry/Global refinements').");
    else if (budget && run.controlled_errors().relative() > budget->tolerance)
      result.push_back(remark_on_tolerance());

    for (const std::string &what : effects.that_never_acted(scene, run))
      result.push_back("Note: " + what);

    // Energy from changes of the mesh is not physical.
    if (std::abs(balance.adaptation_energy) > 0.1 * balance.scale())
      result.push_back("Warning: changes of the mesh have added " +
                       number(balance.adaptation_energy, 3) +
                       " to the stored energy beyond the work of the loads, "
                       "beside " +
                       number(balance.scale(), 3) +
                       " of the loads and the initial state: some meshes were "
                       "so coarse that energies, and what flowed on them, are "
                       "not to be trusted. Begin with a finer mesh ('Geometry/"
                       "Global refinements').");

    const std::string on_strain = remark_on_strain(
      scene,
      run,
      body_diagonal(discretization->space.dof_handler.get_triangulation()));
    if (!on_strain.empty())
      result.push_back(on_strain);
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Recorder, judge);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Recorder, remarks);
} // namespace Viscoplastic
