// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/effect_result.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// Changes by so many errors are changes.
    constexpr double clear = 2.;



    /// An error that is not known may be anything.
    double
    bound(const double error)
    {
      return std::isfinite(error) ? error :
                                    std::numeric_limits<double>::infinity();
    }
  } // namespace



  std::string
  to_string(const EffectVerdict verdict)
  {
    switch (verdict)
      {
        case EffectVerdict::called_for:
          return "called for";
        case EffectVerdict::below_the_error:
          return "below the error of this discretization";
        case EffectVerdict::as_large_as_the_error:
          return "as large as the error of this discretization";
        case EffectVerdict::never_acted:
          return "never acted";
        case EffectVerdict::only_watches:
          return "only watches";
        case EffectVerdict::cannot_be_left_out:
          break;
      }
    return "cannot be left out";
  }



  double
  EffectResult::change_of(const std::string &quantity) const
  {
    for (const QuantityChange &change : changes)
      if (change.quantity == quantity)
        return change.change;
    return not_a_number;
  }



  void
  judge(EffectResult &result, const double smallest)
  {
    bool   acts = false, is_above = false, is_clear = false;
    double largest_ratio = -1.;
    for (const QuantityChange &quantity : result.changes)
      {
        const double error = bound(quantity.error);
        acts |= quantity.change > smallest;
        is_above |= quantity.change > std::max(error, smallest);
        is_clear |= quantity.change > clear * error + smallest;
        const double ratio = quantity.change / (error + smallest);
        if (ratio > largest_ratio)
          {
            largest_ratio   = ratio;
            result.decisive = quantity;
          }
      }
    const bool watches = result.variant.kind == EffectKind::observation;
    // Iterations that end a little earlier or later are no other answer.
    result.verdict = watches && !is_above ? EffectVerdict::only_watches :
                     !acts                ? EffectVerdict::never_acted :
                     is_clear             ? EffectVerdict::called_for :
                     is_above ? EffectVerdict::as_large_as_the_error :
                                EffectVerdict::below_the_error;
  }



  bool
  EffectInteraction::is_clear() const
  {
    // Four runs, each with its error.
    return largest.change > 2. * clear * bound(largest.error);
  }



  double
  error_of_iterations(const Table &run, const Table &other)
  {
    double result = 0.;
    for (const Table *table : {&run, &other})
      if (table->has("algebraic_error"))
        for (const double value : table->columns.at("algebraic_error"))
          result = std::max(result, std::isfinite(value) ? value : 0.);
    // It is one in energy, quantities may have larger ones. Linear iterations
    // are as exact as the lower limit; more than the upper one is a change,
    // even if iterations that ended early may explain it.
    return std::clamp(10. * result, 1e-8, 1e-4);
  }
} // namespace Viscoplastic
