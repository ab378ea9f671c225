// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/patterns.h>

#include <viscoplastic_contact/laws/viscoplastic_law.h>
#include <viscoplastic_contact/parameters/parameters.h>

namespace Viscoplastic
{
  void
  GeometryParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Generator",
                      generator,
                      "Name of a function of deal.II's namespace GridGenerator "
                      "that makes the coarse mesh.");
    prm.add_parameter("Arguments",
                      arguments,
                      "Its arguments as "
                      "GridGenerator::generate_from_name_and_arguments() reads "
                      "them: separated by colons, e.g. numbers of cells, lower "
                      "and upper corner, colorize.");
    prm.add_parameter("File",
                      file,
                      "A mesh file that replaces the generator, relative to "
                      "the parameter file that names it; empty for none.");
    prm.add_parameter("File format",
                      file_format,
                      "Format of that file: Gmsh (.msh 2 and 4), AVS UCD, VTK "
                      "or ABAQUS (.inp); `automatic' decides by the file's "
                      "name and first line.",
                      Patterns::Selection("automatic|msh|ucd|vtk|abaqus"));
    prm.add_parameter("Boundary ids",
                      boundary_ids,
                      "The boundary id of each face of the coarse mesh as an "
                      "expression of its centre x, y, (z) and of `id', what it "
                      "has from the file or the generator; empty to keep "
                      "these. An id must not change within a face.");
    prm.add_parameter("Material ids",
                      material_ids,
                      "The material id of each cell of the coarse mesh, "
                      "likewise.");
    prm.add_parameter("Rotation angle",
                      rotation_angle,
                      "Rotation of the generated mesh about the origin, in "
                      "degrees.");
    prm.add_parameter("Rotation axis",
                      rotation_axis,
                      "Axis of that rotation in 3D; in 2D it is always z.",
                      Patterns::List(Patterns::Double(), 3, 3));
    prm.add_parameter("Translation",
                      translation,
                      "Shift of the mesh after the rotation, one number a "
                      "direction; empty for none. Unit: length.",
                      Patterns::List(Patterns::Double()));
    prm.add_parameter("Global refinements",
                      global_refinements,
                      "How often every cell is halved in each direction.",
                      Patterns::Integer(0));
    prm.add_parameter("Boundary refinements",
                      boundary_refinements,
                      "Further refinements of the cells at boundaries, as "
                      "`boundary id: times' separated by commas, e.g. `2: 3, "
                      "4: 1'; empty for none.");
    prm.add_parameter("Flatness tolerance",
                      flatness_tolerance,
                      "How many degrees the normals of a contact or symmetry "
                      "piece may deviate from their mean.",
                      Patterns::Double(0., 10.));
  }



  void
  MaterialParameters::declare(ParameterHandler                  &prm,
                              const std::vector<LawDescription> &laws)
  {
    prm.add_parameter("Young's modulus",
                      youngs_modulus,
                      "E > 0 as an expression of position; taken at the centre "
                      "of each cell. Unit: stress.");
    prm.add_parameter("Poisson's ratio",
                      poissons_ratio,
                      "nu in (-1, 1/2) as an expression of position; taken at "
                      "the centre of each cell.");
    prm.add_parameter("Voigt matrix",
                      voigt_matrix,
                      "Anisotropic elasticity, in place of Young's modulus "
                      "and Poisson's ratio: the symmetric positive definite "
                      "matrix of E in Voigt's order xx, yy, zz, yz, xz, xy "
                      "with engineering shear strains; six rows separated by "
                      "semicolons, numbers by commas. Unit: stress. Empty for "
                      "isotropic bodies.");
    prm.add_parameter("Law",
                      law,
                      "The function G of (1.1), the viscous part of the "
                      "stress rate. " +
                        viscoplastic_law_help(laws),
                      Patterns::Selection(viscoplastic_law_names(laws)));
    declare_viscoplastic_law_parameters(prm, laws);
  }



  void
  StressParameters::declare(ParameterHandler &prm)
  {
    add_choice(
      prm,
      "Volumetric integration",
      volumetric_integration,
      "`full' integrates the elastic form fully; `mean dilatation' takes the "
      "mean of the volumetric strain over each cell, which prevents "
      "volumetric locking; `automatic' chooses it for laws whose flow is "
      "deviatoric and for nu > 0.4.");
    add_choice(
      prm,
      "Stress history",
      stress_history,
      "Where the irreversible stress z lives. `cell means' is the paper's "
      "piecewise constant stress; `quadrature points' keeps z at each "
      "quadrature point, which long creep on coarse meshes needs.");
  }



  void
  LoadParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Body force",
                      body_force,
                      "b(x,t), components separated by semicolons; empty for "
                      "none. Unit: force per volume.");
  }



  void
  InitialStateParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Displacement",
                      displacement,
                      "u0(x), components separated by semicolons; empty for "
                      "zero. Unit: length.");
    prm.add_parameter("Stress",
                      stress,
                      "sigma0(x) as xx; yy; zz; xy in 2D and "
                      "xx; yy; zz; xy; xz; yz in 3D; empty for zero. Unit: "
                      "stress.");
    prm.add_parameter("Equilibrate",
                      equilibrate,
                      "Whether to put the body into equilibrium with the loads "
                      "at t = 0 by an elastic step with friction, instead of "
                      "refusing initial data that violate (2.12).");
    prm.add_parameter("Compatibility tolerance",
                      compatibility_tolerance,
                      "Violation of (2.12), relative to the loads, up to which "
                      "initial data are accepted.",
                      Patterns::Double(0.));
  }



  void
  ExactSolutionParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Displacement",
                      displacement,
                      "u(x,t), components separated by semicolons, if it is "
                      "known: the run reports its errors. Unit: length.");
    prm.add_parameter("Stress",
                      stress,
                      "sigma(x,t): xx; yy; zz; xy in 2D, xx; yy; zz; xy; xz; "
                      "yz in 3D. Unit: stress.");
    add_choice(
      prm,
      "Data",
      data,
      "`scene': u and sigma solve the problem of the scene. `solution': a "
      "manufactured solution; body force, tractions, normal stresses, "
      "prescribed displacements and initial data follow from u and sigma, "
      "which also add the source sigma' - E eps(u') - G to G. Materials, "
      "friction bounds and coefficients remain those of the scene.");
    prm.add_parameter("Reference directory",
                      reference_directory,
                      "Results of a finer run of the same scene with `Output/"
                      "Reference fields': the run reports its differences from "
                      "them at the ends of the phases of time, in the place "
                      "of errors.");
  }



  void
  BoundaryParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Role",
      role,
      "`clamped': u = 0; `displacement': given components of u; `traction': "
      "sigma nu = F - p nu; `free': sigma nu = 0; `symmetry': u_nu = 0 without "
      "friction on a flat piece; `contact': a flat piece of Gamma_3 with a "
      "friction law.",
      Patterns::Selection("not given|clamped|displacement|traction|free|"
                          "symmetry|contact"));
    prm.add_parameter("Displacement",
                      displacement,
                      "For the role displacement: components as expressions of "
                      "position and t separated by semicolons; the word `free' "
                      "leaves a component free. Unit: length.");
    prm.add_parameter("Traction",
                      traction,
                      "For the role traction, and for the role displacement "
                      "in its free components: F(x,t), components separated "
                      "by semicolons. Unit: stress.");
    prm.add_parameter("Pressure",
                      pressure,
                      "As Traction, and added to it: p(x,t), which presses on "
                      "the body where it is positive. It acts along the normal "
                      "of the faces as they are in the mesh: F = -p nu. Unit: "
                      "stress.");
    prm.add_parameter(
      "Friction law",
      friction_law,
      "For the role contact: `tresca' is bilateral contact with a given "
      "friction bound (5.22); `coulomb' has a given normal stress and the "
      "bound mu |S| (5.6); `none' is bilateral contact without friction; "
      "`glued' holds the body fast to the foundation.",
      Patterns::Selection("not given|none|tresca|coulomb|glued"));
    prm.add_parameter("Friction bound",
                      friction_bound,
                      "g(x,t) >= 0 of the law tresca. Unit: stress.");
    prm.add_parameter("Friction coefficient",
                      friction_coefficient,
                      "mu(x,t) >= 0 of the law coulomb, a pure number.");
    prm.add_parameter("Normal stress",
                      normal_stress,
                      "S(x,t) of the law coulomb, negative in compression. "
                      "Unit: stress.");
    prm.add_parameter("Foundation displacement",
                      foundation_displacement,
                      "d(x,t) of bilateral contact: u_nu = d, nu pointing out "
                      "of the body, so that d < 0 presses. Unit: length.");
    prm.add_parameter("Foundation motion",
                      foundation_motion,
                      "w(x,t), components separated by semicolons: how far the "
                      "foundation has moved along its face since t = 0, e.g. "
                      "`20*t; 0' for a conveyor. Slip is relative to it; its "
                      "normal part does not count. Empty for a foundation at "
                      "rest. Unit: length.");
  }



  void
  TimeParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Phases",
                      phases,
                      "Phases of equal time steps as `end time: number of "
                      "steps', separated by commas, starting at t = 0; a "
                      "phase begins where the one before it ends. Unit: time.");
    add_choice(prm,
               "Scheme",
               scheme,
               "How z' = G is integrated. `automatic': as the paper does, by "
               "forward Euler; in runs to `Error control/Tolerance' by Heun's "
               "method, and beyond its stability limit by backward Euler. "
               "`forward Euler': G at the "
               "beginning of the step, the scheme of the paper, first "
               "order, stable for steps up to 2/r with the relaxation "
               "rate r. `backward Euler': G at the end of the step, "
               "first order, stable for all steps; steps cost more "
               "where G is not linear. `Heun': the mean of G at the "
               "beginning and at what forward Euler predicts for the "
               "end, second order, stable up to 2/r, twice the price of "
               "forward Euler.");
    add_choice(prm,
               "Stiffness policy",
               stiffness_policy,
               "What becomes of a step of an explicit scheme beyond its "
               "stability limit 2/r. `refuse' ends the run with a "
               "sentence; `subdivide' divides the step into equal ones "
               "within the limit; `backward Euler' takes it by that "
               "scheme.");
  }



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
      "Whether steps chosen by their error end where data have "
      "kinks in time (`min', `abs', `if', ...), and just before "
      "and after jumps. These times are looked for at the "
      "beginning and named.");
    add_choice(prm,
               "Resolve events",
               resolve_events,
               "Whether steps in which slip begins somewhere, comes to cover "
               "all of the face, ends everywhere or turns back are divided "
               "until they are as short as `Event tolerance' says. "
               "`automatic': they are, but for runs to `Error control/"
               "Tolerance', whose steps need not be shorter than their errors "
               "ask for.");
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
                      "so that jumps of the data do not end a run, and a step "
                      "that fails is not divided further; 0 for 1e-6 of the "
                      "length of the phase. Unit: time.",
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
      "to the solution, at which the active set and linear iterations stop. "
      "0: `Error control/Algebraic fraction' of the estimated discretisation "
      "error.",
      Patterns::Double(0., 0.1));
    prm.add_parameter("Maximal contact iterations",
                      maximal_iterations,
                      "The run ends with an error when a step needs more.",
                      Patterns::Integer(1));
    prm.add_parameter("Reuse unchanged",
                      reuse_unchanged,
                      "Keep what a step does not change instead of computing "
                      "it again: the solution where neither loads, prescribed "
                      "displacements, bounds and foundations nor the "
                      "irreversible stress have changed, with its forces, "
                      "rates and estimates. Nothing is neglected.");
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
    prm.add_parameter("Quantity",
                      quantity,
                      "A column of statistics.csv whose error is estimated by "
                      "duality, too: the work of friction, or a component of "
                      "the friction force, of the reaction of a boundary, or "
                      "of the displacement of one of `Output/Points', as in "
                      "`friction_dissipation', `friction_force_x', "
                      "`reaction_1_y', `point0_x'. `Tolerance' is that of this "
                      "quantity then, relative to its largest value, and "
                      "meshes are refined where it feels their errors. "
                      "Empty: the energy norm.");
    prm.add_parameter("Error bar",
                      error_estimator,
                      "Estimate the error of every step in the energy norm: "
                      "of the mesh, of the time steps, of the iterations and "
                      "of the initial data.");
    prm.add_parameter("Algebraic fraction",
                      algebraic_fraction,
                      "Where `Solver/Contact tolerance' is 0: the iterations "
                      "of a step stop when the bound on their error is this "
                      "fraction of the estimated discretisation error.",
                      Patterns::Double(1e-6, 0.5));
    prm.add_parameter("Two-level comparison",
                      two_level_comparison,
                      "Run the scene also with twice the mesh width and twice "
                      "the time steps, and give each quantity of interest "
                      "with the uncertainty that follows.");
  }



  void
  StudyParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Levels",
                      levels,
                      "Runs of each ladder. Each level halves what the ladder "
                      "refines.",
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
    prm.add_parameter("Budget",
                      budget,
                      "The study begins no run that is not expected to end "
                      "within this time, and --price no run that is expected "
                      "to take longer. Unit: seconds.",
                      Patterns::Double(1.));
  }



  void
  RefinementParameters::declare(ParameterHandler &prm)
  {
    add_choice(prm,
               "Strategy",
               strategy,
               "`none' keeps the mesh; `residual' refines by the "
               "residual estimator of the friction inequality, `kelly' "
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
                      "coarsening would not remove a tenth of all cells. A new "
                      "mesh would lower the estimate by less than about half "
                      "this fraction. With 0 it always changes.",
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
    AssertThrow(minimal_level <= maximal_level,
                ExcMessage("'Mesh refinement/Minimal level' = " +
                           std::to_string(minimal_level) +
                           " must not exceed 'Maximal level' = " +
                           std::to_string(maximal_level) + "."));
    AssertThrow(refinement_fraction + coarsening_fraction <= 1.,
                ExcMessage("'Mesh refinement/Refinement fraction' and "
                           "'Coarsening fraction' must add up to at most 1."));
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
      "Reference fields",
      reference_fields,
      "At the end of each phase of time, write the fields in "
      "all cells for coarser runs to be compared with, see `Exact solution/Reference directory'.");
    prm.add_parameter("Points",
                      points,
                      "Points of the body, coordinates separated by commas and "
                      "points by semicolons, whose displacement goes into "
                      "statistics.csv. Unit: length.");
    add_choices(
      prm,
      "Additional fields",
      additional_fields,
      "What the outputs of fields have besides displacements and stresses, "
      "separated by commas. In the body, of cell means: `total strain' eps(u); "
      "`irreversible strain' eps(u) - E^-1 sigma; `creep strain', what flow "
      "has added to that, as the equivalent (2/3 e:e)^(1/2) of its deviator; "
      "`creep rate', the same of -E^-1 G; `principal stresses', the largest "
      "first. On Gamma_3: `normal traction' sigma_nu, negative in compression; "
      "`friction work', what friction has dissipated per area since t = 0.");
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
                      "the program. It ends after the last step beyond which "
                      "another, as long as that one, would pass the limit: "
                      "with a checkpoint, the estimated error so far, and "
                      "exit code 3; --restart goes on. 0 for no limit. Unit: "
                      "seconds.",
                      Patterns::Double(0.));
    prm.add_parameter("Directory",
                      directory,
                      "Where checkpoints go; empty for `checkpoint' in the "
                      "directory of the results.");
    prm.add_parameter("Keep",
                      keep,
                      "How many of the last checkpoints are kept. The older "
                      "ones are for the case that the last one is damaged.",
                      Patterns::Integer(1));
  }
} // namespace Viscoplastic
