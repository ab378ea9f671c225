// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/conditional_ostream.h>
#include <deal.II/base/timer.h>

#include <viscoplastic_contact/study/effect_variants.h>
#include <viscoplastic_contact/study/quantity_histories.h>
#include <viscoplastic_contact/study/study_runs.h>

#include <map>
#include <memory>
#include <optional>
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
    /// The scene cannot be computed without it.
    cannot_be_left_out
  };

  std::string
  to_string(const EffectVerdict verdict);


  /// What the scene is without one effect, on one discretization.
  struct EffectResult
  {
    EffectVariant variant;
    EffectVerdict verdict = EffectVerdict::cannot_be_left_out;
    /// Of the discretization, 0 is that of the scene, see RunKey.
    int    level = 0;
    double cells = 0.;
    /// The changes of all quantities, in the order of the scene's table, and
    /// the one that is the largest in proportion to its error.
    std::vector<QuantityChange> changes;
    QuantityChange              decisive;
    /// Of the displacements in the energy norm, relative; nan where unknown.
    double energy_distance = not_a_number;
    /// Seconds and memory (MB) with and without the effect.
    double seconds_with = 0., seconds_without = 0., memory_with = 0.,
           memory_without = 0.;
    /// Why it could not be computed.
    std::string failure;
  };


  /**
   * Runs a scene, and the same with one effect left out or simplified at a
   * time, and tells for each what it costs and what it changes, beside the
   * error of the discretization: the difference to a run with twice the mesh
   * width and time steps (or tolerance). The coarsest come first; what is
   * settled there is not computed on finer ones. Runs are those of StudyRuns,
   * each in a directory of its own: the same command goes on after an
   * interruption. Member functions are collective.
   */
  class EffectsStudy
  {
  public:
    /// Throws ExcMessage.
    EffectsStudy(const std::vector<std::string> &files,
                 const std::vector<std::string> &overrides,
                 Console                        &console);

    /// Make what is missing, print and write the table. Returns the sentence
    /// of a signal, if one has ended it. Throws ExcMessage if the scene itself
    /// cannot be computed.
    std::string
    run();

    const Parameters  scene;
    const std::string directory;

    /// What has been found of each simplification, the largest changes first.
    std::vector<EffectResult> results;
    /// Two of them at once, if there are two that matter.
    std::optional<EffectResult> together;
    /// Levels that the budget did not reach, in words; empty if it did.
    std::string left_out;

  private:
    /// A run of a variant, with its table.
    struct Computed
    {
      RunRecord record;
      Table     table;
    };

    /// The run of @p runs on a level. Nothing if it has failed, whose reason
    /// is put into @p failure.
    std::optional<Computed>
    compute(const StudyRuns &runs, const int level, std::string &failure);

    RunKey
    key_of(const StudyRuns &runs, const int level) const;

    /// Runs of a variant, below its own directory.
    std::unique_ptr<StudyRuns>
    runs_of(const EffectVariant &variant) const;

    /// Compare a variant with the scene on a level.
    EffectResult
    compare(const EffectVariant &variant, const int level);

    std::vector<int>
    levels() const;

    void
    sort();

    void
    write(const bool is_finished) const;

    std::vector<std::string>   files, overrides;
    Console                   &console;
    ConditionalOStream         out;
    Timer                      timer;
    std::unique_ptr<StudyRuns> base;
    std::map<int, Computed>    of_scene;
    /// The sentence of a signal that has come.
    std::string interruption;
  };
} // namespace Viscoplastic
