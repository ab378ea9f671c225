// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <viscoplastic_contact/parameters/choices.h>

#include <map>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  struct ContactLaw;
  struct FrictionLaw;
  struct LawDescription;

  // One struct for each subsection of the parameter file: defaults, the help
  // text of every entry (in declare()), and the checks that need no mesh.

  /// Names of units; all are empty if the scene declares none.
  struct UnitParameters
  {
    std::string length, time, stress, force;

    void
    declare(ParameterHandler &prm);
  };

  struct GeometryParameters
  {
    PlaneModel   plane_model = PlaneModel::strain;
    std::string  generator   = "subdivided_hyper_rectangle";
    std::string  arguments   = "8, 8 : 0, 0 : 1, 1 : true";
    std::string  file;
    std::string  boundary_ids, material_ids;
    std::string  coordinates;
    double       rotation_angle = 0.;
    std::string  rotation_axis  = "0, 0, 1";
    std::string  translation;
    unsigned int global_refinements = 0;
    std::string  boundary_refinements;
    double       flatness_tolerance = 1e-4;

    void
    declare(ParameterHandler &prm);
  };

  /// The entries of one material; those of its law are read by the law itself.
  struct MaterialParameters
  {
    std::string name;
    std::string youngs_modulus = "1";
    std::string poissons_ratio = "0.3";
    std::string voigt_matrix;
    std::string law = "elastic";
    /// The coefficient alpha of thermal expansion, per kelvin; empty for a
    /// material that does not expand.
    std::string thermal_expansion;
    /// The activation energy Q per mole, and the temperature at which the
    /// parameters of the law hold; empty if rates do not depend on temperature.
    std::string activation_energy, law_temperature;
    /// Times at which the material is added and removed; empty for the
    /// beginning and the end of the run.
    std::string added_at, removed_at;

    void
    declare(ParameterHandler &prm, const std::vector<LawDescription> &laws);
  };

  /// The discretization of stresses, the same for all materials.
  struct StressParameters
  {
    VolumetricIntegration volumetric_integration =
      VolumetricIntegration::automatic;
    StressHistory stress_history = StressHistory::quadrature_points;

    void
    declare(ParameterHandler &prm);
  };

  struct SupportParameters
  {
    std::string points, edges;

    void
    declare(ParameterHandler &prm);
  };

  struct LoadParameters
  {
    std::string body_force, axial_force, axial_strain;

    void
    declare(ParameterHandler &prm);
  };

  struct TemperatureParameters
  {
    /// T(x,t); empty if the scene has no temperature.
    std::string value, reference, gas_constant;

    void
    declare(ParameterHandler &prm);
  };

  struct InitialStateParameters
  {
    std::string displacement, stress;
    bool        equilibrate        = false;
    bool        reset_displacement = false;

    void
    declare(ParameterHandler &prm);
  };

  /// A known solution, to measure errors or to manufacture a problem.
  struct ExactSolutionParameters
  {
    std::string displacement, stress;
    DataSource  data = DataSource::scene;
    std::string reference_directory;

    void
    declare(ParameterHandler &prm);
  };

  struct BoundaryParameters
  {
    std::string  name;
    BoundaryRole role = BoundaryRole::not_given;
    std::string  displacement, traction, pressure;
    std::string  normal_stiffness, tangential_stiffness;
    /// Null if not given.
    const ContactLaw  *contact_law  = nullptr;
    const FrictionLaw *friction_law = nullptr;
    /// The values of the entries of contact laws and friction laws, by name.
    std::map<std::string, std::string> of_laws;
    std::string                        against, gap, foundation_normal;
    std::string                        slip_rate_factor = "1";
    std::string                        normal_stress;
    std::string                        foundation_displacement = "0";
    std::string                        foundation_motion;

    BoundaryParameters();

    void
    declare(ParameterHandler &prm);

    /// Declare the entries of the role contact.
    void
    declare_contact(ParameterHandler &prm);
  };

  struct TimeParameters
  {
    std::string     phases           = "1: 10";
    TimeScheme      scheme           = TimeScheme::automatic;
    StiffnessPolicy stiffness_policy = StiffnessPolicy::refuse;

    void
    declare(ParameterHandler &prm);
  };

  /// The entries for adaptive time steps.
  struct StepControlParameters
  {
    /// The tolerance for the error of a step; 0 for the steps of the phases.
    double          tolerance = 0.;
    std::string     landing_times;
    bool            land_on_kinks   = true;
    EventResolution resolve_events  = EventResolution::automatic;
    double          event_tolerance = 1e-3;
    double          largest_step = 0., smallest_step = 0.;

    bool
    is_on() const
    {
      return tolerance > 0.;
    }

    void
    declare(ParameterHandler &prm);
  };

  struct SolverParameters
  {
    LinearSolver linear_solver = LinearSolver::automatic;
    /// Relative tolerance; 0 couples it to the estimated discretization error.
    double          contact_tolerance  = 0.;
    unsigned int    maximal_iterations = 200;
    CoulombPressure coulomb_pressure   = CoulombPressure::newton;
    double          coulomb_tolerance  = 1e-6;
    bool            reuse_unchanged    = true;

    /// Return the contact tolerance for use without an error estimate.
    double
    strict_tolerance() const
    {
      return contact_tolerance > 0. ? contact_tolerance : 1e-8;
    }

    void
    declare(ParameterHandler &prm);
  };

  struct ErrorControlParameters
  {
    /// The tolerance for the error of the run relative to the solution; 0 if
    /// meshes and steps are given.
    double tolerance = 0.;
    /// The column of statistics.csv whose error is controlled; empty for the
    /// energy norm.
    std::string quantity;
    bool        error_estimator    = true;
    double      algebraic_fraction = 0.05;

    /// Return whether meshes and steps are chosen to meet a tolerance.
    bool
    has_tolerance() const
    {
      return tolerance > 0.;
    }

    void
    declare(ParameterHandler &prm);
  };

  /// The entries of refinement studies, which contrib/study reads.
  struct StudyParameters
  {
    unsigned int levels  = 4;
    std::string  ladders = "space, time, both";
    std::string  strategies;
    std::string  time_schemes;
    std::string  stress_histories;
    std::string  target_errors = "0.1, 0.03, 0.01, 0.003";
    double       budget        = 3600.;

    void
    declare(ParameterHandler &prm);
  };

  struct RefinementParameters
  {
    RefinementStrategy strategy            = RefinementStrategy::automatic;
    unsigned int       every_n_steps       = 1;
    double             refinement_fraction = 0.3;
    double             coarsening_fraction = 0.05;
    double             smallest_share      = 0.1;
    unsigned int       minimal_level       = 0;
    unsigned int       maximal_level       = 15;
    unsigned int       cell_budget         = 100000;
    double             memory_budget       = 0.; // GB; 0: no bound

    void
    declare(ParameterHandler &prm);

    void
    check() const;
  };

  struct CheckpointParameters
  {
    unsigned int every_n_steps      = 0;
    double       wall_time_interval = 0.;
    double       wall_time_limit    = 0.; // s; 0: none
    std::string  directory;
    unsigned int keep = 2;

    void
    declare(ParameterHandler &prm);
  };

  struct OutputParameters
  {
    std::string  directory;
    unsigned int fields_every     = 1;
    bool         reference_fields = false, in_hdf5 = false;
    double       fields_interval = 0.;
    double       revolved_angle  = 0.;
    std::string  points, lines, integrals;
    bool         lines_every_step = false;
    /// Fields at points and along lines, and optional fields of other output.
    std::set<RecordedField> point_fields, line_fields, additional_fields;

    void
    declare(ParameterHandler &prm);
  };
} // namespace Viscoplastic
