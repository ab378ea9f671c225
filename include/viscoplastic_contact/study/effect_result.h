// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/effect_variants.h>
#include <viscoplastic_contact/study/quantity_histories.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// What an effect is worth to the answer.
  enum class EffectVerdict
  {
    /// Some quantity changes by more than twice its error.
    called_for,
    /// Nothing changes by more than its error.
    below_the_error,
    /// In between, on the finest discretization there was time for.
    as_large_as_the_error,
    /// Nothing changes but for the error of the iterations.
    never_acted,
    /// What should change nothing changes nothing by more than its error.
    only_watches,
    /// The scene cannot be computed without it.
    cannot_be_left_out
  };

  std::string
  to_string(const EffectVerdict verdict);


  /// What a run takes, and how much of that is chance: the difference between
  /// two runs of the same scene.
  struct RunCost
  {
    double seconds = 0., seconds_chance = 0.;
    /// MB beyond those that the process had before, see RunMeasurements.
    double memory = 0., memory_chance = 0.;
  };


  /// What the scene is without one effect, on one discretization.
  struct EffectResult
  {
    EffectVariant variant;
    EffectVerdict verdict = EffectVerdict::cannot_be_left_out;
    /// Of the discretization, 0 is that of the scene, see RunKey.
    int    level = 0;
    double cells = 0.;
    /// The changes of all quantities, in the order of the scene's table, and
    /// last that of the displacements in the energy norm.
    std::vector<QuantityChange> changes;
    /// The one that is the largest in proportion to its error.
    QuantityChange decisive;
    RunCost        with, without;
    /// Why it could not be computed.
    std::string failure;

    bool
    is_open() const
    {
      return verdict == EffectVerdict::below_the_error ||
             verdict == EffectVerdict::as_large_as_the_error;
    }

    /// The change of the quantity of this name, not a number if there is none.
    double
    change_of(const std::string &quantity) const;
  };

  /// Find verdict and decisive change of a result whose changes are known. No
  /// change is one that is not larger than @p smallest.
  void
  judge(EffectResult &result, const double smallest);


  /// Two effects left out at once.
  struct EffectInteraction
  {
    /// Each by itself and both at once, on the same discretization.
    EffectResult first, second, joint;
    /// By how much leaving out the second changes another quantity than it does
    /// where the first is left out already: the largest in proportion to its
    /// error.
    QuantityChange largest;

    /// Whether that is more than the error explains.
    bool
    is_clear() const;
  };


  /// Up to where the error of the iterations of both runs explains a change:
  /// ten times its largest bound, but not more than 1e-4.
  double
  error_of_iterations(const Table &run, const Table &other);
} // namespace Viscoplastic
