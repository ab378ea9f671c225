// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/effects.h>

#include <string>

namespace Viscoplastic
{
  /// The table for the console.
  std::string
  in_words(const EffectsStudy &study);

  /// Write effects.csv, effects.json and effects.md into its directory. On one
  /// rank. Throws ExcMessage.
  void
  write_effects(const EffectsStudy &study, const bool is_finished);
} // namespace Viscoplastic
