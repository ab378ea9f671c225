// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/checkpoint_store.h>
#include <viscoplastic_contact/messages.h>
#include <viscoplastic_contact/spelling.h>

#include <boost/crc.hpp>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;
  namespace fs = std::filesystem;

  namespace
  {
    const std::string manifest_name = "manifest.txt";
    const std::string first_line    = "viscoplastic_contact checkpoint 1";
    const std::string unfinished = ".unfinished", outdated = ".outdated";



    std::uint32_t
    checksum(const std::string &bytes)
    {
      boost::crc_32_type crc;
      crc.process_bytes(bytes.data(), bytes.size());
      return crc.checksum();
    }



    /// A file descriptor that is put to disk and closed, with errors.
    class Descriptor
    {
    public:
      Descriptor(const std::string &name, const int flags)
        : name(name)
        , descriptor(open(name.c_str(), flags | O_CLOEXEC, 0666))
      {
        check(descriptor >= 0);
      }

      ~Descriptor()
      {
        if (descriptor >= 0)
          close(descriptor);
      }

      Descriptor(const Descriptor &) = delete;
      Descriptor &
      operator=(const Descriptor &) = delete;

      void
      write_all(const std::string &bytes) const
      {
        std::size_t written = 0;
        while (written < bytes.size())
          {
            const ssize_t n =
              write(descriptor, bytes.data() + written, bytes.size() - written);
            check(n > 0 || errno == EINTR);
            written += std::max<ssize_t>(n, 0);
          }
      }

      void
      synchronise() const
      {
        // Some file systems cannot do it for directories.
        check(fsync(descriptor) == 0 || errno == EINVAL);
      }

    private:
      void
      check(const bool success) const
      {
        AssertThrow(success,
                    ExcMessage("'" + name + "' cannot be written: " +
                               std::strerror(errno) + "."));
      }

      const std::string name;
      const int         descriptor;
    };



    void
    write_file(const std::string &name, const std::string &bytes)
    {
      Descriptor file(name, O_WRONLY | O_CREAT | O_TRUNC);
      file.write_all(bytes);
      file.synchronise();
    }



    void
    synchronise_directory(const std::string &name)
    {
      Descriptor(name, O_RDONLY | O_DIRECTORY).synchronise();
    }



    std::string
    read_file(const std::string &name)
    {
      std::ifstream file(name, std::ios::binary);
      AssertThrow(file, ExcMessage("'" + name + "' cannot be read."));
      std::ostringstream bytes;
      bytes << file.rdbuf();
      return bytes.str();
    }



    std::string
    read_checked(const std::string              &directory,
                 const CheckpointManifest::File &file)
    {
      std::error_code error;
      const auto      size = fs::file_size(directory + file.name, error);
      AssertThrow(!error,
                  ExcMessage("the file " + excerpt(file.name) + " is missing"));
      AssertThrow(size == file.size,
                  ExcMessage("the file " + excerpt(file.name) + " has " +
                             std::to_string(size) + " bytes instead of " +
                             std::to_string(file.size)));
      std::string bytes = read_file(directory + file.name);
      AssertThrow(bytes.size() == file.size && checksum(bytes) == file.checksum,
                  ExcMessage("the file " + excerpt(file.name) +
                             " does not have its checksum"));
      return bytes;
    }



    /// What went wrong on the first rank where something did, on all ranks.
    std::string
    common_failure(const std::string &failure, const MPI_Comm communicator)
    {
      for (const std::string &text :
           Utilities::MPI::all_gather(communicator, failure))
        if (!text.empty())
          return text;
      return "";
    }



    /// Call @p action and return what went wrong.
    template <typename Action>
    std::string
    attempt(const Action &action)
    {
      try
        {
          action();
        }
      catch (const std::exception &exception)
        {
          return reason(exception);
        }
      return "";
    }



    std::string
    to_text(const CheckpointManifest &manifest)
    {
      std::ostringstream text;
      text << first_line << "\nversion " << manifest.version << "\ndimension "
           << manifest.dimension << "\nranks " << manifest.n_ranks << "\nstep "
           << manifest.n << "\ntime " << std::setprecision(17) << manifest.t
           << '\n';
      for (const auto &file : manifest.files)
        text << "file " << file.name << ' ' << file.size << ' ' << file.checksum
             << '\n';
      for (const auto &[path, value] : manifest.parameters)
        text << "set " << path << " = " << value << '\n';
      const std::uint32_t sum = checksum(text.str());
      text << "checksum " << sum << '\n';
      return text.str();
    }



    CheckpointManifest
    from_text(const std::string &text)
    {
      const auto require = [](const bool condition) {
        AssertThrow(condition, ExcMessage("the manifest is damaged"));
      };
      AssertThrow(text.compare(0, first_line.size() + 1, first_line + '\n') ==
                    0,
                  ExcMessage("its format is not that of this program"));
      const std::size_t last = text.rfind("\nchecksum ");
      require(last != std::string::npos &&
              text.substr(last + 1) ==
                "checksum " +
                  std::to_string(checksum(text.substr(0, last + 1))) + '\n');

      CheckpointManifest manifest;
      std::istringstream lines(text.substr(0, last + 1));
      std::string        line;
      std::getline(lines, line);
      while (std::getline(lines, line))
        {
          std::istringstream words(line);
          std::string        key;
          words >> key;
          if (key == "set")
            {
              const std::size_t equals = line.find(" = ");
              require(equals != std::string::npos && equals >= 4);
              manifest.parameters[line.substr(4, equals - 4)] =
                line.substr(equals + 3);
              continue;
            }
          if (key == "version")
            std::getline(words >> std::ws, manifest.version);
          else if (key == "dimension")
            words >> manifest.dimension;
          else if (key == "ranks")
            words >> manifest.n_ranks;
          else if (key == "step")
            words >> manifest.n;
          else if (key == "time")
            words >> manifest.t;
          else if (key == "file")
            {
              CheckpointManifest::File file;
              words >> file.name >> file.size >> file.checksum;
              require(file.name.find('/') == std::string::npos);
              manifest.files.push_back(file);
            }
          require(!words.fail());
        }
      return manifest;
    }
  } // namespace



  CheckpointStore::CheckpointStore(const std::string &directory,
                                   const MPI_Comm     communicator)
    : directory(directory.back() == '/' ? directory : directory + '/')
    , communicator(communicator)
    , rank(Utilities::MPI::this_mpi_process(communicator))
    , n_ranks(Utilities::MPI::n_mpi_processes(communicator))
  {}



  std::string
  CheckpointStore::path(const unsigned int n) const
  {
    return directory + "step_" + Utilities::int_to_string(n, 6);
  }



  std::vector<unsigned int>
  CheckpointStore::steps() const
  {
    std::vector<unsigned int> result;
    std::error_code           error;
    for (const auto &entry : fs::directory_iterator(directory, error))
      {
        const std::string name = entry.path().filename().string();
        const std::string digits =
          name.substr(std::min<std::size_t>(name.size(), std::strlen("step_")));
        if (digits.size() < 6 || digits.size() > 9 ||
            digits.find_first_not_of("0123456789") != std::string::npos)
          continue;
        const unsigned int n = std::stoul(digits);
        if (directory + name == path(n))
          result.push_back(n);
      }
    std::sort(result.begin(), result.end());
    return result;
  }



  void
  CheckpointStore::make_directory() const
  {
    const std::string failure =
      common_failure(attempt([&]() {
                       if (rank == 0)
                         fs::create_directories(directory);
                     }),
                     communicator);
    AssertThrow(failure.empty(),
                ExcMessage("The directory '" + directory +
                           "' for checkpoints cannot be written; change "
                           "'Checkpoint/Directory' or its permissions."));
  }



  void
  CheckpointStore::write(CheckpointManifest                        manifest,
                         const std::map<std::string, std::string> &files,
                         const unsigned int                        n_kept) const
  {
    const std::string final_path = path(manifest.n);
    const std::string temporary  = final_path + unfinished + '/';
    const auto        check      = [&](const std::string &failure) {
      const std::string text = common_failure(failure, communicator);
      if (text.empty())
        return;
      // Make room; the checkpoints before are what counts.
      std::error_code ignored;
      if (rank == 0)
        fs::remove_all(temporary, ignored);
      AssertThrow(false,
                  ExcMessage("The checkpoint of step " +
                             std::to_string(manifest.n) + " failed: " + text));
    };

    check(attempt([&]() {
      if (rank != 0)
        return;
      fs::remove_all(temporary);
      fs::create_directories(temporary);
    }));

    std::vector<CheckpointManifest::File> mine;
    check(attempt([&]() {
      for (const auto &[name, bytes] : files)
        {
          write_file(temporary + name, bytes);
          mine.push_back({name, bytes.size(), checksum(bytes)});
        }
    }));

    std::ostringstream description;
    for (const auto &file : mine)
      description << file.name << ' ' << file.size << ' ' << file.checksum
                  << ' ';
    const auto all = Utilities::MPI::gather(communicator, description.str());
    check(attempt([&]() {
      if (rank != 0)
        return;
      manifest.files.clear();
      for (const std::string &part : all)
        {
          std::istringstream       words(part);
          CheckpointManifest::File file;
          while (words >> file.name >> file.size >> file.checksum)
            manifest.files.push_back(file);
        }
      write_file(temporary + manifest_name, to_text(manifest));
      synchronise_directory(temporary);
      // A directory cannot replace another one.
      std::error_code none;
      if (fs::exists(final_path, none))
        {
          fs::remove_all(final_path + outdated);
          fs::rename(final_path, final_path + outdated);
        }
      fs::rename(temporary, final_path);
      synchronise_directory(directory);

      fs::remove_all(final_path + outdated);
      std::vector<unsigned int> older = steps();
      older.erase(std::remove_if(older.begin(),
                                 older.end(),
                                 [&](const unsigned int n) {
                                   return n >= manifest.n;
                                 }),
                  older.end());
      for (std::size_t i = 0; i + n_kept <= older.size(); ++i)
        fs::remove_all(path(older[i]));
    }));
  }



  std::optional<CheckpointManifest>
  CheckpointStore::newest(std::vector<std::string> &remarks) const
  {
    std::vector<unsigned int> candidates =
      Utilities::MPI::broadcast(communicator, steps());
    std::reverse(candidates.begin(), candidates.end());
    for (const unsigned int n : candidates)
      {
        // Rank 0 reads, so that all see the same.
        std::string text, failure;
        if (rank == 0)
          failure =
            attempt([&]() { text = read_file(path(n) + '/' + manifest_name); });
        text = Utilities::MPI::broadcast(communicator, text);
        CheckpointManifest manifest;
        if (failure.empty())
          failure = attempt([&]() {
            manifest = from_text(text);
            AssertThrow(manifest.n == n,
                        ExcMessage("it is of step " +
                                   std::to_string(manifest.n)));
            for (std::size_t i = rank; i < manifest.files.size(); i += n_ranks)
              read_checked(path(n) + '/', manifest.files[i]);
          });
        failure = common_failure(failure, communicator);
        if (failure.empty())
          return manifest;
        if (failure.back() == '.')
          failure.pop_back();
        remarks.push_back("the checkpoint '" + path(n) +
                          "' cannot be used: " + failure);
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
    AssertThrow(false, ExcMessage("The checkpoint has no file " + name + "."));
    return "";
  }



  unsigned int
  CheckpointStore::remove_if(const bool all, const unsigned int after) const
  {
    unsigned int      n_removed = 0;
    const std::string failure   = attempt([&]() {
      if (rank != 0)
        return;
      for (const unsigned int n : steps())
        if (all || n > after)
          {
            fs::remove_all(path(n));
            ++n_removed;
          }
      std::error_code       none;
      std::vector<fs::path> rests;
      for (const auto &entry : fs::directory_iterator(directory, none))
        for (const std::string &suffix : {unfinished, outdated})
          if (entry.path().filename().string().compare(0, 5, "step_") == 0 &&
              entry.path().extension() == suffix)
            rests.push_back(entry.path());
      for (const fs::path &rest : rests)
        fs::remove_all(rest);
    });
    const std::string text = common_failure(failure, communicator);
    AssertThrow(text.empty(),
                ExcMessage("Old checkpoints in '" + directory +
                           "' cannot be removed: " + text));
    return Utilities::MPI::broadcast(communicator, n_removed);
  }



  unsigned int
  CheckpointStore::remove_after(const unsigned int n) const
  {
    return remove_if(false, n);
  }



  unsigned int
  CheckpointStore::remove_all() const
  {
    return remove_if(true, 0);
  }



  void
  synchronise(const std::string &file)
  {
    Descriptor(file, O_RDONLY).synchronise();
  }
} // namespace Viscoplastic
