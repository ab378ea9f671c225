// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/solver_choice.h>

#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  /// Stands for a number that is not known.
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();


  /// How the mesh of a run comes about: it is refined everywhere, or where the
  /// error estimator says, with given numbers of cells and steps or with as
  /// many as a tolerance needs.
  enum class MeshStrategy
  {
    uniform,
    adaptive,
    tolerance
  };

  /// As `Study/Strategies' and the files of a study have it.
  std::string
  to_string(const MeshStrategy strategy);

  /// The inverse. Throws ExcMessage for any other text.
  MeshStrategy
  to_mesh_strategy(const std::string &name);


  /// How a run is computed, whatever its mesh width and its time steps.
  struct MethodVariant
  {
    MeshStrategy strategy = MeshStrategy::uniform;
    /// Values of `Time/Scheme' and `Material/Stress history'.
    std::string scheme, history;

    /// The order of the scheme in k.
    unsigned int
    order() const;

    /// All three as text.
    std::string
    name() const
    {
      return to_string(strategy) + ", " + scheme + ", " + history;
    }

    bool
    operator==(const MethodVariant &other) const
    {
      return strategy == other.strategy && scheme == other.scheme &&
             history == other.history;
    }
  };


  /// Which run of a study.
  struct RunKey
  {
    MethodVariant variant;
    /// Halvings of h and k from those of the scene, or both those of its
    /// tolerance; negative: doublings. Where step control chooses the steps,
    /// its tolerance halves k.
    int mesh_level = 0, time_level = 0;
    /// Whether it only tells what it costs, and is compared with nothing.
    bool is_timing = false;

    bool
    operator==(const RunKey &other) const
    {
      return variant == other.variant && mesh_level == other.mesh_level &&
             time_level == other.time_level && is_timing == other.is_timing;
    }
  };


  /// A table with a header line, as Statistics writes it.
  struct Table
  {
    std::vector<std::string>                   names;
    std::map<std::string, std::vector<double>> columns;

    bool
    has(const std::string &name) const
    {
      return columns.count(name) > 0;
    }
  };

  /// The table in @p file. Throws ExcMessage if there is none.
  Table
  read_table(const std::string &file);


  /// What a run tells beside its table.
  struct RunMeasurements
  {
    /// Wall time by phase, see ViscoplasticContact::seconds().
    std::map<std::string, double> seconds;
    /// Of all ranks in MB: the largest, and that before the run, with what
    /// earlier runs of the process have left.
    double peak_memory = 0., first_memory = 0.;
    /// That of the last mesh.
    SolverDemand solver_demand;
  };


  /// A finished run in numbers.
  struct RunRecord
  {
    RunKey      key;
    std::string name;
    /// What identifies the scene and the program, by name: a record with
    /// another stamp belongs to something else.
    std::map<std::string, std::string> stamp;
    /// Sizes, costs and errors, by the name of their column in study.csv.
    std::map<std::string, double> numbers;
    /// What decides on the linear solver, with the mean number of unknowns.
    SolverDemand solver_demand;
    /// Quantities of interest at the end, by name, in the order of the table.
    std::vector<std::pair<std::string, double>> quantities;

    /// The number of this name; not a number if there is none.
    double
    number(const std::string &column) const;

    /// What the time part of the error is a power of: the longest step, or,
    /// where step control chooses them, the tolerance of the steps.
    double
    step_measure() const;

    /// The quantity of interest of this name; not a number if there is none.
    double
    quantity(const std::string &column) const;
  };


  /**
   * The numbers of a finished run. Errors are relative: the largest of all
   * steps over the largest norm of the exact solution; estimates are relative
   * to the largest energy norm. With @p is_difference errors are differences to
   * another run, at few times: then the largest norms of the run itself count,
   * too. The estimated error of a @p quantity of interest, if there is one, is
   * relative to its largest value. Numbers of unknowns and cells are means over
   * the steps.
   */
  RunRecord
  make_record(const RunKey          &key,
              const Table           &statistics,
              const RunMeasurements &measurements,
              const bool             is_difference = false,
              const std::string     &quantity      = "");


  /// The columns of errors of fields, relative to the largest norms.
  extern const std::vector<std::string> field_errors;

  /// The columns of the estimated error and its parts.
  extern const std::vector<std::string> estimate_parts;


  /// The text of result.json.
  std::string
  to_json(const RunRecord &record);

  /// The record in the @p text of @p file. Throws ExcMessage with a sentence
  /// that names the file if that is something else, or damaged.
  RunRecord
  from_json(const std::string &text, const std::string &file);
} // namespace Viscoplastic
