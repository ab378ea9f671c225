// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <viscoplastic_contact/error/error_estimate.h>
#include <viscoplastic_contact/error/solution_norms.h>
#include <viscoplastic_contact/results/statistics.h>
#include <viscoplastic_contact/scene/scene.h>
#include <viscoplastic_contact/time_stepping/step_control.h>

#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A part of a run whose wall time is measured.
  struct RunPhase
  {
    /// The name of the section in the timer of a run.
    std::string name;
    /// The effect that causes the time, and a description of the work, for the
    /// lines at the end of a run.
    std::string effect, text;
    /// Whether statistics.csv has its time in each step, as wall_<name>.
    bool is_in_statistics;
  };

  /// All phases, in the order in which they are printed and written.
  inline const std::vector<RunPhase> run_phases{
    {"pilot run",
     "pilot run",
     "of the tolerance: the size of the solution, the mesh of a quantity",
     false},
    {"set-up", "set-up", "spaces, matrix, factorization or multigrid", false},
    {"rate", "viscosity", "flow of the law in all cells", true},
    {"tangent",
     "backward Euler",
     "matrices of the steps with their set-up",
     true},
    {"load", "data", "loads, friction bounds, motion of foundations", true},
    {"contact",
     "elasticity",
     "linear solves, as they would be without friction",
     true},
    {"balance", "balance", "energies, reactions, statistics.csv", true},
    {"estimate",
     "error estimate",
     "of the mesh, of steps and iterations",
     true},
    {"adaptation", "adaptivity", "new meshes with their set-up", false},
    {"output", "fields", "for ParaView", true},
    {"errors", "comparison", "with an exact solution or a reference", false},
    {"checkpoint", "checkpoints", "to go on from", false}};



  using namespace dealii;

  /// The largest value over a run, the time at which it was reached, and its
  /// place if that is recorded.
  template <int dim>
  struct Largest
  {
    double     value = 0., t = 0.;
    Point<dim> position = {};

    void
    update(const double      new_value,
           const double      new_t,
           const Point<dim> &where = {})
    {
      if (new_value > value)
        *this = {new_value, new_t, where};
    }
  };



  /// The first step in which a condition holds.
  struct FirstStep
  {
    unsigned int n      = 0;
    double       before = 0., t = 0.;
    bool         is_over = false;

    void
    update(const bool is_so, const TimeStep &step)
    {
      if (is_over || !is_so)
        return;
      *this = {step.n, step.t_old, step.t, true};
    }

    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      archive &n &before &t &is_over;
    }
  };



  /// The results printed at the end of a run, as doc/results.md defines them.
  /// Absent: what the scene does not have.
  template <int dim>
  struct RunSummary
  {
    /// The end of the last step, and the values there.
    double                       t = 0.;
    std::vector<TableRow::Entry> at_end;
    bool                         has_flowed = false;
    /// The refinement estimate of an adaptive scene without error estimate.
    std::optional<double> error_estimate;
    /// The errors of a scene with error estimate.
    std::optional<ErrorSummary> errors;
    /// The errors of the quantity of interest of this name; empty without one.
    std::string  quantity;
    ErrorSummary quantity_errors;
    /// With a quantity and no tolerance: the norms of the dual solution after
    /// steps, and the times of these.
    std::vector<double> dual_times, dual_norms;
    /// The tolerance of the run, if any; and a position where prescribed
    /// displacements jump, if any, which invalidates error bars.
    std::optional<double>     tolerance;
    std::optional<Point<dim>> jump_position;
    /// Whether the error by the geometry of curved bodies in contact has
    /// exceeded the energy norm of the solution.
    bool has_coarse_curves = false;

    /// The errors to which a tolerance applies.
    const ErrorSummary &
    controlled_errors() const
    {
      return quantity.empty() ? *errors : quantity_errors;
    }

    /// Whether the tolerance is that of a quantity that has always been zero,
    /// unless the cause may be that curved bodies have missed each other.
    bool
    has_zero_quantity() const
    {
      return tolerance && !quantity.empty() && quantity_errors.size == 0. &&
             !has_coarse_curves;
    }

    /// Displacement and von Mises stress have places.
    Largest<dim> displacement, strain, von_mises, pressure, slip_area,
      slip_rate, capped_volume, utilization;
    /// The first steps with contact and with slip.
    FirstStep first_touch, first_slip;
    /// The part of the faces in bilateral contact on which the foundation is in
    /// tension.
    Largest<dim> tension_share;
    /// InterfaceSlide::largest().
    Largest<dim> slide;
    /// The area of all friction points on the mesh on which slip_area was
    /// largest.
    double friction_area = 0.;
    /// With lagged Coulomb friction: sums over the steps of k times the values
    /// of StepQuantities::friction_bounds.
    double missed_bounds = 0., computed_bounds = 0.;
    /// Sentences on the first steps with possibly several solutions.
    std::vector<std::string> doubtful_steps;
    /// The largest k r, and the position of the largest r in that step.
    Largest<dim> stiffness;
    /// The number of steps; counts of step control follow below, absent where
    /// the steps are those of the phases.
    unsigned int n_steps = 0;
    /// The number of cells of the last mesh.
    types::global_cell_index n_cells = 0;
    /// Steps in which nothing has changed and that needed no solve.
    unsigned int                unchanged_steps = 0;
    std::optional<StepCounts>   steps;
    std::optional<unsigned int> implicit_steps;
    /// The largest errors against an exact solution, and the largest norms of
    /// the exact solution; zero without one.
    SolutionNorms largest_error, largest_exact;

    /// Print the summary, with units if the scene declares them.
    void
    print(std::ostream &out, const Scene<dim> &scene) const;
  };



  /// The wall time spent on the effects of a scene in a run.
  struct RunBill
  {
    /// Seconds by phase, see run_phases; `set-up' is that of the first mesh,
    /// while later ones belong to the adaptation.
    std::map<std::string, double> seconds;
    /// Seconds of this process, and of parts of the run before a restart.
    double total = 0., earlier = 0.;
    bool   has_viscosity = false;
    /// Seconds of the solves of all steps, and what they would have taken
    /// without friction; the latter is absent without friction.
    double                solves = 0.;
    std::optional<double> plain_solves;

    /// The seconds of the phase `contact' due to friction: its share of the
    /// solves in accepted steps is taken for that of the phase.
    double
    friction() const
    {
      const auto contact = seconds.find("contact");
      if (!plain_solves || !(solves > 0.) || contact == seconds.end())
        return 0.;
      return contact->second * (1. - *plain_solves / solves);
    }

    /// Print a line for each effect that the scene has.
    void
    print(std::ostream &out) const;
  };
} // namespace Viscoplastic
