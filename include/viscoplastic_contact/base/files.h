// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace Viscoplastic
{
  // Files, read and written so that nothing that goes wrong is overlooked.
  // Every function throws ExcMessage with a sentence that names the file and
  // the reason that the system gives, e.g. a full disk. All files are regular
  // ones: a pipe would hang, a device has no end, and results that follow a
  // link would overwrite the file of somebody else.

  /// Throws unless @p name is a regular file and no link, or nothing yet: for
  /// streams that are going to write into it.
  void
  require_writable_file(const std::string &name);

  /// The contents of a file; nothing if there is no such file. A file that is
  /// there and cannot be read is an error.
  std::optional<std::string>
  read_file_if_any(const std::string &name);

  /// Write a file and put it to disk. A crash may leave a part of it.
  void
  write_file(const std::string &name, const std::string &bytes);

  /// Replace a file at once: whatever happens, it is the old one or the new
  /// one. The new one is written under the name with `.part' and renamed.
  ///
  /// With @p to_disk that holds also if the machine loses its power, which
  /// takes some milliseconds.
  void
  replace_file(const std::string &name,
               const std::string &bytes,
               const bool         to_disk = false);

  /// The same from parts: what @p next returns until that is nothing.
  void
  replace_file(const std::string                  &name,
               const std::function<std::string()> &next);

  /// Put a file to disk, with what other streams have written into it.
  void
  synchronize(const std::string &file);

  /// Put the names in a directory to disk.
  void
  synchronize_directory(const std::string &name);



  /// Keeps other processes out of a directory that this one writes into. The
  /// lock is one of the operating system on the file viscoplastic_contact.lock
  /// there: it vanishes with the process, however that ends, and the file alone
  /// keeps nobody out. Not collective: one rank holds the lock for all.
  class DirectoryLock
  {
  public:
    DirectoryLock() = default;

    ~DirectoryLock();

    DirectoryLock(const DirectoryLock &) = delete;
    DirectoryLock &
    operator=(const DirectoryLock &) = delete;

    /// Take the lock of a directory, unless this object has one already. @p
    /// otherwise: what else the user may do than wait. Throws
    /// ExcMessage if another process has it, or if the lock is no regular file.
    /// Without a lock goes on where there is none to be had: the directory does
    /// not exist yet or cannot be written, or its file system has no locks.
    void
    acquire(const std::string &directory,
            const std::string &otherwise = "choose another directory");

  private:
    std::string file;
    int         descriptor = -1;
  };

  /// The full path of a file that comes with the program, which is named as in
  /// the sources ("doc/index.md", "contrib/convert_mesh"): beside an installed
  /// program, otherwise where the sources were when it was built. Empty if it
  /// is in neither place.
  std::string
  path_of_resource(const std::string &name);

  /// The CRC-32 of a text.
  std::uint32_t
  checksum(const std::string &bytes);

  /// JSON as our files have it: indented, with a newline at the end. Numbers
  /// have all their digits, or are null where they are not finite. Texts may
  /// hold any bytes, as names of files do: what is no UTF-8 becomes the
  /// replacement character.
  std::string
  json_text(const nlohmann::ordered_json &json);
} // namespace Viscoplastic
