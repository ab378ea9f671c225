// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/run_record.h>
#include <viscoplastic_contact/run/run_directories.h>

#include <filesystem>

namespace Viscoplastic
{
  namespace
  {
    std::string
    checkpoint_directory(const Parameters &parameters)
    {
      const std::string &directory = parameters.checkpoint.directory;
      return directory.empty() ? results_directory(parameters) + "checkpoint" :
                                 directory;
    }
  } // namespace



  RunDirectories::RunDirectories(const Parameters &parameters,
                                 Console          &console,
                                 const MPI_Comm    communicator)
    : checkpoints(checkpoint_directory(parameters), communicator)
    , parameters(parameters)
    , console(console)
    , communicator(communicator)
  {}



  void
  RunDirectories::lock()
  {
    lock(/* make_results = */ false);
  }



  void
  RunDirectories::lock(const bool make_results)
  {
    const std::string results = results_directory(parameters);
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      if (make_results)
        make_results_directory(results);
      const std::string otherwise = "choose another 'Output/Directory' and "
                                    "'Checkpoint/Directory'";
      results_lock.acquire(results, otherwise);
      std::error_code none;
      if (!std::filesystem::equivalent(results, checkpoints.directory, none))
        checkpoint_lock.acquire(checkpoints.directory, otherwise);
    });
  }



  void
  RunDirectories::begin()
  {
    lock(/* make_results = */ true);
  }



  void
  RunDirectories::begin_checkpoints(const bool are_of_this_run)
  {
    const CheckpointParameters &wanted = parameters.checkpoint;
    if (wanted.every_n_steps > 0 || wanted.wall_time_interval > 0. ||
        wanted.wall_time_limit > 0.)
      {
        checkpoints.make_directory();
        lock();
      }
    const CheckpointStore::Removal removal = checkpoints.remove_all();
    for (const std::string &remark : removal.remarks)
      console.remark(remark);
    if (removal.n_checkpoints > 0 && !are_of_this_run)
      console.remark("Note: the checkpoints of an earlier run in '" +
                     checkpoints.directory + "' have been removed.");
  }



  std::optional<CheckpointManifest>
  RunDirectories::find_checkpoint(const CommandLine::Restart restart)
  {
    using Restart = CommandLine::Restart;
    if (restart == Restart::no)
      return {};
    std::vector<std::string> remarks;
    auto                     found = checkpoints.newest(remarks);
    for (const std::string &remark : remarks)
      console.remark("Warning: " + remark + '.');
    AssertThrow(found || remarks.empty(),
                ExcMessage("None of the " + std::to_string(remarks.size()) +
                           " checkpoint(s) in '" + checkpoints.directory +
                           "' can be used: " + remarks[0] + '.'));
    AssertThrow(found || restart == Restart::automatic,
                ExcMessage("There is no checkpoint in '" +
                           checkpoints.directory +
                           "'; begin without --restart, or name the place in "
                           "'Checkpoint/Directory' or 'Output/Directory'."));
    return found;
  }



  void
  RunDirectories::write_checkpoint(
    const CheckpointManifest                 &manifest,
    const std::map<std::string, std::string> &files)
  {
    checkpoints.make_directory(); // unless the scene has asked for checkpoints
    lock();
    for (const std::string &remark :
         checkpoints.write(manifest, files, parameters.checkpoint.keep))
      console.remark(remark);
  }
} // namespace Viscoplastic
