// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/solver_choice.h>
#include <viscoplastic_contact/results/run_summary.h>
#include <viscoplastic_contact/scene/scene.h>

#include <map>
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

  /// Throws ExcMessage if results in directory @p path, with @p n_lines files
  /// of lines, would overwrite files that another program has written.
  void
  refuse_foreign_files(const std::string &path, const std::size_t n_lines);

  /// Remove files of lines beyond the first @p n_lines, which an earlier run
  /// has written.
  void
  remove_other_lines(const std::string &path, std::size_t n_lines);

  /// The costs of a run for run.json, which is read by studies.
  struct RunCosts
  {
    /// Wall time by phase, see run_phases; after a restart, since then.
    std::map<std::string, double> seconds;
    /// Seconds of the phase `contact' due to friction, see RunBill.
    double friction = 0.;
    /// Memory of all ranks together in MB: before the run, and the largest.
    double first_memory = 0., peak_memory = 0.;
    /// The sizes by which the solver on the last mesh was chosen.
    SolverDemand solver_demand;
  };

  /// Write parameters.prm and run.json, from which a run can be reproduced,
  /// with the errors of @p summary and with @p costs unless null, and with the
  /// remarks of the run. On one rank.
  template <int dim>
  void
  write_record(const Scene<dim>               &scene,
               const std::string              &path,
               const unsigned int              n_ranks,
               const RunSummary<dim>          *summary,
               const RunCosts                 *costs,
               const std::vector<std::string> &remarks = {});
} // namespace Viscoplastic
