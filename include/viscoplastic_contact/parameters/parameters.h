// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <viscoplastic_contact/parameters/choices.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  struct Entry;
  struct LawDescription;

  // A struct for each subsection of the parameter file, with the defaults of
  // its entries; names and help texts are in the .cc files.

  /// Names of units; all are empty if the scene declares none.
  struct UnitParameters
  {
    std::string length, time, stress, force;
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
  };

  /// The entries of a material, with a subsection for each of the @p laws.
  std::vector<Entry>
  entries_in(MaterialParameters                &material,
             const std::vector<LawDescription> &laws);

  /// The discretization of stresses, the same for all materials.
  struct StressParameters
  {
    VolumetricIntegration volumetric_integration =
      VolumetricIntegration::automatic;
    StressHistory stress_history = StressHistory::quadrature_points;
  };

  struct SupportParameters
  {
    std::string points, edges;
  };

  struct LoadParameters
  {
    std::string body_force, axial_force, axial_strain;
  };

  struct TemperatureParameters
  {
    /// T(x,t); empty if the scene has no temperature.
    std::string value, reference, gas_constant;
  };

  struct InitialStateParameters
  {
    std::string displacement, stress;
    bool        equilibrate        = false;
    bool        reset_displacement = false;
  };

  /// A known solution, to measure errors or to manufacture a problem.
  struct ExactSolutionParameters
  {
    std::string displacement, stress;
    DataSource  data = DataSource::scene;
    std::string reference_directory;
  };

  /// An entry of a boundary besides name and role.
  struct BoundaryEntry
  {
    std::string                                  name, help, default_value = {};
    std::shared_ptr<const Patterns::PatternBase> pattern =
      std::make_shared<Patterns::Anything>();
  };

  /// All of them, those of contact laws and friction laws included.
  const std::vector<BoundaryEntry> &
  boundary_entries();

  struct BoundaryParameters
  {
    std::string  name;
    BoundaryRole role = BoundaryRole::not_given;
    /// The texts of boundary_entries() by their names.
    std::map<std::string, std::string> entries;

    BoundaryParameters();
  };

  /// A table whose columns expressions may call; without a file there is none.
  struct TableParameters
  {
    std::string              file;
    DataTable::Interpolation interpolation = DataTable::Interpolation::linear;
    DataTable::Outside       outside       = DataTable::Outside::refuse;
  };

  struct TimeParameters
  {
    std::string     phases           = "1: 10";
    TimeScheme      scheme           = TimeScheme::automatic;
    StiffnessPolicy stiffness_policy = StiffnessPolicy::refuse;
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
    check() const;
  };

  struct CheckpointParameters
  {
    unsigned int every_n_steps      = 0;
    double       wall_time_interval = 0.;
    double       wall_time_limit    = 0.; // s; 0: none
    std::string  directory;
    unsigned int keep = 2;
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
  };
} // namespace Viscoplastic
