// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/laws/stiffness.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/run/scene_as_json.h>
#include <viscoplastic_contact/run/scene_data.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// What an effect belongs to.
  enum class EffectKind
  {
    /// The problem that is solved.
    problem,
    /// How it is discretized.
    discretization,
    /// What only watches the run: it should change no answer.
    observation
  };


  /// A scene with one of its effects left out or simplified.
  struct EffectVariant
  {
    /// The effect, and what stands in its place, in words.
    std::string effect, instead;
    /// The entries that make it so, `Section/Entry=value'.
    std::vector<std::string> overrides;
    EffectKind               kind = EffectKind::problem;
    /// Whether its run is the one that writes fields and checkpoints, which
    /// other runs of studies go without.
    bool has_outputs = false;
    /// Whether it is what drives the scene.
    bool is_load = false;

    /// For directories: letters, digits and `_'.
    std::string
    name() const;

    /// Whether both cannot be left out at once, or one contains the other.
    bool
    excludes(const EffectVariant &other) const;
  };

  /**
   * The simplifications that a scene allows, in the order of its sections: flow
   * and each part of a law, anisotropy, differences between materials,
   * friction (none, or so much that nothing slips), motion of the foundation,
   * each load, the initial state, changes of each datum over space and time;
   * then the choices of the discretization, and what only watches.
   *
   * @p typical_stress: a von Mises stress at which a power law and a linear one
   * are to flow at the same rate. @p contact_force: the size of the force of
   * unilateral contact, as an expression of t; empty where it is not known.
   * Collective, for the @p means.
   */
  std::vector<EffectVariant>
  effect_variants(const Parameters  &scene,
                  const SceneData   &means,
                  const double       typical_stress,
                  const std::string &contact_force = "");

  /// Two simplifications at once.
  EffectVariant
  both(const EffectVariant &first, const EffectVariant &second);
} // namespace Viscoplastic
