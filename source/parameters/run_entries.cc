// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/patterns.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/parameters/entry.h>
#include <viscoplastic_contact/parameters/parameter_file.h>

// The entries on how a scene is computed and what is written; those that
// describe the scene itself are in scene_entries.cc.

namespace Viscoplastic
{
  namespace
  {
    Sections
    sections_of_solution(Parameters &p)
    {
      return {
        {"Step control",
         {{"Tolerance",
           p.step_control.tolerance,
           "How large the error of the time steps may become over the run, "
           "relative to the solution in the energy norm: steps are then chosen "
           "by their estimated error, within 2/r for explicit schemes, and "
           "`Time/Phases' gives the first step of each phase. 0: the steps are "
           "those of `Time/Phases'.",
           Patterns::Double(0.)},
          {"Landing times",
           p.step_control.landing_times,
           "Times separated by commas at which a step ends, besides the ends "
           "of phases, the multiples of `Output/Fields interval', and kinks "
           "and jumps of the data. Unit: time."},
          {"Land on kinks",
           p.step_control.land_on_kinks,
           "Whether steps chosen by their error end where data have kinks in "
           "time (`min', `abs', `if', ...), and just before and after jumps. "
           "Steps of `Time/Phases' stay as they are."},
          {"Resolve events",
           p.step_control.resolve_events,
           "Whether steps in which slip begins somewhere, comes to cover all "
           "of the face, ends everywhere or turns back are divided until they "
           "are as short as `Event tolerance' says. `automatic': they are, but "
           "for runs to `Error control/Tolerance'."},
          {"Event tolerance",
           p.step_control.event_tolerance,
           "How exactly the times of such events are found, relative to the "
           "length of the phase, but not below `Smallest step'.",
           Patterns::Double(1e-12, 1.)},
          {"Largest step",
           p.step_control.largest_step,
           "Longer steps are not taken; 0 for the length of the phase, or in "
           "scenes without viscosity, which see only slip that turns from one "
           "step to the next, for the steps of `Time/Phases'. Unit: time.",
           Patterns::Double(0.)},
          {"Smallest step",
           p.step_control.smallest_step,
           "Steps of this size are accepted whatever their error, and a step "
           "that fails is not divided further; 0 for 1e-6 of the length of the "
           "phase. Unit: time.",
           Patterns::Double(0.)}}},

        {"Solver",
         {{"Linear solver",
           p.solver.linear_solver,
           "`direct': sparse Cholesky (CHOLMOD) with the contact face "
           "condensed, on one MPI rank; `multigrid': conjugate gradients with "
           "multigrid on the meshes that refinement has gone through, or with "
           "`algebraic multigrid' (ML) where it has hardly refined any, on any "
           "number; `automatic' chooses."},
          {"Contact tolerance",
           p.solver.contact_tolerance,
           "Bound on the algebraic error of each step in the energy norm, "
           "relative to the solution, at which the active set and linear "
           "iterations stop. 0: `Error control/Algebraic fraction' of the "
           "estimated discretization error. Not between 0 and 1e-14.",
           Patterns::Double(0., 0.1)},
          {"Maximal contact iterations",
           p.solver.maximal_iterations,
           "The run ends with an error when a step needs more.",
           Patterns::Integer(1)},
          {"Coulomb pressure",
           p.solver.coulomb_pressure,
           "In unilateral contact and normal compliance, the pressure p of the "
           "friction bound mu p. `Newton': that of the step itself, found "
           "together with the displacement at the price of given bounds. "
           "`fixed point': that of the step itself, too; the step is solved "
           "again with the pressure that has come out until the bounds stay, "
           "and the run ends where they do not; for comparison. `lagged': that "
           "of the end of the step before, so that each step has one solution "
           "and is solved once; the error is of first order in the step, and "
           "large where steps are."},
          {"Coulomb tolerance",
           p.solver.coulomb_tolerance,
           "For `fixed point': how much the bounds may still change, relative "
           "to their sum.",
           Patterns::Double(1e-14, 1.)},
          {"Reuse unchanged",
           p.solver.reuse_unchanged,
           "Keep the solution of the step before, with its forces, rates and "
           "estimates, where nothing has changed that it depends on."}}},

        {"Error control",
         {{"Tolerance",
           p.error_control.tolerance,
           "How large the error of the run may become: in the energy norm, by "
           "the error bar, relative to the largest norm of the solution. The "
           "run then chooses meshes and steps so that they cost least; "
           "`Time/Phases' gives the first step of each phase, `Geometry' the "
           "first mesh. 0: meshes and steps are those of the other entries.",
           Patterns::Double(0., 1.)},
          {"Quantity",
           p.error_control.quantity,
           "A column of statistics.csv whose error is estimated, too, and for "
           "which `Tolerance' is then, relative to its largest value: "
           "`friction_dissipation', a force such as `friction_force_x', "
           "`contact_force_y', also on one of several boundaries, "
           "`reaction_1_y', a displacement `point0_x' of `Output/Points', or "
           "in generalized plane strain `axial_strain' or `axial_force'; with "
           "names `reaction_y of roof', `contact_force_y of floor', "
           "`displacement_x of crown'. All steps are made twice then, first to "
           "find one mesh for all times. Empty: the energy norm."},
          {"Error bar",
           p.error_control.error_estimator,
           "Estimate the error of every step in the energy norm: of the mesh, "
           "of the time steps, of the iterations and of the initial data."},
          {"Algebraic fraction",
           p.error_control.algebraic_fraction,
           "Where `Solver/Contact tolerance' is 0: the iterations of a step "
           "stop when the bound on their error is this fraction of the "
           "estimated discretization error.",
           Patterns::Double(1e-6, 0.5)}}},

        {"Mesh refinement",
         {{"Strategy",
           p.refinement.strategy,
           "`none' keeps the mesh; `residual' refines by the residual "
           "estimator of the inequality of a step, `kelly' by jumps of the "
           "displacement gradient. `automatic': `residual' in runs to `Error "
           "control/Tolerance', which choose by themselves when and how much "
           "to refine, `none' in others."},
          {"Every n steps",
           p.refinement.every_n_steps,
           "Steps between changes of the mesh.",
           Patterns::Integer(1)},
          {"Refinement fraction",
           p.refinement.refinement_fraction,
           "The cells with the largest contributions that make up this "
           "fraction of the squared estimate are refined.",
           Patterns::Double(0., 1.)},
          {"Coarsening fraction",
           p.refinement.coarsening_fraction,
           "The same with the smallest contributions, coarsened.",
           Patterns::Double(0., 1.)},
          {"Smallest share",
           p.refinement.smallest_share,
           "The mesh stays as it is while the cells to be refined have less "
           "than this share of the squared estimate, and coarsening would not "
           "remove a tenth of all cells. With 0 it always changes.",
           Patterns::Double(0., 1.)},
          {"Minimal level",
           p.refinement.minimal_level,
           "No cell is coarsened below this level.",
           Patterns::Integer(0)},
          {"Maximal level",
           p.refinement.maximal_level,
           "No cell is refined above this level.",
           Patterns::Integer(0)},
          {"Cell budget",
           p.refinement.cell_budget,
           "Number of cells beyond which refinement only keeps pace with "
           "coarsening.",
           Patterns::Integer(1)},
          {"Memory budget",
           p.refinement.memory_budget,
           "Gigabytes that all ranks together may be expected to take, as "
           "--check does, good to a factor of 1.5; another bound on the number "
           "of cells. 0: none.",
           Patterns::Double(0.)}}}};
    }



