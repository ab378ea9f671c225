// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/run_record.h>
#include <viscoplastic_contact/run/run_files.h>

#include <filesystem>

namespace Viscoplastic
{
  namespace
  {
    /// Return the present and the peak memory of all ranks together in MB.
    std::pair<double, double>
    memory_of_ranks(const MPI_Comm communicator)
    {
      Utilities::System::MemoryStats stats;
      Utilities::System::get_memory_stats(stats); // kB
      return {Utilities::MPI::sum(stats.VmRSS / 1024., communicator),
              Utilities::MPI::sum(stats.VmHWM / 1024., communicator)};
    }



    std::string
    checkpoint_directory(const Parameters &parameters)
    {
      const std::string &directory = parameters.checkpoint.directory;
      return directory.empty() ? results_directory(parameters) + "checkpoint" :
                                 directory;
    }
  } // namespace



  template <int dim>
  RunFiles<dim>::RunFiles(RunState<dim> &run,
                          Console       &console,
                          TimerOutput   &timer,
                          const MPI_Comm communicator)
    : checkpoints(checkpoint_directory(run.scene.parameters), communicator)
    , run(run)
    , parameters(run.scene.parameters)
    , console(console)
    , timer(timer)
    , communicator(communicator)
    , lines(run.scene)
    , schedule(parameters.checkpoint)
    , first_memory(memory_of_ranks(communicator).first)
  {
    lock();
  }



