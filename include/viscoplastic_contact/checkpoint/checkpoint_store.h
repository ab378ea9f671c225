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
  /// The checkpoints of a run: a directory with a subdirectory `step_000012'
  /// for each of the last ones, which holds any number of files and a manifest
  /// with their sizes and checksums.
  ///
  /// A checkpoint comes into being as a whole: it is written into a directory
  /// of another name, put to disk (fsync), and renamed. Whatever ends the
  /// program at whatever instant, the checkpoints before it are untouched.
  ///
  /// Only what the program has written is ever removed: the files that the
  /// manifest of a checkpoint names, or the list with which an unfinished one
  /// begins, and then the directory, if nothing else is in it. Functions that
  /// remove something return a sentence for each directory that has stayed for
  /// this reason.
  ///
  /// Member functions are collective; errors are ExcMessage on all ranks.
  class CheckpointStore
  {
  public:
    CheckpointStore(const std::string &directory, const MPI_Comm communicator);

    const std::string directory; // ends with a slash

    /// The name under which a checkpoint of step @p n is kept.
    std::string
    path(const unsigned int n) const
    {
      return directory + "step_" + dealii::Utilities::int_to_string(n, 6);
    }

    /// Make the directory; throws ExcMessage if it cannot be made.
    void
    make_directory() const;

    /// Write the files of each rank (name to bytes) and a manifest that lists
    /// them, and remove all but the newest @p n_kept checkpoints. A foreign
    /// directory of that name is renamed.
    std::vector<std::string>
    write(CheckpointManifest                        manifest,
          const std::map<std::string, std::string> &files_of_this_rank,
          const unsigned int                        n_kept) const;

    /// The newest checkpoint whose files are all there and have their
    /// checksums, if any; @p remarks takes a sentence for each that has been
    /// passed over.
    std::optional<CheckpointManifest>
    newest(std::vector<std::string> &remarks) const;

    /// The contents of a file of a checkpoint, checked again. Not collective.
    std::string
    read(const CheckpointManifest &manifest, const std::string &name) const;

    struct Removal
    {
      unsigned int             n_checkpoints = 0;
      std::vector<std::string> remarks;
    };

    /// Remove checkpoints after step @p n, what has been left of unfinished
    /// ones, and all but the newest @p n_kept (0: no one stays) up to step
    /// @p n: a run may have been killed after it had written one, before it
    /// removed the oldest. These are not in the number of checkpoints.
    Removal
    remove_others(const unsigned int n, const unsigned int n_kept) const;

    Removal
    remove_all() const
    {
      return remove_others(0, 0);
    }

  private:
    /// A directory with a name that checkpoints have, be they valid or not.
    struct Entry
    {
      std::string  path;
      unsigned int n = 0;
      /// False for one that is unfinished or being replaced.
      bool is_complete = true;
    };

    /// All checkpoints by ascending steps. Empty if there is no directory;
    /// throws ExcMessage if it cannot be read. Not collective.
    std::vector<Entry>
    entries() const;

    /// Remove all but the newest @p n_kept (at least one) up to step @p n,
    /// which is there. Not collective.
    void
    remove_before(const unsigned int        n,
                  const unsigned int        n_kept,
                  std::vector<std::string> &remarks) const;

    const MPI_Comm     communicator;
    const unsigned int rank, n_ranks;
  };
} // namespace Viscoplastic
