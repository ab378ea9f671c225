// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/study_cost.h>

#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// One phase of `Time/Phases': its end as the scene gives it, and its steps.
  struct StepsUntil
  {
    std::string  end;
    unsigned int n_steps;
  };

  /// Of a text that TimeSchedule accepts.
  std::vector<StepsUntil>
  read_phases(const std::string &phases);

  /// Every phase with @p factor times its steps, rounded up.
  std::vector<StepsUntil>
  scale_phases(std::vector<StepsUntil> phases, const double factor);

  /// As `Time/Phases'.
  std::string
  write_phases(const std::vector<StepsUntil> &phases);

  unsigned int
  n_steps(const std::vector<StepsUntil> &phases);


  /// What is known of the costs and errors of a scene.
  struct Market
  {
    TwoPowers    error; // of h and k
    CostModel    cost;
    unsigned int dim = 2;
    /// Of the scene as it is: mesh level 0 and its own steps.
    double                  h = 1., k = 1., dofs = 1.;
    std::vector<StepsUntil> phases;
    /// How many levels the mesh may be coarsened.
    int coarsest_level = 0;
    /// What was measured, or the limit of stability.
    double largest_k = std::numeric_limits<double>::infinity();
    /// Steps between new meshes; 0 for a mesh that stays.
    double steps_per_mesh = 0.;
    /// The ranges of h and k that have been measured, to tell extrapolations.
    double smallest_h = 0., smallest_k = 0.;

    double
    dofs_at(const double h) const;

    double
    seconds(const double h, const double steps) const;
  };


  /// A run that can be ordered, and what it is expected to give.
  struct Offer
  {
    int                     mesh_level = 0;
    std::vector<StepsUntil> phases;
    double                  h = 0., k = 0.;
    unsigned int            steps = 0;
    double                  dofs = 0., error = 0., seconds = 0., memory = 0.;
    /// Whether h or k is below half of the smallest one that was measured.
    bool is_far = false;
  };


  /// A run on mesh level @p mesh_level with steps of at most @p k.
  Offer
  offer(const Market &market, const int mesh_level, const double k);

  /**
   * The cheapest run with an error of at most @p tolerance. Mesh widths halve
   * from level to level, steps are whole in every phase. Nothing if no mesh
   * level up to 12 is fine enough or the model has no samples.
   */
  std::optional<Offer>
  cheapest(const Market &market, const double tolerance);

  /// The run of the smallest error within @p seconds, if any.
  std::optional<Offer>
  most_accurate(const Market &market, const double seconds);

  /// Seconds for an error of exactly @p tolerance if h and k could have any
  /// value: the smooth curve below all offers.
  double
  ideal_seconds(const Market &market, const double tolerance);


  /// What a tolerance costs.
  struct Price
  {
    double tolerance;
    /// Absent if no mesh is fine enough.
    std::optional<Offer> offer;
    bool                 is_in_budget = false;
    /// Factor of seconds for half of the error, on the ideal curve.
    double halving = std::numeric_limits<double>::quiet_NaN();
  };

  std::vector<Price>
  list_prices(const Market              &market,
              const std::vector<double> &tolerances,
              const double               budget);

  /// One price as a sentence.
  std::string
  in_words(const Market &market, const Price &price, const double budget);

  /// What halving h, k, or both does to the scene as it is, in sentences.
  std::string
  next_refinement(const Market &market);

  /// Seconds for people, small ones with two digits.
  std::string
  seconds_in_words(const double seconds);

  /// Three significant digits, as in 0.0123 or 1.2e-5.
  std::string
  digits(const double value, const unsigned int n = 3);
} // namespace Viscoplastic
