// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/parameter_file.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A scene with one of its effects left out or simplified.
  struct EffectVariant
  {
    /// For files: letters, digits and `_'.
    std::string name;
    /// The effect, and what stands in its place, in words.
    std::string effect, instead;
    /// The entries that make it so, `Section/Entry=value'.
    std::vector<std::string> overrides;
    /// Whether it belongs to the problem and not to its discretization.
    bool is_physical = true;
  };

  /**
   * The simplifications that a scene allows, in the order of its sections: flow
   * and each part of a law, anisotropy, differences between materials,
   * friction (none, or so much that nothing slips), motion of the foundation,
   * each load, the initial state; then the choices of the discretization.
   *
   * @p typical_stress: a von Mises stress at which a power law and a linear one
   * are to flow at the same rate.
   */
  std::vector<EffectVariant>
  effect_variants(const Parameters &scene, const double typical_stress);

  /// Two simplifications at once.
  EffectVariant
  both(const EffectVariant &first, const EffectVariant &second);
} // namespace Viscoplastic
