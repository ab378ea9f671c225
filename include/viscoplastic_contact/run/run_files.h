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
  /// The files of a run and the times at which they are written: fields, values
  /// along lines, statistics, the record of the run, and checkpoints. Member
  /// functions are collective and throw ExcMessage with a sentence for the user
  /// on all ranks.
  template <int dim>
  class RunFiles
  {
  public:
    /// Locks the directories that exist. The accepted state of @p run is
    /// written; keeps references to all arguments.
    RunFiles(RunState<dim> &run,
             Console       &console,
             TimerOutput   &timer,
             const MPI_Comm communicator);

    /// The newest valid checkpoint, if @p restart asks for one and it exists.
    std::optional<CheckpointManifest>
    find_checkpoint(const CommandLine::Restart restart);

    const CheckpointStore checkpoints;

    /// The directory of the results; ends with a slash.
    const std::string &
    directory() const
    {
      return output->directory();
    }

    /// Begin all files anew, and remove checkpoints of earlier runs.
    void
    begin();

    /// Continue the files and the record after the accepted state, which has
    /// been read from @p archive; removes later rows, fields and checkpoints.
    void
    resume(const RunArchive<dim> &archive);

    /// Set the mesh of the accepted state. Keeps a reference to it.
    void
    set_mesh(const Discretization<dim> &discretization)
    {
      this->discretization = &discretization;
      lines.set_mesh(discretization);
    }

    /// Handle signals from here on: they end the run after a checkpoint.
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

    /// Wait for files that are being written, and stop handling signals.
    void
    finish()
    {
      TimerOutput::Scope phase(timer, "output");
      output->finish();
      signals.reset();
    }

    /// Print the final output and complete the record of the run.
    void
    close();

  private:
    /// Lock the directories of results and checkpoints, as far as they exist
    /// and are not locked yet, so that other processes keep out of them.
    void
    lock();

    /// Remove the checkpoints of an earlier run, whose results are overwritten,
    /// and make a directory for those of this run if it has any.
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
