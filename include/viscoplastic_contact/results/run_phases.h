// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

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
    /// The column of study.csv; several phases may share one.
    std::string study_column;
    /// Whether a study counts its seconds as those of the run: neither fields
    /// nor the comparison with a solution are what a user would pay for.
    bool is_cost;
  };

  /// All phases, in the order in which they are printed and written. Tables
  /// and pictures take them from here, so that none can be forgotten in one.
  inline const std::vector<RunPhase> run_phases{
    {"pilot run",
     "pilot run",
     "of the tolerance: the size of the solution, the mesh of a quantity",
     false,
     "seconds_set_up",
     true},
    {"set-up",
     "set-up",
     "spaces, matrix, factorisation or multigrid",
     false,
     "seconds_set_up",
     true},
    {"rate",
     "viscosity",
     "flow of the law in all cells",
     true,
     "seconds_rate",
     true},
    {"tangent",
     "backward Euler",
     "matrices of the steps with their set-up",
     true,
     "seconds_tangent",
     true},
    {"load",
     "data",
     "loads, friction bounds, motion of foundations",
     true,
     "seconds_load",
     true},
    {"contact",
     "elasticity",
     "linear solves, as they would be without friction",
     true,
     "seconds_contact",
     true},
    {"balance",
     "balance",
     "energies, reactions, statistics.csv",
     true,
     "seconds_balance",
     true},
    {"estimate",
     "error estimate",
     "of the mesh, of steps and iterations",
     true,
     "seconds_estimate",
     true},
    {"adaptation",
     "adaptivity",
     "new meshes with their set-up",
     false,
     "seconds_set_up",
     true},
    {"output", "fields", "for ParaView", true, "seconds_output", false},
    {"errors",
     "comparison",
     "with an exact solution or a reference",
     false,
     "seconds_errors",
     false},
    {"checkpoint",
     "checkpoints",
     "to go on from",
     false,
     "seconds_checkpoint",
     true}};
} // namespace Viscoplastic
