// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/checkpoint/checkpoint_store.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/run/command_line.h>

#include <optional>

namespace Viscoplastic
{
  /// The directories that a run writes into, that of its results and that of
  /// its checkpoints, and the locks that keep other processes out of them.
  /// Member functions are collective and throw ExcMessage on all ranks.
  class RunDirectories
  {
  public:
    /// Remember where results and checkpoints go; nothing is touched yet. Both
    /// arguments stay in use.
    RunDirectories(const Parameters &parameters,
                   Console          &console,
                   const MPI_Comm    communicator);

    /// The checkpoints of the scene.
    const CheckpointStore checkpoints;

    /// Lock the directories, as far as they exist and are not locked yet.
    void
    lock();

    /// Make the directory of the results, and lock both.
    void
    begin();

    /// Remove the checkpoints of an earlier run, which go with its results, and
    /// make sure that there is a place for those of this one. It is told,
    /// unless they are of an earlier pass of this run.
    void
    begin_checkpoints(const bool are_of_this_run);

    /// The checkpoint to go on from, if the run is to go on and there is one.
    std::optional<CheckpointManifest>
    find_checkpoint(const CommandLine::Restart restart);

    /// Write a checkpoint, see CheckpointStore::write().
    void
    write_checkpoint(const CheckpointManifest                 &manifest,
                     const std::map<std::string, std::string> &files);

  private:
    void
    lock(const bool make_results);

    const Parameters &parameters;
    Console          &console;
    const MPI_Comm    communicator;
    DirectoryLock     results_lock, checkpoint_lock; // on rank 0
  };
} // namespace Viscoplastic
