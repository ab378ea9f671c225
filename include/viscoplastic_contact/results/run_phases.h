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
} // namespace Viscoplastic
