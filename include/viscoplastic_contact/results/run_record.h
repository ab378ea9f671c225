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
  /// `Output/Directory', or what it is by default; ends with a slash.
  std::string
  results_directory(const Parameters &parameters);

  /// Make it. Throws ExcMessage.
  void
  make_results_directory(const std::string &path);

  /// Throws ExcMessage if the results in directory @p path, with @p n_lines
  /// files of lines, would overwrite what somebody else keeps under their
  /// names.
  void
  refuse_foreign_files(const std::string &path, const std::size_t n_lines);

  /// Remove the files of lines that an earlier run has left behind the first
  /// @p n_lines.
  void
  remove_other_lines(const std::string &path, std::size_t n_lines);

  /// The costs of a run in run.json, which studies read.
  struct RunCosts
  {
    /// Wall time by phase, see run_phases; of a resumed run, of its last part.
    std::map<std::string, double> seconds;
    /// Seconds of the phase `contact' that friction takes, see RunBill.
    double friction = 0.;
    /// Memory of all ranks together in MB: before the run, and the largest.
    double first_memory = 0., peak_memory = 0.;
    /// The sizes from which the solver of the last mesh was chosen.
    SolverDemand solver_demand;
  };

  /// Write what is needed to reproduce a run: parameters.prm and run.json, with
  /// the errors of @p summary and with @p costs unless these are null, and with
  /// the sentences that the run had for the user. On one rank.
  template <int dim>
  void
  write_record(const Scene<dim>               &scene,
               const std::string              &path,
               const unsigned int              n_ranks,
               const RunSummary<dim>          *summary,
               const RunCosts                 *costs,
               const std::vector<std::string> &remarks = {});
} // namespace Viscoplastic
