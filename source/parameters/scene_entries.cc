// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/parameters/entry.h>
#include <viscoplastic_contact/parameters/parameter_file.h>

namespace Viscoplastic
{
  namespace
  {
    Sections
    sections_of_body(Parameters &p)
    {
      return {
        {"Units",
         {{"Length",
           p.unit_names.length,
           "The unit of lengths: m, mm, km, ...; empty where no units are "
           "declared."},
          {"Time", p.unit_names.time, "That of times: s, h, day, year, ..."},
          {"Stress",
           p.unit_names.stress,
           "That of stresses: Pa, kPa, MPa, GPa, ..."},
          {"Force",
           p.unit_names.force,
           "In the place of `Stress': the unit of forces, N, kN, MN, ...; that "
           "of stresses is this one by the square of the unit of lengths."}}},

        {"Geometry",
         {{"Plane model",
           p.geometry.plane_model,
           "What a mesh in 2D stands for. `strain': a slice of a long body, "
           "plane strain. `generalized strain': the same with a strain zz that "
           "is one for the whole section, given by `Loads/Axial strain' or the "
           "unknown that belongs to `Loads/Axial force'. `axisymmetric': the "
           "section of a body of revolution about the axis x = 0, with x = r "
           ">= 0 and y along the axis; stresses and strains zz are those "
           "around the axis then, forces, energies, areas and volumes those of "
           "the whole ring."},
          {"Generator",
           p.geometry.generator,
           "Name of a function of deal.II's namespace GridGenerator that makes "
           "the coarse mesh. Several, separated by `|', with as many "
           "`Arguments', make bodies of their own: the k-th, from 0, has "
           "boundary ids from 20 k on and the material id k."},
          {"Arguments",
           p.geometry.arguments,
           "Its arguments as GridGenerator::generate_from_name_and_arguments() "
           "reads them: separated by colons, e.g. numbers of cells, lower and "
           "upper corner, colorize. Coordinates and radii are lengths. Unit: "
           "length."},
          {"File",
           p.geometry.file,
           "A mesh file that replaces the generator, relative to the parameter "
           "file that names it: of Gmsh (.msh, version 2 or 4), AVS UCD (.ucd, "
           ".avs or .inp), VTK (.vtk) or ABAQUS (.inp); empty for none."},
          {"Boundary ids",
           p.geometry.boundary_ids,
           "The boundary id of each face of the coarse mesh as an expression "
           "of its center x, y, (z) and of `id', what it has from the file or "
           "the generator; empty to keep these. An id must not change within a "
           "face. Unit: 1."},
          {"Material ids",
           p.geometry.material_ids,
           "The material id of each cell of the coarse mesh, likewise. Unit: "
           "1."},
          {"Coordinates",
           p.geometry.coordinates,
           "Where the nodes of the coarse mesh go: their new coordinates as "
           "expressions of the present ones, separated by semicolons, such as "
           "`x; y^2' for a mesh that is graded towards y = 0; empty for none. "
           "Ids by expressions are those of the place before. Not of meshes "
           "with curved edges. Unit: length."},
          {"Rotation angle",
           p.geometry.rotation_angle,
           "Rotation of the generated mesh about the origin, in degrees; not "
           "of meshes with curved edges."},
          {"Rotation axis",
           p.geometry.rotation_axis,
           "Axis of that rotation in 3D; in 2D it is always z.",
           Patterns::List(Patterns::Double(), 3, 3)},
          {"Translation",
           p.geometry.translation,
           "Shift of the mesh after the rotation, one number a direction; "
           "empty for none. Not of meshes with curved edges, whose place is in "
           "`Arguments'. Unit: length.",
           Patterns::List(Patterns::Double())},
          {"Global refinements",
           p.geometry.global_refinements,
           "How often every cell is halved in each direction.",
           Patterns::Integer(0)},
          {"Boundary refinements",
           p.geometry.boundary_refinements,
           "Further refinements of the cells at boundaries, as `boundary id: "
           "times' separated by commas, e.g. `2: 3, 4: 1'; empty for none."},
          {"Flatness tolerance",
           p.geometry.flatness_tolerance,
           "How many degrees the normals of a contact or symmetry piece may "
           "deviate from their mean.",
           Patterns::Double(0., 10.)}}}};
    }



