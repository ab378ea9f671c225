// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace Viscoplastic
{
  // Functions that read and write files and check every operation. Each of them
  // throws ExcMessage with a sentence that names the file and the reason given
  // by the system, e.g. a full disk. Only regular files are accepted: reading a
  // pipe may hang, a device has no end, and writing through a link may
  // overwrite a file elsewhere.

  /// Throw unless @p name is a regular file (no link) or does not exist; to be
  /// called before a stream writes into it.
  void
  require_writable_file(const std::string &name);

  /// Return the contents of a file, or nothing if there is no such file. Throws
  /// if the file exists and cannot be read.
  std::optional<std::string>
  read_file_if_any(const std::string &name);

  /// Write a file and flush it to disk. A crash may leave a part of it.
  void
  write_file(const std::string &name, const std::string &bytes);

  /// Replace a file atomically: whatever happens, the old or the new contents
  /// are there. The new contents are written to a file with the suffix `.part',
  /// which is then renamed. With @p to_disk this holds also for a power
  /// failure, at a cost of some milliseconds.
  void
  replace_file(const std::string &name,
               const std::string &bytes,
               const bool         to_disk = false);

  /// The same, with the parts that @p next returns before an empty one.
  void
  replace_file(const std::string                  &name,
               const std::function<std::string()> &next);

  /// Flush a file to disk, including what other streams have written into it.
  void
  synchronize(const std::string &file);

  /// Flush the entries of a directory to disk.
  void
  synchronize_directory(const std::string &name);



  /// Keeps other processes out of a directory that this one writes into by an
  /// operating system lock (flock) on the file viscoplastic_contact.lock there.
  /// The lock vanishes with the process, however that ends, and a file that is
  /// left over locks nothing. Not collective: one rank holds the lock for all.
  class DirectoryLock
  {
  public:
    DirectoryLock() = default;

    ~DirectoryLock();

    DirectoryLock(const DirectoryLock &) = delete;
    DirectoryLock &
    operator=(const DirectoryLock &) = delete;

    /// Take the lock of a directory, unless this object has one already. Throws
    /// ExcMessage if another process has it, or if the lock is no regular file;
    /// @p otherwise tells the user what to do other than wait. If no lock is
    /// possible (the directory does not exist or cannot be written, or its file
    /// system has no locks), return without one.
    void
    acquire(const std::string &directory,
            const std::string &otherwise = "choose another directory");

  private:
    std::string file;
    int         descriptor = -1;
  };

  /// Return the full path of a file that comes with the program and is named as
  /// in the source directory ("doc/index.md", "contrib/convert_mesh"): from the
  /// installation of the program, otherwise from the source directory. Empty if
  /// it is in neither place.
  std::string
  path_of_resource(const std::string &name);

  /// The CRC-32 of a text.
  std::uint32_t
  checksum(const std::string &bytes);

  /// Return JSON as text: indented, with a newline at the end. Numbers have all
  /// their digits, or are null if not finite. Bytes that are no valid UTF-8, as
  /// in names of files, become the replacement character.
  std::string
  json_text(const nlohmann::ordered_json &json);
} // namespace Viscoplastic
