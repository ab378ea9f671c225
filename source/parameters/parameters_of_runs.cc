// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/patterns.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/parameters/parameters.h>

// The entries on how a scene is computed and what is written; those that
// describe the scene itself are in parameters.cc.

namespace Viscoplastic
{
  void
  StepControlParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Tolerance",
      tolerance,
      "How large the error of the time steps may become over the run, "
      "relative to the solution in the energy norm: steps are then chosen by "
      "their estimated error, within 2/r for explicit schemes, and `Time/"
      "Phases' gives the first step of each phase. 0: the steps are those of "
      "`Time/Phases'.",
      Patterns::Double(0.));
    prm.add_parameter(
      "Landing times",
      landing_times,
      "Times separated by commas at which a step ends, besides "
      "the ends of phases, the multiples of `Output/Fields "
      "interval', and kinks and jumps of the data. Unit: time.");
    prm.add_parameter(
      "Land on kinks",
      land_on_kinks,
      "Whether steps chosen by their error end where data have kinks in time "
      "(`min', `abs', `if', ...), and just before and after jumps. Steps of "
      "`Time/Phases' stay as they are.");
    add_choice(
      prm,
      "Resolve events",
      resolve_events,
      "Whether steps in which slip begins somewhere, comes to cover "
      "all of the face, ends everywhere or turns back are divided "
      "until they are as short as `Event tolerance' says. "
      "`automatic': they are, but for runs to `Error control/Tolerance'.");
    prm.add_parameter("Event tolerance",
                      event_tolerance,
                      "How exactly the times of such events are found, "
                      "relative to the length of the phase, but not below "
                      "`Smallest step'.",
                      Patterns::Double(1e-12, 1.));
    prm.add_parameter("Largest step",
                      largest_step,
                      "Longer steps are not taken; 0 for the length of the "
                      "phase, or in scenes without viscosity, which see only "
                      "slip that turns from one step to the next, for the "
                      "steps of `Time/Phases'. Unit: time.",
                      Patterns::Double(0.));
    prm.add_parameter("Smallest step",
                      smallest_step,
                      "Steps of this size are accepted whatever their error, "
                      "and a step that fails is not divided further; 0 for "
                      "1e-6 of the length of the phase. Unit: time.",
                      Patterns::Double(0.));
  }



  void
  SolverParameters::declare(ParameterHandler &prm)
  {
    add_choice(
      prm,
      "Linear solver",
      linear_solver,
      "`direct': sparse Cholesky (CHOLMOD) with the contact face condensed, "
      "on one MPI rank; `multigrid': conjugate gradients with multigrid on "
      "the meshes that refinement has gone through, or with `algebraic "
      "multigrid' (ML) where it has hardly refined any, on any number; "
      "`automatic' chooses.");
    prm.add_parameter(
      "Contact tolerance",
      contact_tolerance,
      "Bound on the algebraic error of each step in the energy norm, relative "
      "to the solution, at which the active set and linear iterations stop. 0: "
      "`Error control/Algebraic fraction' of the estimated discretization "
      "error. Not between 0 and 1e-14.",
      Patterns::Double(0., 0.1));
    prm.add_parameter("Maximal contact iterations",
                      maximal_iterations,
                      "The run ends with an error when a step needs more.",
                      Patterns::Integer(1));
    add_choice(
      prm,
      "Coulomb pressure",
      coulomb_pressure,
      "In unilateral contact and normal compliance, the pressure p of the "
      "friction bound mu p. `Newton': that of the step itself, found together "
      "with the displacement at the price of given bounds. `fixed point': that "
      "of the step itself, too; the step is solved again with the pressure "
      "that has come out until the bounds stay, and the run ends where they do "
      "not; for comparison. `lagged': that of the end of the step before, so "
      "that each step has one solution and is solved once; the error is of "
      "first order in the step, and large where steps are.");
    prm.add_parameter(
      "Coulomb tolerance",
      coulomb_tolerance,
      "For `fixed point': how much the bounds may still change, "
      "relative to their sum.",
      Patterns::Double(1e-14, 1.));
    prm.add_parameter("Reuse unchanged",
                      reuse_unchanged,
                      "Keep the solution of the step before, with its forces, "
                      "rates and estimates, where nothing has changed that it "
                      "depends on.");
  }



  void
  ErrorControlParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Tolerance",
                      tolerance,
                      "How large the error of the run may become: in the "
                      "energy norm, by the error bar, relative to the largest "
                      "norm of the solution. The run then chooses meshes and "
                      "steps so that they cost least; `Time/Phases' gives the "
                      "first step of each phase, `Geometry' the first mesh. "
                      "0: meshes and steps are those of the other entries.",
                      Patterns::Double(0., 1.));
    prm.add_parameter(
      "Quantity",
      quantity,
      "A column of statistics.csv whose error is estimated, too, and for which "
      "`Tolerance' is then, relative to its largest value: "
      "`friction_dissipation', a force such as `friction_force_x', "
      "`contact_force_y', also on one of several boundaries, `reaction_1_y', a "
      "displacement `point0_x' of `Output/Points', or in generalized plane "
      "strain `axial_strain' or `axial_force'; with names `reaction_y of "
      "roof', `contact_force_y of floor', `displacement_x of crown'. All steps "
      "are made twice then, first to find one mesh for all times. Empty: the "
      "energy norm.");
    prm.add_parameter("Error bar",
                      error_estimator,
                      "Estimate the error of every step in the energy norm: "
                      "of the mesh, of the time steps, of the iterations and "
                      "of the initial data.");
    prm.add_parameter("Algebraic fraction",
                      algebraic_fraction,
                      "Where `Solver/Contact tolerance' is 0: the iterations "
                      "of a step stop when the bound on their error is this "
                      "fraction of the estimated discretization error.",
                      Patterns::Double(1e-6, 0.5));
  }



  void
  StudyParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Levels",
                      levels,
                      "Runs of each ladder. Each level halves what the ladder "
                      "refines: the mesh width, the time steps, or, where "
                      "their error chooses these, `Step control/Tolerance' "
                      "(with Heun's method it has a quarter).",
                      Patterns::Integer(2, 12));
    prm.add_parameter("Ladders",
                      ladders,
                      "What is refined: the mesh alone, the time steps alone, "
                      "or both; what a ladder leaves alone has the finest "
                      "level.",
                      Patterns::List(Patterns::Selection("space|time|both"),
                                     1,
                                     3));
    prm.add_parameter(
      "Strategies",
      strategies,
      "Uniform refinement, adaptive refinement by the residual "
      "estimator with as many cells, or, of a scene with "
      "`Error control/Tolerance', runs to tolerances that "
      "halve down to this one. If empty, the last for scenes "
      "with a tolerance and the first for others. Where no exact solution is "
      "known, a scene with a tolerance has a run to half of it as reference, "
      "others one of the finest uniform mesh.",
      Patterns::List(Patterns::Selection("uniform|adaptive|tolerance"), 0, 3));
    prm.add_parameter("Time schemes",
                      time_schemes,
                      "Values of `Time/Scheme' to compare, separated by "
                      "commas; that of the scene if empty.");
    prm.add_parameter("Stress histories",
                      stress_histories,
                      "Values of `Material/Stress history' to compare, "
                      "separated by commas; that of the scene if empty.");
    prm.add_parameter("Target errors",
                      target_errors,
                      "Relative errors for which the price list names the "
                      "cheapest run.",
                      Patterns::List(Patterns::Double(1e-12, 1.), 1));
    prm.add_parameter(
      "Budget",
      budget,
      "Studies and prices begin no run that is not expected to end within this "
      "time. Unit: seconds.",
      Patterns::Double(1.));
  }



  void
  RefinementParameters::declare(ParameterHandler &prm)
  {
    add_choice(prm,
               "Strategy",
               strategy,
               "`none' keeps the mesh; `residual' refines by the "
               "residual estimator of the inequality of a step, `kelly' "
               "by jumps of the displacement gradient. `automatic': "
               "`residual' in runs to `Error control/Tolerance', which "
               "choose by themselves when and how much to refine, `none' in "
               "others.");
    prm.add_parameter("Every n steps",
                      every_n_steps,
                      "Steps between changes of the mesh.",
                      Patterns::Integer(1));
    prm.add_parameter("Refinement fraction",
                      refinement_fraction,
                      "The cells with the largest contributions that make up "
                      "this fraction of the squared estimate are refined.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Coarsening fraction",
                      coarsening_fraction,
                      "The same with the smallest contributions, coarsened.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Smallest share",
                      smallest_share,
                      "The mesh stays as it is while the cells to be refined "
                      "have less than this share of the squared estimate, and "
                      "coarsening would not remove a tenth of all cells. With "
                      "0 it always changes.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Minimal level",
                      minimal_level,
                      "No cell is coarsened below this level.",
                      Patterns::Integer(0));
    prm.add_parameter("Maximal level",
                      maximal_level,
                      "No cell is refined above this level.",
                      Patterns::Integer(0));
    prm.add_parameter("Cell budget",
                      cell_budget,
                      "Number of cells beyond which refinement only keeps pace "
                      "with coarsening.",
                      Patterns::Integer(1));
    prm.add_parameter("Memory budget",
                      memory_budget,
                      "Gigabytes that all ranks together may be expected to "
                      "take, as --check does, good to a factor of 1.5; another "
                      "bound on the number of cells. 0: none.",
                      Patterns::Double(0.));
  }



  void
  RefinementParameters::check() const
  {
    if (minimal_level > maximal_level)
      refuse(
        "'Mesh refinement/Minimal level' = " + std::to_string(minimal_level) +
        " must not exceed 'Maximal level' = " + std::to_string(maximal_level) +
        ".");
    if (!(refinement_fraction + coarsening_fraction <= 1.))
      refuse("'Mesh refinement/Refinement fraction' and 'Coarsening fraction' "
             "must add up to at most 1.");
  }



  void
  OutputParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Directory",
                      directory,
                      "Where results go; empty for output/<name of the "
                      "parameter file> in the working directory.");
    prm.add_parameter("Fields every",
                      fields_every,
                      "Steps between outputs of fields; 0 writes only the "
                      "first and the last state.",
                      Patterns::Integer(0));
    prm.add_parameter("Fields interval",
                      fields_interval,
                      "Time between outputs of fields; where positive, it "
                      "replaces the entry above. Unit: time.",
                      Patterns::Double(0.));
    prm.add_parameter(
      "Fields in HDF5",
      in_hdf5,
      "Write the fields of the body as HDF5, one file an output "
      "and one a mesh for all ranks together, for "
      "solution.xdmf; else as VTU, a file a rank with the mesh, "
      "as fields of faces are in any case.");
    prm.add_parameter("Reference fields",
                      reference_fields,
                      "At the end of each phase of time, write the fields in "
                      "all cells for coarser runs to be compared with, see "
                      "`Exact solution/Reference directory'.");
    prm.add_parameter("Revolved angle",
                      revolved_angle,
                      "Degrees by which the section of a body of revolution is "
                      "turned about its axis for the fields on its surface in "
                      "space, revolved.pvd: 360 is the whole body, 270 leaves "
                      "a quarter open, where it shows the section. 0 for none.",
                      Patterns::Double(0., 360.));
    prm.add_parameter("Points",
                      points,
                      "Points of the body, coordinates separated by commas and "
                      "points by semicolons, whose displacement goes into "
                      "statistics.csv; with a name if you like, as in `crown = "
                      "0, 2.5; floor = 0, -2.5'. Unit: length.");
    add_choices(
      prm,
      "Point fields",
      point_fields,
      "What statistics.csv has of these points besides the displacement, "
      "separated by commas. The fields are those of the outputs (see "
      "`Additional fields', which need not have them), `history' of laws with "
      "history variables; a stress or strain is that of the cell of the point. "
      "From `slip' on they are fields of Gamma_3, which the points on it "
      "have.");
    prm.add_parameter("Lines",
                      lines,
                      "Straight lines through the body as `begin : end : "
                      "number of points', separated by semicolons, such as "
                      "`0, 0 : 2, 0 : 101' or `wall = 0, 0 : 2, 0 : 101'. "
                      "Each gets a file, line_0.csv and "
                      "so on, with the displacement at equal distances. Unit: "
                      "length.");
    add_choices(prm,
                "Line fields",
                line_fields,
                "What these files have besides the displacement, as above.");
    prm.add_parameter("Lines every step",
                      lines_every_step,
                      "Whether the files of lines have every step, not only "
                      "those whose fields are written.");
    prm.add_parameter(
      "Integrals",
      integrals,
      "Integrals for statistics.csv, each as `boundary ID: fields', `material "
      "ID: fields' or `body: fields', separated by semicolons, fields by "
      "commas, such as `boundary 3: displacement, stress vector; material 2: "
      "stress, creep strain'. The undeformed area or volume is always there. "
      "Fields are those of `Point fields'; materials and the body also have "
      "`energies', the stored and the dissipated one; boundaries have `normal "
      "traction' "
      "and `stress vector' sigma nu, of the means of the cells behind them, "
      "whatever their role.");
    add_choices(
      prm,
      "Additional fields",
      additional_fields,
      "What the outputs of fields have besides displacements and stresses, "
      "separated by commas. In the body, of cell means: the tensors `total "
      "strain' eps(u) and `irreversible strain' eps(u) - E^-1 sigma, less the "
      "thermal strain; the scalars `creep strain', the equivalent (2/3 "
      "e:e)^(1/2) of the deviator of what flow has added to the irreversible "
      "strain, and `creep rate', the same of -E^-1 G; `principal stresses', "
      "the largest first. On Gamma_3: `normal traction' sigma_nu, negative in "
      "compression; `friction work', what friction has dissipated per area "
      "since t = 0.",
      "total strain|irreversible strain|creep strain|creep rate|principal "
      "stresses|normal traction|friction work");
  }



  void
  CheckpointParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Every n steps",
                      every_n_steps,
                      "Steps between checkpoints, from which --restart goes on "
                      "after an interruption; 0 for none.",
                      Patterns::Integer(0));
    prm.add_parameter("Wall time interval",
                      wall_time_interval,
                      "Time between checkpoints by the clock on the wall; they "
                      "are written at the end of a step. 0 for none. Unit: "
                      "seconds.",
                      Patterns::Double(0.));
    prm.add_parameter("Wall time limit",
                      wall_time_limit,
                      "How long the run may take, counted from the start of "
                      "the program. It ends in time for that with a "
                      "checkpoint, the estimated error so far and exit code 3; "
                      "--restart goes on. 0 for no limit. Unit: seconds.",
                      Patterns::Double(0.));
    prm.add_parameter("Directory",
                      directory,
                      "Where checkpoints go; empty for `checkpoint' in the "
                      "directory of the results.");
    prm.add_parameter("Keep",
                      keep,
                      "How many of the last checkpoints are kept.",
                      Patterns::Integer(1));
  }
} // namespace Viscoplastic
