// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/checkpoint/checkpoint_manifest.h>

#include <mpi.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The checkpoints of a run: a directory with subdirectories, as
  /// `step_000012', each with any number of files and a manifest of their sizes
  /// and checksums.
  ///
  /// Checkpoints are written atomically: into a directory of another name,
  /// which is flushed to disk (fsync) and then renamed. If the process is
  /// killed at any time, earlier checkpoints are untouched.
  ///
  /// Only files that the program has written are ever removed: those named by
  /// the manifest of a checkpoint, or by the list that an unfinished one has
  /// instead, and then the directory, if nothing else is in it. Functions that
  /// remove something return a sentence for each directory that therefore
  /// stays.
  ///
  /// Member functions are collective; errors are ExcMessage on all ranks.
  class CheckpointStore
  {
  public:
    CheckpointStore(const std::string &directory, const MPI_Comm communicator);

    const std::string directory; // ends with a slash

    /// The path of the checkpoint of step @p n.
    std::string
    path(const unsigned int n) const
    {
      return directory + "step_" + dealii::Utilities::int_to_string(n, 6);
    }

    /// Create the directory. Throws ExcMessage if that fails.
    void
    make_directory() const;

    /// Write the files of each rank (name to bytes) and a manifest of all
    /// files, and remove all but the newest @p n_kept checkpoints. An existing
    /// directory of that name is replaced, or renamed if it has other files.
    std::vector<std::string>
    write(CheckpointManifest                        manifest,
          const std::map<std::string, std::string> &files_of_this_rank,
          const unsigned int                        n_kept) const;

    /// Return the newest checkpoint whose files are complete with correct
    /// checksums, if any; adds to @p remarks a sentence for each newer one that
    /// is not.
    std::optional<CheckpointManifest>
    newest(std::vector<std::string> &remarks) const;

    /// Return a file of a checkpoint after checking it. Not collective.
    std::string
    read(const CheckpointManifest &manifest, const std::string &name) const;

    struct Removal
    {
      unsigned int             n_checkpoints = 0;
      std::vector<std::string> remarks;
    };

    /// Remove checkpoints after step @p n, unfinished ones, and all but the
    /// newest @p n_kept (0: none is kept) up to step @p n: an interrupted run
    /// may have more, since it removes old ones last. Counts complete
    /// checkpoints after step @p n, or all if none is kept.
    Removal
    remove_others(const unsigned int n, const unsigned int n_kept) const;

    Removal
    remove_all() const
    {
      return remove_others(0, 0);
    }

  private:
    /// A directory with the name of a checkpoint, valid or not.
    struct Entry
    {
      std::string  path;
      unsigned int n = 0;
      /// False if the checkpoint is unfinished or being replaced.
      bool is_complete = true;
    };

    /// Return all entries by ascending step; none if there is no directory.
    /// Throws ExcMessage if it cannot be read. Not collective.
    std::vector<Entry>
    entries() const;

    /// Remove all but the newest @p n_kept (at least one) checkpoints up to
    /// step @p n, which exists. Not collective.
    void
    remove_before(const unsigned int        n,
                  const unsigned int        n_kept,
                  std::vector<std::string> &remarks) const;

    const MPI_Comm     communicator;
    const unsigned int rank, n_ranks;
  };
} // namespace Viscoplastic
