// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/phases.h>
#include <viscoplastic_contact/study/study_cost.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /**
   * What is known of the errors and costs of a scene, as functions of the mesh
   * width h and the longest time step k. Where step control chooses the steps,
   * k is its tolerance instead, which the time part of the error is a power of.
   */
  struct WorkPrecisionModel
  {
    TwoPowers    error; // of h and k
    CostModel    cost;
    unsigned int dim = 2;
    /// Of the scene as it is: mesh level 0 and its own steps.
    double                  h = 1., k = 1., dofs = 1.;
    std::vector<StepsUntil> phases;
    /// With step control: how many steps there are, as a function of 1/k, and
    /// the order of the scheme: steps half as long take k/2^order.
    std::optional<TwoPowers> chosen_steps;
    unsigned int             order = 1;
    /// How many levels the mesh may be coarsened.
    int coarsest_level = 0;
    /// The longest step that was measured, or the limit of stability.
    double largest_k = std::numeric_limits<double>::infinity();
    /// How often a run of so many steps is set up, once for each of its meshes,
    /// where so many are those of its phases.
    std::function<double(double, unsigned int)> n_set_ups =
      [](double, unsigned int) { return 1.; };
    /// The smallest h and k that have been measured, to tell extrapolations.
    double smallest_h = 0., smallest_k = 0.;

    double
    dofs_at(const double h) const;

    /// How many times as many steps as those of the scene k stands for.
    double
    refinement_of_steps(const double k) const;

    /// About how many steps there are, before whole numbers for each phase.
    double
    steps_at(const double k) const;

    double
    seconds(const double h, const double k) const;
  };


  /// A run that could be made, and what it is expected to give and to cost.
  struct PredictedRun
  {
    int                     mesh_level = 0;
    std::vector<StepsUntil> phases;
    /// As in WorkPrecisionModel.
    double         h = 0., k = 0.;
    unsigned int   steps = 0;
    double         dofs = 0., error = 0., seconds = 0., memory = 0.;
    BulkSolverKind solver = BulkSolverKind::direct;
    /// Whether h or k is below half of the smallest one that was measured.
    bool is_far = false;
  };


  /// The run on mesh level @p mesh_level with steps of at most @p k, or to
  /// that tolerance of them.
  PredictedRun
  predict(const WorkPrecisionModel &model,
          const int                 mesh_level,
          const double              k);

  /**
   * The cheapest run with an error of at most @p tolerance. Mesh widths halve
   * from level to level, steps are whole in every phase. Nothing if no mesh
   * level up to 12 is fine enough or the model has no samples.
   */
  std::optional<PredictedRun>
  cheapest(const WorkPrecisionModel &model, const double tolerance);

  /// The run of the smallest error within @p seconds, if any.
  std::optional<PredictedRun>
  most_accurate(const WorkPrecisionModel &model, const double seconds);

  /// Seconds for an error of exactly @p tolerance if h and k could have any
  /// value: a smooth curve below those of all runs.
  double
  ideal_seconds(const WorkPrecisionModel &model, const double tolerance);


  /// What a tolerance costs.
  struct Price
  {
    double tolerance;
    /// The cheapest run; absent if no mesh is fine enough.
    std::optional<PredictedRun> run;
    bool                        is_in_budget = false;
    /// By which factor the ideal seconds grow for half of the error.
    double halving = std::numeric_limits<double>::quiet_NaN();
  };

  std::vector<Price>
  list_prices(const WorkPrecisionModel  &model,
              const std::vector<double> &tolerances,
              const double               budget);

  /// One price as a sentence.
  std::string
  in_words(const WorkPrecisionModel &model,
           const Price              &price,
           const double              budget);

  /// What halving h, k, or both does to the scene as it is, in sentences.
  std::string
  next_refinement(const WorkPrecisionModel &model);

  /// Seconds for people, small ones with two digits.
  std::string
  seconds_in_words(const double seconds);

  /// A number with @p n significant digits, as in 0.0123 or 1.2e-5; large ones
  /// with all digits before the point.
  std::string
  digits(const double value, const unsigned int n = 3);
} // namespace Viscoplastic
