// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/conditional_ostream.h>
#include <deal.II/base/timer.h>

#include <viscoplastic_contact/study/study_analysis.h>

#include <set>

namespace Viscoplastic
{
  /// A run of a study, made or not.
  struct PlannedRun
  {
    RunKey key;
    /// Of space, time, both: ladders share runs.
    std::set<std::string> ladders;
    bool                  is_reference = false;
    /// Absent until it is finished.
    std::optional<RunRecord> record;
    /// Why there is none.
    std::string skipped;
  };


  /**
   * The study mode: ladders of runs of one scene, as `Study' describes them,
   * and what follows from them: study.csv, study.json and study.md.
   *
   * The ladder `space' refines the mesh with the steps of the finest level of
   * the study, `time' the steps on its finest mesh, `both' both; so that the
   * part of the error that a ladder leaves alone is the smallest that the study
   * has, and they share the finest run. A scene without an exact solution gets
   * a reference run one level finer in both, which comes before those that are
   * compared with it; a few coarse runs tell whether it fits into the budget.
   */
  class Study
  {
  public:
    /// Throws ExcMessage.
    Study(const std::vector<std::string> &files,
          const std::vector<std::string> &overrides,
          Console                        &console);

    /// Make what is missing. Returns the sentence of a signal, if one has ended
    /// the study. Throws ExcMessage if not a single run could be computed.
    std::string
    run();

    StudyRuns             runs;
    const StudyParameters parameters;
    /// Or fields of a reference of the user's.
    const bool has_exact_solution;

    std::vector<PlannedRun> plan;

    /// Finished ones.
    Records
    records() const;

    /// What quantities are compared with: the reference run, or the finest
    /// finished uniform run in its place; null if there is none.
    const RunRecord *
    reference() const;

    /// The ways to compute of which there are runs, in the order of the plan.
    std::vector<RunKey>
    ways() const;

  private:
    void
    make_plan();

    /// Make a run unless it is too long; @p timer runs since the study began.
    /// Returns the sentence of a signal.
    std::string
    make(PlannedRun &run, const Timer &timer);

    /// Make the reference run, if there is time for it.
    std::string
    make_reference(const Timer &timer);

    /// Look for records of finished runs; returns how many there are.
    unsigned int
    find_finished();

    /// What a run will take, from those that are finished; not a number if that
    /// cannot be known yet.
    double
    expected_seconds(const RunKey &key) const;

    /// Write the files, and study.md with @p is_finished in its headline.
    void
    report(const bool is_finished) const;

    void
    announce(const PlannedRun &run, const double elapsed) const;

    /// Of the ways, from the present records.
    mutable std::map<std::string, CostModel> costs;
    /// Seconds since the study began.
    double last_report = 0.;

    Console           &console;
    ConditionalOStream out;
  };
} // namespace Viscoplastic