  template <int dim>
  void
  RunFiles<dim>::lock()
  {
    const std::string results = results_directory(parameters);
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      const std::string otherwise = "choose another 'Output/Directory' and "
                                    "'Checkpoint/Directory'";
      results_lock.acquire(results, otherwise);
      std::error_code none;
      if (!std::filesystem::equivalent(results, checkpoints.directory, none))
        checkpoint_lock.acquire(checkpoints.directory, otherwise);
    });
  }



  template <int dim>
  std::optional<CheckpointManifest>
  RunFiles<dim>::find_checkpoint(const CommandLine::Restart restart)
  {
    using Restart = CommandLine::Restart;
    if (restart == Restart::no)
      return {};
    std::vector<std::string> remarks;
    auto                     found = checkpoints.newest(remarks);
    for (const std::string &remark : remarks)
      console.remark("Warning: " + remark + '.');
    if (!found && !remarks.empty())
      refuse("None of the " + std::to_string(remarks.size()) +
             " checkpoint(s) in '" + checkpoints.directory +
             "' can be used: " + remarks[0] + '.');
    if (!found && restart != Restart::automatic)
      refuse("There is no checkpoint in '" + checkpoints.directory +
             "'; begin without --restart, or name the place in "
             "'Checkpoint/Directory' or 'Output/Directory'.");
    return found;
  }



  template <int dim>
  void
  RunFiles<dim>::begin_checkpoints()
  {
    if (schedule.is_regular() || parameters.checkpoint.wall_time_limit > 0.)
      {
        checkpoints.make_directory();
        lock();
      }
    const CheckpointStore::Removal removal = checkpoints.remove_others(0, 0);
    for (const std::string &remark : removal.remarks)
      console.remark(remark);
    // Checkpoints of an earlier pass of this run are removed silently.
    if (removal.n_checkpoints > 0 && !run.pass.follows_another)
      console.remark("Note: the checkpoints of an earlier run in '" +
                     checkpoints.directory + "' have been removed.");
  }



  template <int dim>
  void
  RunFiles<dim>::begin()
  {
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        make_results_directory(results_directory(parameters));
    });
    lock();
    output.emplace(run.scene, communicator);
    if (run.pass.follows_another)
      output->resume({});
    lines.open(directory());
    begin_checkpoints();
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      run.recorder.write_to(std::make_unique<TableFile>(
        directory() + "statistics.csv", parameters.units, dim));
  }



  template <int dim>
  void
  RunFiles<dim>::resume(const RunArchive<dim> &archive)
  {
    const State<dim>  &state = run.accepted.state;
    const unsigned int n     = state.n;
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        run.recorder.write_to(
          std::make_unique<TableFile>(results_directory(parameters) +
                                        "statistics.csv",
                                      parameters.units,
                                      dim,
                                      n,
                                      /* least_rows = */ n + 1));
    });
    output.emplace(run.scene, communicator);
    output->resume(archive.data.output_times);
    lines.open(directory(), n);
    // A run without regular checkpoints keeps the existing ones.
    const unsigned int n_kept = schedule.is_regular() ?
                                  parameters.checkpoint.keep :
                                  std::numeric_limits<unsigned int>::max();
    for (const std::string &remark :
         checkpoints.remove_others(n, n_kept).remarks)
      console.remark(remark);
    console.stream() << "Restart after step " << n << " (t = " << state.t
                     << run.scene.unit(Quantity::time) << ") from '"
                     << checkpoints.path(n) << "'" << std::endl;
    archive.remark_on_changes(console);
    run.recorder.resume(state, archive.data.earlier_seconds);
  }



  template <int dim>
  void
  RunFiles<dim>::write(const TimeStep &step)
  {
    TimerOutput::Scope         phase(timer, "output");
    const EvaluatedState<dim> &accepted = run.accepted;
    const Vector<double>      &squared_indicators =
      accepted.space_estimate.squared_indicators;
    const bool is_due = output->is_due(step);
    if (is_due)
      output->write_fields(discretization->laws,
                           accepted.state,
                           discretization->face.get(),
                           squared_indicators.size() > 0 ? &squared_indicators :
                                                           nullptr);
    else
      output->report_failure();
    lines.write(accepted.state, is_due);
  }



  template <int dim>
  std::string
  RunFiles<dim>::keep_checkpoints(
    const parallel::distributed::Triangulation<dim> &triangulation,
    const TimeStepper<dim>                          &time_stepper)
  {
    const State<dim> &state   = run.accepted.state;
    const bool        is_last = state.t >= run.scene.schedule.end_time();
    auto              decision =
      schedule.after_step(state.n, is_last, run.recorder.elapsed());
    // Clocks of ranks differ: the decision of rank 0 counts.
    if (Utilities::MPI::this_mpi_process(communicator) != 0)
      decision = {};
    const SignalRequests::Request request =
      signals->agree(communicator, decision.is_due, decision.is_late);
    const std::string stop  = request.stop.empty() && request.is_late ?
                                "'Checkpoint/Wall time limit'" :
                                request.stop;
    const bool        stops = !stop.empty() && !is_last;
    if (!request.checkpoint && !stops)
      return "";
    write_checkpoint(triangulation, time_stepper);
    schedule.restart_clock(run.recorder.elapsed());
    const std::string text =
      "step " + std::to_string(state.n) + " (t = " + as_text(state.t) +
      run.scene.unit(Quantity::time) + "): '" + checkpoints.path(state.n) + "'";
    if (!stops)
      {
        // Regular checkpoints are not announced.
        if (!decision.is_due)
          console.stream() << "Checkpoint of " << text << std::endl;
        return "";
      }
    std::string interruption = stop +
                               " has ended the run after the checkpoint of " +
                               text + "; --restart goes on.";
    if (const auto relative = run.recorder.relative_error(run.accepted.errors))
      interruption +=
        " The error " +
        (run.scene.quantity ?
           "of " + run.scene.names.quantity(run.scene.quantity->name) :
           "in the energy norm") +
        " up to there is estimated as " + number(100. * *relative, 2) + " %.";
    console.log() << interruption << std::endl;
    return interruption;
  }



  template <int dim>
  void
  RunFiles<dim>::write_checkpoint(
    const parallel::distributed::Triangulation<dim> &triangulation,
    const TimeStepper<dim>                          &time_stepper)
  {
    TimerOutput::Scope phase(timer, "checkpoint");
    output->finish(); // the checkpoint names the outputs
    const PackedRun packed = pack_run(run,
                                      triangulation,
                                      *discretization,
                                      time_stepper,
                                      output->output_times());
    // The checkpoint relies on the rows written so far.
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      {
        run.recorder.synchronize();
        lines.synchronize();
      }
    checkpoints.make_directory(); // missing unless checkpoints are regular
    lock();
    for (const std::string &remark : checkpoints.write(
           packed.manifest, packed.files, parameters.checkpoint.keep))
      console.remark(remark);
  }



  template <int dim>
  void
  RunFiles<dim>::close()
  {
    const Recorder<dim> &recorder = run.recorder;
    std::ostream        &out      = console.stream();
    recorder.check_sizes(/* at_end = */ true);
    std::vector<std::string> remarks = console.remarks();
    for (const std::string &remark : recorder.remarks(run.accepted.state))
      remarks.push_back(remark);
    recorder.print(out);
    output->record_end({recorder.summary(),
                        recorder.bill(),
                        first_memory,
                        memory_of_ranks(communicator).second,
                        discretization->solver_demand(),
                        remarks});
    for (const std::string &remark : remarks)
      out << remark << '\n';
    out << "Results in " << directory() << std::endl;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(RunFiles);
} // namespace Viscoplastic
