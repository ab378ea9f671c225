// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/error/error_estimate.h>
#include <viscoplastic_contact/error/solution_norms.h>
#include <viscoplastic_contact/results/statistics.h>
#include <viscoplastic_contact/scene/place_names.h>
#include <viscoplastic_contact/time_stepping/step_control.h>

#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A part of a run whose wall time is taken by itself.
  struct RunPhase
  {
    /// The name of the section of the timer of a run.
    std::string name;
    /// What it is paid for, and what that is, for the lines at the end of a
    /// run.
    std::string effect, text;
    /// Whether statistics.csv has its seconds in each step, as wall_<name>.
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

  /// The largest value over a run, and when it was reached.
  struct Largest
  {
    double value = 0., t = 0.;

    /// Take a value that is larger than those before; returns whether it is.
    bool
    update(const double new_value, const double new_t)
    {
      if (!(new_value > value))
        return false;
      value = new_value;
      t     = new_t;
      return true;
    }
  };



  /// The step in which something has been so for the first time.
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
    exchange(Archive &archive)
    {
      archive &n &before &t &is_over;
    }
  };



  /// The quantities of interest for the closing words of a run, as
  /// doc/results.md defines them. Absent: what the scene does not have.
  template <int dim>
  struct RunSummary
  {
    /// The end of the last step, and what the closing words have of it.
    double                            t = 0.;
    std::vector<StatisticsRow::Entry> at_end;
    bool has_viscosity = false, has_flowed = false, has_friction = false;
    /// The estimate by which an adaptive scene without error estimate refines.
    std::optional<double> error_estimate;
    /// The errors of a scene with error estimate.
    std::optional<ErrorSummary> errors;
    /// The errors of the quantity of interest of this name; empty without one.
    std::string  quantity;
    ErrorSummary quantity_errors;
    /// With a quantity and no tolerance: the norms of the dual solution after
    /// the steps, and their times.
    std::vector<double> dual_times, dual_norms;
    /// The tolerance of a run that keeps one, and where prescribed
    /// displacements jump, so that no error bar is true; absent: nowhere.
    std::optional<double>     tolerance;
    std::optional<Point<dim>> jump_position;
    /// Whether curved bodies in contact have missed more of their geometry than
    /// the whole solution is.
    bool has_coarse_curves = false;

    /// The errors that a tolerance is for.
    const ErrorSummary &
    controlled_errors() const
    {
      return quantity.empty() ? *errors : quantity_errors;
    }

    /// Whether the tolerance is that of a quantity that has always been zero,
    /// and not because curved bodies have missed each other.
    bool
    has_zero_quantity() const
    {
      return tolerance && !quantity.empty() && quantity_errors.size == 0. &&
             !has_coarse_curves;
    }

    Largest displacement, strain, von_mises, pressure, slip_area, slip_rate,
      capped_volume, utilization;
    /// In which the body has touched and slipped.
    FirstStep first_touch, first_slip;
    /// The part of the faces in bilateral contact on which the foundation
    /// pulls.
    Largest tension_share;
    /// InterfaceSlide::largest().
    Largest slide;
    /// The places of the largest displacement and the largest von Mises stress.
    Point<dim> displacement_position, von_mises_position;
    /// The area of all friction points on the mesh on which slip_area was
    /// reached.
    double friction_area = 0.;
    /// With lagged Coulomb friction: sums over the steps of k times what
    /// StepQuantities::friction_bounds has.
    double missed_bounds = 0., computed_bounds = 0.;
    /// Sentences on the first steps whose solution may not be unique.
    std::vector<std::string> doubtful_steps;
    /// The largest k r, and where r was that large.
    Largest    stiffness;
    Point<dim> critical_position;
    /// The number of steps, and what step control did to them; absent where the
    /// steps are those of the phases.
    unsigned int n_steps = 0;
    /// Of the last mesh.
    types::global_cell_index n_cells = 0;
    /// Steps in which nothing has changed, which took no solve.
    unsigned int                unchanged_steps = 0;
    std::optional<StepCounts>   steps;
    std::optional<unsigned int> implicit_steps;
    /// The largest errors against an exact solution, and the largest norms of
    /// that; zero without one.
    SolutionNorms largest_error, largest_exact;

    /// Numbers have their units if @p units are declared, and places their
    /// names.
    void
    print(std::ostream &out, const Units &units, const PlaceNames &names) const;
  };



  /// The wall time of the effects of a scene in a run.
  struct RunBill
  {
    /// Seconds by phase, as run_phases names them; `set-up' is that of the
    /// first mesh, later ones are part of the adaptation.
    std::map<std::string, double> seconds;
    /// Seconds of the whole run, and of its parts before a restart.
    double total = 0., earlier = 0.;
    bool   has_viscosity = false;
    /// Seconds of the solves of all steps, and what they would have taken
    /// without friction; the latter is absent where nothing can slip.
    double                solves = 0.;
    std::optional<double> plain_solves;

    /// The part of the phase `contact' that is friction's. What it is of the
    /// solves of steps that have been accepted, it is of all.
    double
    friction() const
    {
      const auto contact = seconds.find("contact");
      if (!plain_solves || !(solves > 0.) || contact == seconds.end())
        return 0.;
      return contact->second * (1. - *plain_solves / solves);
    }

    /// Effects that the scene does not have get no line.
    void
    print(std::ostream &out) const;
  };
} // namespace Viscoplastic