    Sections
    sections_of_loads(Parameters &p)
    {
      return {
        {"Material",
         {{"Volumetric integration",
           p.stress.volumetric_integration,
           "`full' integrates the elastic form fully; `mean dilatation' takes "
           "the mean of the volumetric strain over each cell, which prevents "
           "volumetric locking; `automatic' chooses it for laws whose flow is "
           "deviatoric and for nu > 0.4."},
          {"Stress history",
           p.stress.stress_history,
           "Where the irreversible stress z lives. `quadrature points' keeps z "
           "at each quadrature point. `cell means' is the paper's piecewise "
           "constant stress, which is cheaper, but on coarse meshes too stiff "
           "by factors in long creep."}}},

        {"Loads",
         {{"Body force", p.loads.body_force, "b(x,t). Unit: force per volume."},
          {"Axial force",
           p.loads.axial_force,
           "N(t), the integral of the stress zz over the section in the plane "
           "model `generalized strain', whose strain zz follows; empty for 0. "
           "Unit: force."},
          {"Axial strain",
           p.loads.axial_strain,
           "In the place of `Axial force': the strain zz as a function of t. "
           "Unit: 1."}}},

        {"Temperature",
         {{"Value",
           p.temperature.value,
           "T(x,t); empty where temperature plays no role. Expressions of laws "
           "know it as the variable T. Unit: temperature."},
          {"Reference temperature",
           p.temperature.reference,
           "T_0, at which the body has no thermal strain; what alpha (T - T_0) "
           "does at t = 0 adds to the initial stress. Empty: that of each "
           "place at t = 0. Unit: temperature."},
          {"Gas constant",
           p.temperature.gas_constant,
           "R of `Material/Activation energy'. Empty: 8.314462618 J/(mol K), "
           "in the SI where no units are declared. Unit: energy/(mol "
           "temperature)."}}},

        {"Initial state",
         {{"Displacement",
           p.initial_state.displacement,
           "u0(x). Unit: length."},
          {"Stress",
           p.initial_state.stress,
           "sigma0(x) as xx; yy; zz; xy in 2D and xx; yy; zz; xy; xz; yz in "
           "3D; empty for zero. Unit: stress."},
          {"Equilibrate",
           p.initial_state.equilibrate,
           "Whether to put the body into equilibrium with the loads at t = 0 "
           "by an elastic step with friction, instead of refusing initial data "
           "that are out of balance by more than 1e-6 of the loads. Its "
           "displacement counts in all displacements, unless `Reset "
           "displacement' is set."},
          {"Reset displacement",
           p.initial_state.reset_displacement,
           "Whether displacements and total strains are reported from the "
           "initial state on, as where ground has settled long ago."}}},

        {"Exact solution",
         {{"Displacement",
           p.exact_solution.displacement,
           "u(x,t), if it is known: the run reports its errors. Unit: length."},
          {"Stress",
           p.exact_solution.stress,
           "sigma(x,t): xx; yy; zz; xy in 2D, xx; yy; zz; xy; xz; yz in 3D. "
           "Unit: stress."},
          {"Data",
           p.exact_solution.data,
           "`scene': u and sigma solve the problem of the scene. `solution': a "
           "manufactured solution; body force, tractions, normal stresses, "
           "prescribed displacements and initial data follow from u and sigma, "
           "which also add the source sigma' - E eps(u') - G to G. Materials, "
           "friction bounds and coefficients remain those of the scene."},
          {"Reference directory",
           p.exact_solution.reference_directory,
           "Results of a finer run of the same scene with `Output/Reference "
           "fields': the run reports its differences from them at the ends of "
           "the phases of time, in the place of errors."}}}};
    }



    Sections
    sections_of_supports_and_time(Parameters &p)
    {
      return {
        {"Supports",
         {{"Points",
           p.supports.points,
           "Nodes that are held, as `coordinates: components' separated by "
           "semicolons, such as `0, 0: x y; 2, 0: y', which holds the rigid "
           "motions of a plane body: these components of u are zero. They have "
           "to be vertices of the coarse mesh. Unit: length."},
          {"Edges",
           p.supports.edges,
           "The same where boundaries meet, by their ids, such as `1, 3: y; 1, "
           "4: y z'."}}},

        {"Time",
         {{"Phases",
           p.time.phases,
           "Phases of equal time steps as `end time: number of steps', "
           "separated by commas, starting at t = 0; a phase begins where the "
           "one before it ends. Unit: time."},
          {"Scheme",
           p.time.scheme,
           "How z' = G is integrated. `automatic': as the paper does, by "
           "forward Euler; in runs to `Error control/Tolerance' by Heun's "
           "method, and beyond its stability limit by backward Euler. `forward "
           "Euler': G at the beginning of the step, first order, stable for "
           "steps up to 2/r with the relaxation rate r. `backward Euler': G at "
           "its end, first order, stable for all steps, which cost more where "
           "G is not linear. `Heun': the mean of G at the beginning and at "
           "what forward Euler predicts for the end, second order, stable up "
           "to 2/r, twice the price."},
          {"Stiffness policy",
           p.time.stiffness_policy,
           "What becomes of a step of an explicit scheme beyond its stability "
           "limit 2/r. `refuse' ends the run; `subdivide' divides the step; "
           "`backward Euler' takes it by that scheme."}}}};
    }



