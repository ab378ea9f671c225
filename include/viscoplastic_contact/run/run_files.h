// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/timer.h>

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/signals.h>
#include <viscoplastic_contact/checkpoint/checkpoint_schedule.h>
#include <viscoplastic_contact/checkpoint/run_archive.h>
#include <viscoplastic_contact/results/line_output.h>
#include <viscoplastic_contact/results/output.h>
#include <viscoplastic_contact/run/command_line.h>

#include <optional>
#include <string>

namespace Viscoplastic
{
  /// The files of a run: fields, values along lines, statistics and the record
  /// of the run in the directory of the results, and checkpoints; and when they
  /// are written. Member functions are collective and throw ExcMessage with a
  /// sentence for the user, on all ranks.
  template <int dim>
  class RunFiles
  {
  public:
    /// Locks the directories, as far as they exist. What is written is the
    /// accepted state of @p run; all arguments stay in use.
    RunFiles(RunState<dim> &run,
             Console       &console,
             TimerOutput   &timer,
             const MPI_Comm communicator);

    /// The checkpoint to go on from, if the run is to go on and there is one.
    std::optional<CheckpointManifest>
    find_checkpoint(const CommandLine::Restart restart);

    const CheckpointStore checkpoints;

    /// The directory of the results; ends with a slash.
    const std::string &
    directory() const
    {
      return output->directory();
    }

    /// Begin all files anew.
    void
    begin();

    /// Continue the files after the accepted state, with fields at @p
    /// output_times; removes what is later.
    void
    resume(const std::vector<double> &output_times);

    /// Set the mesh on which the next functions take the accepted state.
    void
    set_mesh(const Discretization<dim> &discretization)
    {
      this->discretization = &discretization;
      lines.set_mesh(discretization);
    }

    /// From now on signals end the run after a checkpoint.
    void
    begin_steps()
    {
      schedule.begin_steps(run.recorder.elapsed());
      signals.emplace();
    }

    /// Write the fields, if they are due after @p step, and values along lines.
    void
    write(const TimeStep &step);

    /// Write a checkpoint at the end of a step if one is due or a signal asks
    /// for it. Returns a sentence if the run is to end.
    std::string
    keep_checkpoints(
      const parallel::distributed::Triangulation<dim> &triangulation,
      const TimeStepper<dim>                          &time_stepper);

    /// Wait for files that are being written.
    void
    finish()
    {
      TimerOutput::Scope phase(timer, "output");
      output->finish();
      signals.reset();
    }

    /// Add what is known at the end, costs and remarks to the record of the
    /// run.
    void
    close(const std::vector<std::string> &remarks);

  private:
    /// Lock the directories of results and checkpoints, as far as they exist
    /// and are not locked yet, so that other processes keep out of them.
    void
    lock();

    /// Remove the checkpoints of an earlier run, which go with its results, and
    /// make sure that there is a place for those of this one.
    void
    begin_checkpoints();

    void
    write_checkpoint(
      const parallel::distributed::Triangulation<dim> &triangulation,
      const TimeStepper<dim>                          &time_stepper);

    RunState<dim>             &run;
    const Parameters          &parameters;
    Console                   &console;
    TimerOutput               &timer;
    const MPI_Comm             communicator;
    const Discretization<dim> *discretization = nullptr;

    DirectoryLock                 results_lock, checkpoint_lock; // on rank 0
    std::optional<Output<dim>>    output; // from begin() or resume() on
    LineOutput<dim>               lines;
    CheckpointSchedule            schedule;
    std::optional<SignalRequests> signals; // while steps are made
    /// Memory of all ranks together in MB when the run began.
    const double first_memory;
  };
} // namespace Viscoplastic
