// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/checkpoint/checkpoint_store.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;
  namespace fs = std::filesystem;

  namespace
  {
    const std::string manifest_name = "manifest.txt";
    const std::string unfinished = ".unfinished", outdated = ".outdated";
    // The list that an unfinished checkpoint has instead of a manifest.
    const std::string list_name       = "unfinished.txt";
    const std::string first_of_a_list = "viscoplastic_contact list of files 1";



    std::string
    read_file(const std::string &name)
    {
      const std::optional<std::string> bytes = read_file_if_any(name);
      if (!bytes)
        refuse("'" + name + "' cannot be read.");
      return *bytes;
    }



    std::string
    read_checked(const std::string              &directory,
                 const CheckpointManifest::File &file)
    {
      std::error_code error;
      const auto      size = fs::file_size(directory + file.name, error);
      if (error)
        refuse("the file " + excerpt(file.name) + " is missing");
      if (size != file.size)
        refuse("the file " + excerpt(file.name) + " has " +
               std::to_string(size) + " bytes instead of " +
               std::to_string(file.size));
      std::string bytes = read_file(directory + file.name);
      if (bytes.size() != file.size || checksum(bytes) != file.checksum)
        refuse("the file " + excerpt(file.name) +
               " does not have its checksum");
      return bytes;
    }



    std::string
    list_of_files(const std::vector<std::string> &names)
    {
      std::string text = first_of_a_list + '\n';
      for (const std::string &name : names)
        text += "file " + name + '\n';
      return text;
    }



    /// Return the files in a directory that its manifest or list names, and
    /// these two last: if removal in this order is interrupted, the rest is
    /// still known. Empty if the directory is not from this program.
    std::vector<std::string>
    own_files(const std::string &directory)
    {
      std::vector<std::string> names, lists;
      for (const auto &[name, beginning] :
           {std::make_pair(manifest_name, first_words_of_manifests),
            std::make_pair(list_name, first_of_a_list + '\n')})
        {
          const auto text = read_file_if_any(directory + '/' + name);
          if (!text)
            continue;
          const bool is_ours =
            text->compare(0, beginning.size(), beginning) == 0;
          // A truncated list is the only file: all others come after it.
          const bool is_begun =
            name == list_name &&
            beginning.compare(0, text->size(), *text) == 0 &&
            std::distance(fs::directory_iterator(directory), {}) == 1;
          if (!is_ours && !is_begun)
            continue;
          lists.push_back(name);
          std::istringstream lines(*text);
          std::string        line, key, file;
          while (std::getline(lines, line))
            if (std::istringstream words(line);
                words >> key >> file && key == "file")
              names.push_back(file);
        }
      names.insert(names.end(), lists.begin(), lists.end());
      return names;
    }



    /// Remove the files that the program has written in a directory, and the
    /// directory if it is empty then; otherwise adds a sentence to @p remarks.
    /// Returns whether there was a manifest or list.
    bool
    remove_own(const std::string &path, std::vector<std::string> &remarks)
    {
      const std::string note = "Note: '" + path + "' stays, since ";
      if (!fs::is_directory(fs::symlink_status(path)))
        {
          remarks.push_back(note + "this program has made no such file.");
          return false;
        }
      const std::vector<std::string> names = own_files(path);
      for (const std::string &name : names)
        {
          const fs::path file = fs::path(path) / name;
          if (name.find('/') == std::string::npos &&
              fs::is_regular_file(fs::symlink_status(file)))
            fs::remove(file);
        }
      std::vector<std::string> others;
      for (const auto &entry : fs::directory_iterator(path))
        others.push_back(excerpt(entry.path().filename().string()));
      if (others.empty())
        fs::remove(path);
      else
        {
          std::sort(others.begin(), others.end());
          remarks.push_back(note + "no manifest of this program names " +
                            enumeration(others, 3) + " in it.");
        }
      return !names.empty();
    }



    /// Return @p path, with a number appended if it exists already.
    std::string
    unused(const std::string &path)
    {
      std::string result = path;
      for (unsigned int i = 2; fs::exists(fs::symlink_status(result)); ++i)
        result = path + '_' + std::to_string(i);
      return result;
    }
  } // namespace



  CheckpointStore::CheckpointStore(const std::string &directory,
                                   const MPI_Comm     communicator)
    : directory(directory.back() == '/' ? directory : directory + '/')
    , communicator(communicator)
    , rank(Utilities::MPI::this_mpi_process(communicator))
    , n_ranks(Utilities::MPI::n_mpi_processes(communicator))
  {}



  std::vector<CheckpointStore::Entry>
  CheckpointStore::entries() const
  {
    static const std::regex name("step_([0-9]{6,9})([.](" +
                                 unfinished.substr(1) + '|' +
                                 outdated.substr(1) + ")(_[0-9]+)?)?");
    std::vector<Entry>      result;
    std::error_code         error;
    fs::directory_iterator  place(directory, error);
    if (error == std::errc::no_such_file_or_directory)
      return result;
    for (; !error && place != fs::directory_iterator(); place.increment(error))
      {
        const std::string file = place->path().filename().string();
        std::smatch       parts;
        std::error_code   none;
        if (!std::regex_match(file, parts, name) || !place->is_directory(none))
          continue;
        Entry entry;
        entry.path        = directory + file;
        entry.n           = std::stoul(parts[1]);
        entry.is_complete = parts[2].length() == 0;
        if (!entry.is_complete || entry.path == path(entry.n))
          result.push_back(entry);
      }
    if (error)
      refuse("The directory '" + directory +
             "' for checkpoints cannot be read: " + error.message() + '.');
    std::sort(result.begin(), result.end(), [](const Entry &a, const Entry &b) {
      return std::make_pair(a.n, a.path) < std::make_pair(b.n, b.path);
    });
    return result;
  }



  void
  CheckpointStore::make_directory() const
  {
    fail_together(communicator, [&]() {
      std::error_code error;
      if (rank == 0)
        fs::create_directories(directory, error);
      if (error)
        refuse("The directory '" + directory +
               "' for checkpoints cannot be written; change "
               "'Checkpoint/Directory' or its permissions.");
    });
  }



  std::vector<std::string>
  CheckpointStore::write(CheckpointManifest                        manifest,
                         const std::map<std::string, std::string> &files,
                         const unsigned int                        n_kept) const
  {
    const std::string        final_path = path(manifest.n);
    std::string              temporary;
    std::vector<std::string> remarks;
    const auto do_together = [&](const std::function<void()> &work) {
      try
        {
          fail_together(communicator, work);
        }
      catch (const std::exception &exception)
        {
          // Free the space on disk; earlier checkpoints stay.
          if (rank == 0 && !temporary.empty())
            try
              {
                remove_own(temporary, remarks);
              }
            catch (const std::exception &)
              {}
          refuse("The checkpoint of step " + std::to_string(manifest.n) +
                 " failed: " + reason(exception));
        }
    };

    // Rank 0 lists all files before any of them is written.
    std::vector<std::string> names;
    for (const auto &file : files)
      names.push_back(file.first);
    const auto names_of_all = Utilities::MPI::gather(communicator, names);
    do_together([&]() {
      if (rank != 0)
        return;
      const std::string wanted = final_path + unfinished;
      if (fs::exists(wanted))
        remove_own(wanted, remarks);
      temporary = unused(wanted) + '/';
      fs::create_directories(temporary);
      names.clear();
      for (const auto &part : names_of_all)
        names.insert(names.end(), part.begin(), part.end());
      names.push_back(manifest_name);
      write_file(temporary + list_name, list_of_files(names));
    });
    temporary = Utilities::MPI::broadcast(communicator, temporary);

    std::vector<CheckpointManifest::File> mine;
    do_together([&]() {
      for (const auto &[name, bytes] : files)
        {
          write_file(temporary + name, bytes);
          mine.push_back({name, bytes.size(), checksum(bytes)});
        }
    });

    const auto all = Utilities::MPI::gather(communicator, mine);
    do_together([&]() {
      if (rank != 0)
        return;
      manifest.files.clear();
      for (const auto &part : all)
        manifest.files.insert(manifest.files.end(), part.begin(), part.end());
      write_file(temporary + manifest_name, manifest.text());
      fs::remove(temporary + list_name);
      synchronize_directory(temporary);
      // A directory cannot be renamed to an existing one.
      std::string aside;
      if (fs::exists(fs::symlink_status(final_path)))
        {
          aside = unused(final_path + outdated);
          fs::rename(final_path, aside);
        }
      fs::rename(temporary, final_path);
      synchronize_directory(directory);

      if (!aside.empty())
        remove_own(aside, remarks);
      remove_before(manifest.n, n_kept, remarks);
    });
    return Utilities::MPI::broadcast(communicator, remarks);
  }



  std::optional<CheckpointManifest>
  CheckpointStore::newest(std::vector<std::string> &remarks) const
  {
    std::vector<unsigned int> candidates;
    fail_together(communicator, [&]() {
      if (rank == 0)
        for (const Entry &entry : entries())
          if (entry.is_complete)
            candidates.push_back(entry.n);
    });
    candidates = Utilities::MPI::broadcast(communicator, candidates);
    std::reverse(candidates.begin(), candidates.end());
    for (const unsigned int n : candidates)
      {
        std::string        text;
        CheckpointManifest manifest;
        try
          {
            // Only rank 0 reads: all ranks have to see the same text.
            fail_together(communicator, [&]() {
              if (rank == 0)
                text = read_file(path(n) + '/' + manifest_name);
            });
            text = Utilities::MPI::broadcast(communicator, text);
            fail_together(communicator, [&]() {
              manifest = CheckpointManifest::of_text(text);
              if (manifest.n != n)
                refuse("it is of step " + std::to_string(manifest.n));
              for (std::size_t i = rank; i < manifest.files.size();
                   i += n_ranks)
                read_checked(path(n) + '/', manifest.files[i]);
            });
            return manifest;
          }
        catch (const std::exception &exception)
          {
            std::string why = reason(exception);
            if (why.back() == '.')
              why.pop_back();
            remarks.push_back("the checkpoint '" + path(n) +
                              "' cannot be used: " + why);
          }
      }
    return {};
  }



  std::string
  CheckpointStore::read(const CheckpointManifest &manifest,
                        const std::string        &name) const
  {
    for (const auto &file : manifest.files)
      if (file.name == name)
        return read_checked(path(manifest.n) + '/', file);
    refuse("The checkpoint has no file " + name + ".");
  }



  CheckpointStore::Removal
  CheckpointStore::remove_others(const unsigned int n,
                                 const unsigned int n_kept) const
  {
    Removal removal;
    fail_together(communicator, [&]() {
      if (rank != 0)
        return;
      const std::vector<Entry> found = entries();
      try
        {
          for (const Entry &entry : found)
            if ((n_kept == 0 || entry.n > n || !entry.is_complete) &&
                remove_own(entry.path, removal.remarks) && entry.is_complete)
              ++removal.n_checkpoints;
          if (n_kept > 0)
            remove_before(n, n_kept, removal.remarks);
        }
      catch (const std::exception &exception)
        {
          refuse("Old checkpoints in '" + directory +
                 "' cannot be removed: " + reason(exception));
        }
    });
    removal.n_checkpoints =
      Utilities::MPI::broadcast(communicator, removal.n_checkpoints);
    removal.remarks = Utilities::MPI::broadcast(communicator, removal.remarks);
    return removal;
  }



  void
  CheckpointStore::remove_before(const unsigned int        n,
                                 const unsigned int        n_kept,
                                 std::vector<std::string> &remarks) const
  {
    std::vector<std::string> older;
    for (const Entry &entry : entries())
      if (entry.is_complete && entry.n < n && !own_files(entry.path).empty())
        older.push_back(entry.path);
    for (std::size_t i = 0; i + n_kept <= older.size(); ++i)
      remove_own(older[i], remarks);
  }
} // namespace Viscoplastic