    Entries
    entries_in(BoundaryParameters &boundary)
    {
      Entries result{
        {"Name",
         boundary.name,
         "What a run and entries such as `Error control/Quantity' call the "
         "piece, as in `roof'; by default `boundary' and its id, or the name "
         "of its physical group in a mesh file of Gmsh."},
        {"Role",
         boundary.role,
         "`clamped': u = 0; `displacement': given components of u; `traction': "
         "sigma nu = F - p nu, also with springs; `free': sigma nu = 0; "
         "`symmetry': u_nu = 0 without friction on a flat piece; `contact': a "
         "piece of Gamma_3 with a friction law."}};
      for (const BoundaryEntry &entry : boundary_entries())
        result.push_back({entry.name,
                          boundary.entries.at(entry.name),
                          entry.help,
                          *entry.pattern});
      return result;
    }
  } // namespace



  Entries
  entries_in(MaterialParameters                &material,
             const std::vector<LawDescription> &laws)
  {
    return {{"Name", material.name, "What a run calls the material."},
            {"Young's modulus",
             material.youngs_modulus,
             "E > 0 as an expression of position; taken at the center of each "
             "cell. Unit: stress."},
            {"Poisson's ratio",
             material.poissons_ratio,
             "nu in (-1, 1/2) as an expression of position; taken at the "
             "center of each cell. Unit: 1."},
            {"Voigt matrix",
             material.voigt_matrix,
             "Anisotropic elasticity, in place of Young's modulus and "
             "Poisson's ratio: the symmetric positive definite matrix of E in "
             "Voigt's order xx, yy, zz, yz, xz, xy with engineering shear "
             "strains; six rows separated by semicolons, numbers by commas. "
             "Unit: stress. Empty for isotropic bodies."},
            {"Law",
             material.law,
             "The function G of (1.1), the viscous part of the stress rate. "
             "The entries of a law are expressions of position and t. " +
               viscoplastic_law_help(laws),
             Patterns::Selection(viscoplastic_law_names(laws))},
            Entry([&laws](ParameterHandler &prm) {
              declare_viscoplastic_law_parameters(prm, laws);
            }),
            {"Thermal expansion",
             material.thermal_expansion,
             "alpha as an expression of position, taken at the center of each "
             "cell: the material expands by alpha (T - T_0) in all directions, "
             "with `Temperature/Value' and `Temperature/Reference "
             "temperature'; empty for none. Unit: 1/temperature."},
            {"Activation energy",
             material.activation_energy,
             "Q >= 0: the rate G of the law is multiplied by exp(-Q/R (1/T - "
             "1/T_L)) (Arrhenius) with the absolute temperature T; empty for a "
             "law that does not depend on it by itself. Unit: energy/mol."},
            {"Law temperature",
             material.law_temperature,
             "T_L, the temperature for which the entries of the law hold; "
             "`infinite' for a factor exp(-Q/(R T)), as laws of creep are "
             "often written. Empty: `Temperature/Reference temperature'. Unit: "
             "temperature."},
            {"Added at",
             material.added_at,
             "When this part of the body is added, free of stress in the place "
             "that its surroundings have moved to: the end of a phase of "
             "`Time/Phases'. Empty for a material that is there from the "
             "beginning. Unit: time."},
            {"Removed at",
             material.removed_at,
             "When this part of the body is removed, as by excavation: the end "
             "of a phase of `Time/Phases'. What is left moves by what it had "
             "carried. Empty for a material that stays. Unit: time."}};
  }



  void
  Parameters::declare_scene()
  {
    handler.add_parameter("Dimension",
                          dimension,
                          "2 (plane strain, or a body of revolution) or 3.",
                          Patterns::Integer(2, 3));
    handler.declare_entry(
      "Additional shared libraries",
      "",
      Patterns::Anything(),
      "Files with laws that are not part of the program, separated by commas; "
      "relative to the parameter file, or to the working directory.");
    declare_sections(handler, sections_of_body(*this));
    declare_section(handler, "Material", entries_in(material, laws));
    for (auto &[id, numbered] : materials)
      declare_section(handler,
                      "Material " + std::to_string(id),
                      entries_in(numbered, laws));
    declare_sections(handler, sections_of_loads(*this));
    for (auto &[id, boundary] : boundaries)
      declare_section(handler,
                      "Boundary " + std::to_string(id),
                      entries_in(boundary));
    declare_sections(handler, sections_of_supports_and_time(*this));
  }
} // namespace Viscoplastic
