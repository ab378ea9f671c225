// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/conditional_ostream.h>
#include <deal.II/base/timer.h>

#include <viscoplastic_contact/study/study_analysis.h>

#include <array>
#include <set>

namespace Viscoplastic
{
  /// What a sequence of runs refines step by step: the mesh, the time steps, or
  /// both.
  enum class Ladder
  {
    space,
    time,
    both
  };

  constexpr std::array<Ladder, 3> all_ladders{
    {Ladder::space, Ladder::time, Ladder::both}};

  /// As `Study/Ladders' and the files of a study have it.
  std::string
  to_string(const Ladder ladder);


  /// A run of a study, made or not.
  struct PlannedRun
  {
    RunKey key;
    /// Those that the run belongs to: ladders share runs.
    std::set<Ladder> ladders;
    bool             is_reference = false;
    /// Absent until the run is finished.
    std::optional<RunRecord> record;
    /// Why there is no record and will be none.
    std::string skipped;
  };


  /**
   * The study mode: ladders of runs of one scene, as `Study' describes them,
   * and what follows from them: study.csv, study.json and study.md.
   *
   * The ladder `space' refines the mesh with the steps of the finest level of
   * the study, `time' the steps on its finest mesh, `both' both; so that the
   * part of the error that a ladder leaves alone is the smallest that the study
   * has, and they share the finest run. Runs to a tolerance, which choose
   * meshes and steps themselves, are a ladder `both' that halves the tolerance
   * down to that of the scene. A scene without an exact solution gets a
   * reference run one level finer in both (with runs to a tolerance: to half of
   * the scene's), which comes before those that are compared with it; a few
   * coarse runs tell whether it fits into the budget. If it does not, the study
   * has fewer levels, but three at least.
   */
  class Study
  {
  public:
    /// The study that the scene in @p files with @p overrides asks for. Throws
    /// ExcMessage.
    Study(const std::vector<std::string> &files,
          const std::vector<std::string> &overrides,
          Console                        &console);

    /// Make what is missing. Returns the sentence of a signal, if one has ended
    /// the study. Throws ExcMessage if not a single run could be computed.
    std::string
    run();

    StudyRuns             runs;
    const StudyParameters parameters;
    /// Whether the scene knows what errors are, from an exact solution or the
    /// fields of a reference of the user's.
    const bool has_exact_solution;
    /// Values of `Study/Strategies', or what belongs to the scene.
    const std::vector<std::string> strategies;
    /// That of the run that others are compared with.
    const MeshStrategy reference_strategy;

    /// Of each ladder: `Study/Levels', or fewer where the budget would not
    /// reach the reference run of so many.
    unsigned int n_levels;

    /// All runs, the cheapest first.
    std::vector<PlannedRun> plan;

    /// The records of finished runs, the cheapest first.
    Records
    records() const;

    /// What quantities are compared with: the reference run, or the finest
    /// finished uniform run in its place; null if there is none.
    const RunRecord *
    reference() const;

    /// The records of a method variant that tell what its runs cost: all its
    /// finished runs, and those that were made for that alone.
    Records
    timed(const MethodVariant &variant) const;

    /// Why the ladders have fewer levels than `Study/Levels'; empty if they do
    /// not.
    std::string
    levels_in_words() const;

    /// The method variants of which there are finished runs, in the order of
    /// the plan.
    std::vector<MethodVariant>
    variants() const;

  private:
    /// Without an exact solution: fewer do not show whether the finest run can
    /// serve as a reference.
    static constexpr unsigned int fewest_levels = 3;

    /// Decide which runs there are, with n_levels. Throws ExcMessage.
    void
    make_plan();

    /// The runs of a method variant in a ladder, as levels of mesh and time.
    std::vector<std::pair<int, int>>
    levels_of(const MeshStrategy strategy, const Ladder ladder) const;

    /// Make a run unless it takes too long. Returns the sentence of a signal.
    std::string
    make(PlannedRun &run);

    /// Time the method variants on meshes for which prices are wanted and that
    /// no finished run has. Returns the sentence of a signal.
    std::string
    make_timings();

    /// The sentence for a study that a signal has ended, in that run.
    std::string
    interruption_in(const std::string &run, const std::string &sentence) const;

    bool
    can_take_fewer_levels() const;

    /// Whether there is a finished reference run, also of an earlier call that
    /// had to take fewer levels; the plan has its levels then.
    bool
    find_reference();

    /// Make the reference run, if there is time for it, of fewer levels if need
    /// be. Returns the sentence of a signal.
    std::string
    make_reference();

    /// Make the coarse runs without a reference that tell how long the
    /// reference run takes. Returns the sentence of a signal.
    std::string
    make_first_runs();

    /// What the runs that are missing will take; not a number if that of some
    /// cannot be known yet.
    double
    seconds_left() const;

    /// Look for records of finished runs.
    void
    find_finished();

    /// Seconds since the study began, the same on all ranks.
    double
    elapsed() const;

    /// What a run will take, from those that are finished; not a number if that
    /// cannot be known yet.
    double
    expected_seconds(const RunKey &key) const;

    /// Write the files, which say whether the study @p is_finished.
    void
    report(const bool is_finished) const;

    /// Print what a finished run has given and how long the others will take.
    void
    announce(const RunRecord &record) const;

    /// Runs that only tell what they cost, by the name of the method variant.
    std::map<std::string, std::vector<RunRecord>> timings;
    /// Fits to the present records, by the name of the method variant.
    mutable std::map<std::string, CostModel> costs;
    /// Runs since the study began.
    Timer timer;
    /// When the last report was written.
    double last_report = 0.;

    Console           &console;
    ConditionalOStream out;
  };
} // namespace Viscoplastic
