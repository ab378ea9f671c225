// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/patterns.h>

#include <viscoplastic_contact/laws/contact_laws.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>
#include <viscoplastic_contact/parameters/parameters.h>

namespace Viscoplastic
{
  void
  UnitParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Length",
                      length,
                      "The unit of lengths: m, mm, km, ...; empty where no "
                      "units are declared.");
    prm.add_parameter("Time", time, "That of times: s, h, day, year, ...");
    prm.add_parameter("Stress",
                      stress,
                      "That of stresses: Pa, kPa, MPa, GPa, ...");
    prm.add_parameter("Force",
                      force,
                      "In the place of `Stress': the unit of forces, N, kN, "
                      "MN, ...; that of stresses is this one by the square of "
                      "the unit of lengths.");
  }



  void
  GeometryParameters::declare(ParameterHandler &prm)
  {
    add_choice(
      prm,
      "Plane model",
      plane_model,
      "What a mesh in 2D stands for. `strain': a slice of a long body, plane "
      "strain. `generalized strain': the same with a strain zz that is one for "
      "the whole section, given by `Loads/Axial strain' or the unknown that "
      "belongs to `Loads/Axial force'. `axisymmetric': the section of a body "
      "of revolution about the axis x = 0, with x = r >= 0 and y along the "
      "axis; stresses and strains zz are those around the axis then, forces, "
      "energies, areas and volumes those of the whole ring.");
    prm.add_parameter(
      "Generator",
      generator,
      "Name of a function of deal.II's namespace GridGenerator "
      "that makes the coarse mesh. Several, separated by `|', "
      "with as many `Arguments', make bodies of their own: the "
      "k-th, from 0, has boundary ids from 20 k on and the material "
      "id k.");
    prm.add_parameter("Arguments",
                      arguments,
                      "Its arguments as "
                      "GridGenerator::generate_from_name_and_arguments() reads "
                      "them: separated by colons, e.g. numbers of cells, lower "
                      "and upper corner, colorize. Coordinates and radii are "
                      "lengths. Unit: length.");
    prm.add_parameter("File",
                      file,
                      "A mesh file that replaces the generator, relative to "
                      "the parameter file that names it: of Gmsh (.msh, "
                      "version 2 or 4), AVS UCD (.ucd, .avs or .inp), VTK "
                      "(.vtk) or ABAQUS (.inp); empty for none.");
    prm.add_parameter("Boundary ids",
                      boundary_ids,
                      "The boundary id of each face of the coarse mesh as an "
                      "expression of its center x, y, (z) and of `id', what it "
                      "has from the file or the generator; empty to keep "
                      "these. An id must not change within a face. Unit: 1.");
    prm.add_parameter("Material ids",
                      material_ids,
                      "The material id of each cell of the coarse mesh, "
                      "likewise. Unit: 1.");
    prm.add_parameter("Coordinates",
                      coordinates,
                      "Where the nodes of the coarse mesh go: their new "
                      "coordinates as expressions of the present ones, "
                      "separated by semicolons, such as `x; y^2' for a mesh "
                      "that is graded towards y = 0; empty for none. Ids by "
                      "expressions are those of the place before. Not of "
                      "meshes with curved edges. Unit: length.");
    prm.add_parameter("Rotation angle",
                      rotation_angle,
                      "Rotation of the generated mesh about the origin, in "
                      "degrees; not of meshes with curved edges.");
    prm.add_parameter("Rotation axis",
                      rotation_axis,
                      "Axis of that rotation in 3D; in 2D it is always z.",
                      Patterns::List(Patterns::Double(), 3, 3));
    prm.add_parameter("Translation",
                      translation,
                      "Shift of the mesh after the rotation, one number a "
                      "direction; empty for none. Not of meshes with curved "
                      "edges, whose place is in `Arguments'. Unit: length.",
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
    prm.add_parameter("Name", name, "What a run calls the material.");
    prm.add_parameter("Young's modulus",
                      youngs_modulus,
                      "E > 0 as an expression of position; taken at the center "
                      "of each cell. Unit: stress.");
    prm.add_parameter("Poisson's ratio",
                      poissons_ratio,
                      "nu in (-1, 1/2) as an expression of position; taken at "
                      "the center of each cell. Unit: 1.");
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
                      "stress rate. The entries of a law are expressions of "
                      "position and t. " +
                        viscoplastic_law_help(laws),
                      Patterns::Selection(viscoplastic_law_names(laws)));
    declare_viscoplastic_law_parameters(prm, laws);
    prm.add_parameter("Thermal expansion",
                      thermal_expansion,
                      "alpha as an expression of position, taken at the center "
                      "of each cell: the material expands by alpha (T - T_0) "
                      "in all directions, with `Temperature/Value' and "
                      "`Temperature/Reference temperature'; empty for none. "
                      "Unit: 1/temperature.");
    prm.add_parameter("Activation energy",
                      activation_energy,
                      "Q >= 0: the rate G of the law is multiplied by "
                      "exp(-Q/R (1/T - 1/T_L)) (Arrhenius) with the absolute "
                      "temperature T; empty for a law that does not depend on "
                      "it by itself. Unit: energy/mol.");
    prm.add_parameter("Law temperature",
                      law_temperature,
                      "T_L, the temperature for which the entries of the law "
                      "hold; `infinite' for a factor exp(-Q/(R T)), as laws of "
                      "creep are often written. Empty: `Temperature/Reference "
                      "temperature'. Unit: temperature.");
    prm.add_parameter("Added at",
                      added_at,
                      "When this part of the body is added, free of stress in "
                      "the place that its surroundings have moved to: the end "
                      "of a phase of `Time/Phases'. Empty for a material that "
                      "is there from the beginning. Unit: time.");
    prm.add_parameter("Removed at",
                      removed_at,
                      "When this part of the body is removed, as by "
                      "excavation: the end of a phase of `Time/Phases'. What "
                      "is left moves by what it had carried. Empty for a "
                      "material that stays. Unit: time.");
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
      "Where the irreversible stress z lives. `quadrature points' keeps z at "
      "each quadrature point. `cell means' is the paper's piecewise constant "
      "stress, which is cheaper, but on coarse meshes too stiff by factors in "
      "long creep.");
  }



  void
  SupportParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Points",
                      points,
                      "Nodes that are held, as `coordinates: components' "
                      "separated by semicolons, such as `0, 0: x y; 2, 0: y', "
                      "which holds the rigid motions of a plane body: these "
                      "components of u are zero. They have to be vertices of "
                      "the coarse mesh. Unit: length.");
    prm.add_parameter("Edges",
                      edges,
                      "The same where boundaries meet, by their ids, such as "
                      "`1, 3: y; 1, 4: y z'.");
  }



  void
  LoadParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Body force",
                      body_force,
                      "b(x,t). Unit: force per volume.");
    prm.add_parameter("Axial force",
                      axial_force,
                      "N(t), the integral of the stress zz over the section in "
                      "the plane model `generalized strain', whose strain zz "
                      "follows; empty for 0. Unit: force.");
    prm.add_parameter("Axial strain",
                      axial_strain,
                      "In the place of `Axial force': the strain zz as a "
                      "function of t. Unit: 1.");
  }



  void
  TemperatureParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Value",
                      value,
                      "T(x,t); empty where temperature plays no role. "
                      "Expressions of laws know it as the variable T. Unit: "
                      "temperature.");
    prm.add_parameter("Reference temperature",
                      reference,
                      "T_0, at which the body has no thermal strain; what "
                      "alpha (T - T_0) does at t = 0 adds to the initial "
                      "stress. Empty: that of each place at t = 0. Unit: "
                      "temperature.");
    prm.add_parameter("Gas constant",
                      gas_constant,
                      "R of `Material/Activation energy'. Empty: 8.314462618 "
                      "J/(mol K), in the SI where no units are declared. Unit: "
                      "energy/(mol temperature).");
  }



  void
  InitialStateParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Displacement", displacement, "u0(x). Unit: length.");
    prm.add_parameter("Stress",
                      stress,
                      "sigma0(x) as xx; yy; zz; xy in 2D and "
                      "xx; yy; zz; xy; xz; yz in 3D; empty for zero. Unit: "
                      "stress.");
    prm.add_parameter("Equilibrate",
                      equilibrate,
                      "Whether to put the body into equilibrium with the loads "
                      "at t = 0 by an elastic step with friction, instead of "
                      "refusing initial data that are out of balance by more "
                      "than 1e-6 of the loads. Its displacement counts in all "
                      "displacements, unless `Reset displacement' is set.");
    prm.add_parameter("Reset displacement",
                      reset_displacement,
                      "Whether displacements and total strains are reported "
                      "from the initial state on, as where ground has settled "
                      "long ago.");
  }



  void
  ExactSolutionParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Displacement",
                      displacement,
                      "u(x,t), if it is known: the run reports its errors. "
                      "Unit: length.");
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
    prm.add_parameter("Name",
                      name,
                      "What a run and entries such as `Error control/Quantity' "
                      "call the piece, as in `roof'; by default `boundary' and "
                      "its id, or the name of its physical group in a mesh "
                      "file of Gmsh.");
    add_choice(
      prm,
      "Role",
      role,
      "`clamped': u = 0; `displacement': given components of u; `traction': "
      "sigma nu = F - p nu, also with springs; `free': sigma nu = 0; "
      "`symmetry': u_nu = 0 without "
      "friction on a flat piece; `contact': a piece of Gamma_3 with a "
      "friction law.");
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
                      "the body where it is positive. F = -p nu on the faces "
                      "of the mesh. Unit: stress.");
    prm.add_parameter(
      "Normal stiffness",
      normal_stiffness,
      "k_n(x) >= 0 of springs between the piece and the ground, beside "
      "traction and pressure and for the same roles: sigma nu = F - p nu - k_n "
      "u_nu nu - k_t u_tau. Ground that moves by d adds k d to the traction. "
      "Unit: stress/length.");
    prm.add_parameter("Tangential stiffness",
                      tangential_stiffness,
                      "k_t(x) >= 0 of these springs along the piece. Unit: "
                      "stress/length.");
    declare_contact(prm);
  }



  namespace
  {
    template <typename Law>
    void
    add_law(ParameterHandler       &prm,
            const std::string      &entry,
            const Law             *&chosen,
            const std::vector<Law> &laws,
            const std::string      &where,
            const std::string      &default_law)
    {
      std::string help;
      for (const Law &law : laws)
        help += (help.empty() ? " `" : "; `") + law.name + "': " + law.help;
      prm.declare_entry(entry,
                        "not given",
                        Patterns::Selection(names_of(laws)),
                        "For the role contact, what acts " + where + ':' +
                          help + '.' + default_law);
      prm.add_action(entry, [&chosen, &laws](const std::string &name) {
        chosen = find_named(laws, name);
      });
    }



    template <typename Law>
    void
    add_entries(ParameterHandler                   &prm,
                const std::vector<Law>             &laws,
                std::map<std::string, std::string> &values)
    {
      for (const LawEntry &entry : entries_of(laws))
        if (entry.is_number())
          prm.add_parameter(entry.name,
                            values.at(entry.name),
                            entry.help,
                            Patterns::Double(entry.least));
        else
          prm.add_parameter(entry.name, values.at(entry.name), entry.help);
    }
  } // namespace



  BoundaryParameters::BoundaryParameters()
  {
    for (const auto &entries :
         {entries_of(contact_laws()), entries_of(friction_laws())})
      for (const LawEntry &entry : entries)
        of_laws[entry.name] = entry.default_value;
  }



  void
  BoundaryParameters::declare_contact(ParameterHandler &prm)
  {
    add_law(prm,
            "Contact law",
            contact_law,
            contact_laws(),
            "along the normal",
            " Where it is not given, it is that of the paper for the friction "
            "law: given normal stress for coulomb, otherwise bilateral.");
    prm.add_parameter("Against",
                      against,
                      "For the role contact: the boundary of another body, by "
                      "its name or number, that takes the place of the rigid "
                      "foundation; it has the role free or traction. "
                      "Displacements are then relative to it, and the initial "
                      "distance is added to the gap. Give it to the side with "
                      "the finer mesh, or to the smaller one. Empty for a "
                      "rigid foundation.");
    prm.add_parameter("Gap",
                      gap,
                      "g(x,t) of unilateral contact and normal compliance: how "
                      "far the undeformed "
                      "body is from the foundation, measured along "
                      "`Foundation normal'. Unit: length.");
    prm.add_parameter(
      "Foundation normal",
      foundation_normal,
      "For unilateral contact and normal compliance: the "
      "direction from the body into the foundation, components separated by "
      "commas. "
      "Where it is empty, it is the outward normal of the piece, which "
      "has to be flat unless another body is opposite.",
      Patterns::List(Patterns::Double()));
    add_entries(prm, contact_laws(), of_laws);
    add_law(
      prm, "Friction law", friction_law, friction_laws(), "along the face", "");
    add_entries(prm, friction_laws(), of_laws);
    prm.add_parameter("Slip rate factor",
                      slip_rate_factor,
                      "f(v) >= 0, by which the friction bound of tresca and "
                      "coulomb is multiplied: an expression of the slip rate v "
                      "(length over time) of the step before, such "
                      "as `0.6 + 0.4*exp(-v/0.01)'. At t = 0, v is zero. Unit: "
                      "1.");
    prm.add_parameter("Normal stress",
                      normal_stress,
                      "S(x,t) of given normal stress, negative in "
                      "compression. Unit: stress.");
    prm.add_parameter("Foundation displacement",
                      foundation_displacement,
                      "d(x,t) of bilateral contact: u_nu = d, nu pointing out "
                      "of the body, so that d < 0 presses. In unilateral "
                      "contact and normal compliance it is added to the gap. "
                      "Unit: length.");
    prm.add_parameter("Foundation motion",
                      foundation_motion,
                      "w(x,t): how far the foundation has moved along its "
                      "face since t = 0, e.g. `20*t; 0' for a conveyor. Slip "
                      "is relative to it; its normal part does not count. "
                      "Empty for a foundation at rest. Unit: length.");
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
               "`forward Euler': G at the beginning of the step, first order, "
               "stable for steps up to 2/r with the relaxation rate r. "
               "`backward Euler': G at its end, first order, stable for all "
               "steps, which cost more where G is not linear. `Heun': the mean "
               "of G at the beginning and at what forward Euler predicts for "
               "the end, second order, stable up to 2/r, twice the price.");
    add_choice(prm,
               "Stiffness policy",
               stiffness_policy,
               "What becomes of a step of an explicit scheme beyond its "
               "stability limit 2/r. `refuse' ends the run; `subdivide' "
               "divides the step; `backward Euler' takes it by that scheme.");
  }
} // namespace Viscoplastic
