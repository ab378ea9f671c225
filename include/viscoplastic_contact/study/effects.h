// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/conditional_ostream.h>
#include <deal.II/base/timer.h>

#include <viscoplastic_contact/study/effect_result.h>
#include <viscoplastic_contact/study/study_runs.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /**
   * Runs a scene, and the same with one effect left out or simplified at a
   * time, and tells for each what it costs and what it changes, beside the
   * error of the discretization: what twice the mesh width changes and what
   * twice the time steps change (or twice the tolerance). The coarsest come
   * first; what is settled there is not computed on finer ones. Runs are those
   * of StudyRuns, each in a directory of its own: the same command goes on
   * after an interruption. Member functions are collective.
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

    const std::vector<std::string> files, overrides;
    const Parameters               scene;
    const std::string              directory;

    /// What has been found of each simplification: of the problem first, the
    /// largest changes first.
    std::vector<EffectResult> results;
    /// Two of them at once, if there are two that matter.
    std::optional<EffectInteraction> interaction;
    /// What the budget did not reach, in words; empty if there is nothing.
    std::string left_out;

  private:
    /// A run of a variant, with its table.
    struct Computed
    {
      RunRecord record;
      Table     table;
      RunCost   cost;
    };

    /// How an attempt at a run has ended: with a run, or one of these.
    struct Attempt
    {
      std::optional<Computed> computed;
      std::string             failure, interruption;
      bool                    is_too_long = false;
    };

    /// Runs of a variant below its own directory, compared with those of the
    /// scene on this level.
    std::unique_ptr<StudyRuns>
    runs_of(const EffectVariant &variant, const int level) const;

    /// Find a run, or make it if it can be expected to end within the budget.
    Attempt
    compute(const StudyRuns &runs,
            const int        level,
            const double     expected_seconds);

    /// Whether a run of so many seconds ends within the budget.
    bool
    is_affordable(const double seconds) const;

    /// The scene as it is, to be found in of_scene; whether that is possible.
    bool
    compute_scene(const int level);

    /// The scene on the mesh of a level with the steps of the coarser one, if
    /// the budget allows.
    void
    compute_with_longer_steps(const int level);

    /// Compare a variant with the scene on a level; nothing where the budget
    /// or a signal has ended the study. @p table: that of the variant.
    std::optional<EffectResult>
    compare(const EffectVariant &variant,
            const int            level,
            Table               *table = nullptr);

    /// Put the errors of the quantities of the scene on a level beside changes
    /// of the same quantities.
    void
    add_errors(std::vector<QuantityChange> &changes, const int level) const;

    /// Judge all variants, on as fine levels as they need.
    /// Judge these variants on a level; those that are not settled are left.
    void
    judge_on(const int level, std::vector<EffectVariant> &open);

    void
    judge_all(std::vector<EffectVariant> open);

    /// Leave out the two largest at once that are no loads.
    void
    find_interaction();

    /// Replace what is known of the variant.
    void
    keep(const EffectResult &result);

    std::vector<int>
    levels() const;

    void
    write(const bool is_finished) const;

    Console                               &console;
    ConditionalOStream                     out;
    Timer                                  timer;
    const std::unique_ptr<const SceneData> data;
    const std::unique_ptr<StudyRuns>       base;
    std::map<int, Computed>                of_scene;
    std::map<int, Table>                   with_longer_steps;
    /// Why the scene could not be computed, and the sentence of a signal.
    std::string failure, interruption;
  };
} // namespace Viscoplastic
