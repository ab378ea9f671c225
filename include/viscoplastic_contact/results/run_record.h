// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/solver_choice.h>
#include <viscoplastic_contact/results/run_summary.h>
#include <viscoplastic_contact/scene/scene.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// `Output/Directory' or its default; ends with a slash.
  std::string
  results_directory(const Parameters &parameters);

  /// Make the directory of results. Throws ExcMessage.
  void
  make_results_directory(const std::string &path);

  /// What run.json has of the end of a run: results, and costs for studies.
  template <int dim>
  struct RunEnd
  {
    const RunSummary<dim> &summary;
    const RunBill          bill;
    /// Memory of all ranks together in MB: before the run, and the largest.
    double first_memory, peak_memory;
    /// The sizes by which the solver on the last mesh was chosen.
    SolverDemand             solver_demand;
    std::vector<std::string> remarks;
  };



  /// Write parameters.prm and run.json, from which a run can be reproduced.
  /// @p end is null before that. On one rank.
  template <int dim>
  void
  write_record(const Scene<dim>  &scene,
               const std::string &path,
               const unsigned int n_ranks,
               const RunEnd<dim> *end);
} // namespace Viscoplastic
