// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/utilities.h>

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The description of a checkpoint, stored in its directory.
  struct CheckpointManifest
  {
    /// Number and end time of the step after which the checkpoint was written.
    unsigned int n       = 0;
    double       t       = 0.;
    unsigned int n_ranks = 0;
    /// The version of the program.
    std::string version;
    /// Every parameter of the run, by `Section/Entry'.
    std::map<std::string, std::string> parameters;
    /// Size in bytes and checksum of each file by name.
    std::map<std::string, std::array<std::uint64_t, 2>> files;

    /// The text of manifest.txt, which contains a checksum of itself.
    std::string
    text() const;

    /// Throws ExcMessage if the text is damaged or of another version.
    static CheckpointManifest
    of_text(const std::string &text);
  };



  /// The checkpoints of a run: a directory with subdirectories, as
  /// `step_000012', each with any number of files and a manifest of their sizes
  /// and checksums. The manifest is written last, in one go: without it a
  /// checkpoint is unfinished. If the process is killed at any time, earlier
  /// checkpoints are untouched.
  ///
  /// Only files that the program has written are ever removed, and then the
  /// directory, if nothing else is in it. Functions that remove something
  /// return a sentence for each directory that therefore stays.
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
    /// files, and remove all but the newest @p n_kept checkpoints. A checkpoint
    /// of the same step is replaced.
    std::vector<std::string>
    write(CheckpointManifest                        manifest,
          const std::map<std::string, std::string> &files_of_this_rank,
          const unsigned int                        n_kept) const;

    /// Return the newest checkpoint whose files are complete with correct
    /// checksums, if any; adds to @p remarks a sentence for each newer one that
    /// is not. Those that are unfinished do not count.
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

    /// Remove all checkpoints but the newest @p n_kept up to step @p n, and
    /// count those that had been finished.
    Removal
    remove_others(const unsigned int n, const unsigned int n_kept) const;

  private:
    /// Return the steps of the directories with names of checkpoints in
    /// ascending order, and whether they are finished; none if there is no
    /// directory. Throws ExcMessage if it cannot be read. Not collective.
    std::map<unsigned int, bool>
    steps() const;

    /// Do the work on rank 0; throw its exceptions on all ranks.
    void
    on_root(const std::function<void()> &work) const;

    const MPI_Comm communicator;
  };
} // namespace Viscoplastic
