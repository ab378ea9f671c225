// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <map>
#include <string>

namespace Viscoplastic
{
  using namespace dealii;

  // One struct for each subsection of the parameter file: defaults, the help
  // text of every entry (in declare()), and the checks that need no mesh.

  struct GeometryParameters
  {
    std::string  generator      = "subdivided_hyper_rectangle";
    std::string  arguments      = "8, 8 : 0, 0 : 1, 1 : true";
    double       rotation_angle = 0.;
    std::string  rotation_axis  = "0, 0, 1";
    std::string  translation;
    unsigned int global_refinements = 0;

    void
    declare(ParameterHandler &prm);
  };

  struct MaterialParameters
  {
    std::string youngs_modulus         = "1";
    std::string poissons_ratio         = "0.3";
    std::string law                    = "elastic";
    std::string volumetric_integration = "automatic";
    std::string stress_history         = "cell means";

    void
    declare(ParameterHandler &prm);
  };

  struct LoadParameters
  {
    std::string body_force;

    void
    declare(ParameterHandler &prm);
  };

  struct InitialStateParameters
  {
    std::string displacement, stress;
    bool        equilibrate             = false;
    double      compatibility_tolerance = 1e-6;

    void
    declare(ParameterHandler &prm);
  };

  struct BoundaryParameters
  {
    std::string role = "not given";
    std::string displacement, traction;
    std::string friction_law            = "none";
    std::string friction_bound          = "0";
    std::string friction_coefficient    = "0";
    std::string normal_stress           = "0";
    std::string foundation_displacement = "0";

    void
    declare(ParameterHandler &prm);
  };

  struct TimeParameters
  {
    std::string phases = "1: 10";

    void
    declare(ParameterHandler &prm);
  };

  struct SolverParameters
  {
    std::string  linear_solver      = "automatic";
    double       contact_tolerance  = 1e-8;
    unsigned int maximal_iterations = 200;

    void
    declare(ParameterHandler &prm);
  };

  struct RefinementParameters
  {
    std::string  strategy            = "none";
    unsigned int every_n_steps       = 1;
    double       refinement_fraction = 0.3;
    double       coarsening_fraction = 0.05;
    unsigned int minimal_level       = 0;
    unsigned int maximal_level       = 6;
    unsigned int cell_budget         = 100000;

    void
    declare(ParameterHandler &prm);

    void
    check() const;
  };

  struct OutputParameters
  {
    std::string  directory;
    unsigned int fields_every    = 1;
    double       fields_interval = 0.;
    std::string  points;

    void
    declare(ParameterHandler &prm);
  };


  /**
   * A parameter file, read and checked as far as that is possible without a
   * mesh. Expressions stay texts here: their number of components depends on
   * the dimension, so Scene<dim> parses them.
   */
  class Parameters
  {
  public:
    /**
     * Read @p file. Subsections `Boundary <id>` are declared for the ids that
     * the file names. Throws ExcMessage or an exception of ParameterHandler.
     */
    explicit Parameters(const std::string &file);

    /// The structs below are bound to entries of the handler.
    Parameters(const Parameters &) = delete;
    Parameters &
    operator=(const Parameters &) = delete;

    const std::string                          file;
    unsigned int                               dimension = 2;
    GeometryParameters                         geometry;
    MaterialParameters                         material;
    LoadParameters                             loads;
    InitialStateParameters                     initial_state;
    std::map<unsigned int, BoundaryParameters> boundaries;
    TimeParameters                             time;
    SolverParameters                           solver;
    RefinementParameters                       refinement;
    OutputParameters                           output;

    /// The same with every entry, for law parameters and for the record.
    mutable ParameterHandler handler;

  private:
    void
    declare();

    /// The ids of `subsection Boundary <id>' in a file and in those that it
    /// includes decide what is declared.
    void
    find_boundaries(const std::string &name, const unsigned int depth);
  };
} // namespace Viscoplastic