    Sections
    sections_of_results(Parameters &p)
    {
      return {
        {"Output",
         {{"Directory",
           p.output.directory,
           "Where results go; empty for output/<name of the parameter file> in "
           "the working directory."},
          {"Fields every",
           p.output.fields_every,
           "Steps between outputs of fields; 0 writes only the first and the "
           "last state.",
           Patterns::Integer(0)},
          {"Fields interval",
           p.output.fields_interval,
           "Time between outputs of fields; where positive, it replaces the "
           "entry above. Unit: time.",
           Patterns::Double(0.)},
          {"Fields in HDF5",
           p.output.in_hdf5,
           "Write the fields of the body as HDF5, one file an output and one a "
           "mesh for all ranks together, for solution.xdmf; else as VTU, a "
           "file a rank with the mesh, as fields of faces are in any case."},
          {"Reference fields",
           p.output.reference_fields,
           "At the end of each phase of time, write the fields in all cells "
           "for coarser runs to be compared with, see `Exact "
           "solution/Reference directory'."},
          {"Revolved angle",
           p.output.revolved_angle,
           "Degrees by which the section of a body of revolution is turned "
           "about its axis for the fields on its surface in space, "
           "revolved.pvd: 360 is the whole body, 270 leaves a quarter open, "
           "where it shows the section. 0 for none.",
           Patterns::Double(0., 360.)},
          {"Points",
           p.output.points,
           "Points of the body, coordinates separated by commas and points by "
           "semicolons, whose displacement goes into statistics.csv; with a "
           "name if you like, as in `crown = 0, 2.5; floor = 0, -2.5'. Unit: "
           "length."},
          {"Point fields",
           p.output.point_fields,
           "What statistics.csv has of these points besides the displacement, "
           "separated by commas. The fields are those of the outputs (see "
           "`Additional fields', which need not have them), `history' of laws "
           "with history variables; a stress or strain is that of the cell of "
           "the point. From `slip' on they are fields of Gamma_3, which the "
           "points on it have."},
          {"Lines",
           p.output.lines,
           "Straight lines through the body as `begin : end : number of "
           "points', separated by semicolons, such as `0, 0 : 2, 0 : 101' or "
           "`wall = 0, 0 : 2, 0 : 101'. Each gets a file, line_0.csv and so "
           "on, with the displacement at equal distances. Unit: length."},
          {"Line fields",
           p.output.line_fields,
           "What these files have besides the displacement, as above."},
          {"Lines every step",
           p.output.lines_every_step,
           "Whether the files of lines have every step, not only those whose "
           "fields are written."},
          {"Integrals",
           p.output.integrals,
           "Integrals for statistics.csv, each as `boundary ID: fields', "
           "`material ID: fields' or `body: fields', separated by semicolons, "
           "fields by commas, such as `boundary 3: displacement, stress "
           "vector; material 2: stress, creep strain'. The undeformed area or "
           "volume is always there. Fields are those of `Point fields'; "
           "materials and the body also have `energies', the stored and the "
           "dissipated one; boundaries have `normal traction' and `stress "
           "vector' sigma nu, of the means of the cells behind them, whatever "
           "their role."},
          {"Additional fields",
           p.output.additional_fields,
           "What the outputs of fields have besides displacements and "
           "stresses, separated by commas. In the body, of cell means: the "
           "tensors `total strain' eps(u) and `irreversible strain' eps(u) - "
           "E^-1 sigma, less the thermal strain; the scalars `creep strain', "
           "the equivalent (2/3 e:e)^(1/2) of the deviator of what flow has "
           "added to the irreversible strain, and `creep rate', the same of "
           "-E^-1 G; `principal stresses', the largest first. On Gamma_3: "
           "`normal traction' sigma_nu, negative in compression; `friction "
           "work', what friction has dissipated per area since t = 0.",
           Patterns::List(Patterns::Selection(
             "total strain|irreversible strain|creep strain|creep "
             "rate|principal stresses|normal traction|friction work"))}}},

        {"Checkpoint",
         {{"Every n steps",
           p.checkpoint.every_n_steps,
           "Steps between checkpoints, from which --restart goes on after an "
           "interruption; 0 for none.",
           Patterns::Integer(0)},
          {"Wall time interval",
           p.checkpoint.wall_time_interval,
           "Time between checkpoints by the clock on the wall; they are "
           "written at the end of a step. 0 for none. Unit: seconds.",
           Patterns::Double(0.)},
          {"Wall time limit",
           p.checkpoint.wall_time_limit,
           "How long the run may take, counted from the start of the program. "
           "It ends in time for that with a checkpoint, the estimated error so "
           "far and exit code 3; --restart goes on. 0 for no limit. Unit: "
           "seconds.",
           Patterns::Double(0.)},
          {"Directory",
           p.checkpoint.directory,
           "Where checkpoints go; empty for `checkpoint' in the directory of "
           "the results."},
          {"Keep",
           p.checkpoint.keep,
           "How many of the last checkpoints are kept.",
           Patterns::Integer(1)}}},

        {"Study",
         {{"Levels",
           p.study.levels,
           "Runs of each ladder. Each level halves what the ladder refines: "
           "the mesh width, the time steps, or, where their error chooses "
           "these, `Step control/Tolerance' (with Heun's method it has a "
           "quarter).",
           Patterns::Integer(2, 12)},
          {"Ladders",
           p.study.ladders,
           "What is refined: the mesh alone, the time steps alone, or both; "
           "what a ladder leaves alone has the finest level.",
           Patterns::List(Patterns::Selection("space|time|both"), 1, 3)},
          {"Strategies",
           p.study.strategies,
           "Uniform refinement, adaptive refinement by the residual estimator "
           "with as many cells, or, of a scene with `Error control/Tolerance', "
           "runs to tolerances that halve down to this one. If empty, the last "
           "for scenes with a tolerance and the first for others. Where no "
           "exact solution is known, a scene with a tolerance has a run to "
           "half of it as reference, others one of the finest uniform mesh.",
           Patterns::List(
             Patterns::Selection("uniform|adaptive|tolerance"), 0, 3)},
          {"Time schemes",
           p.study.time_schemes,
           "Values of `Time/Scheme' to compare, separated by commas; that of "
           "the scene if empty."},
          {"Stress histories",
           p.study.stress_histories,
           "Values of `Material/Stress history' to compare, separated by "
           "commas; that of the scene if empty."},
          {"Target errors",
           p.study.target_errors,
           "Relative errors for which the price list names the cheapest run.",
           Patterns::List(Patterns::Double(1e-12, 1.), 1)},
          {"Budget",
           p.study.budget,
           "Studies and prices begin no run that is not expected to end within "
           "this time. Unit: seconds.",
           Patterns::Double(1.)}}}};
    }



    Entries
    entries_in(TableParameters &table)
    {
      return {
        {"File",
         table.file,
         "A CSV file, relative to the parameter file or to the working "
         "directory: names of the columns in the first line, the argument in "
         "the first column, ascending. Empty: there is no such table."},
        {"Interpolation",
         table.interpolation,
         "Between two rows: `linear', or `constant' with the value of the "
         "first of them."},
        {"Outside",
         table.outside,
         "Before the first row and after the last one: an error where a value "
         "is needed there, or the value of the nearest row."}};
    }
  } // namespace



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
  Parameters::declare_run()
  {
    declare_sections(handler, sections_of_solution(*this));
    declare_sections(handler, sections_of_results(*this));
    for (auto &[number, table] : tables)
      declare_section(handler,
                      "Table " + std::to_string(number),
                      entries_in(table));
  }
} // namespace Viscoplastic
