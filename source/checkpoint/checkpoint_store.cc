// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/checkpoint/checkpoint_store.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <regex>

namespace Viscoplastic
{
  using namespace dealii;
  namespace fs = std::filesystem;

  namespace
  {
    const std::string  manifest_name = "manifest.txt";
    const std::string  key_of_format = "viscoplastic_contact checkpoint";
    const unsigned int format        = 17;



    /// Whether a directory has a manifest of this program, of any version.
    bool
    is_finished(const fs::path &directory)
    {
      const fs::path  manifest = directory / manifest_name;
      std::error_code none;
      return fs::is_regular_file(manifest, none) &&
             read_file_if_any(manifest).value_or("").find(key_of_format) !=
               std::string::npos;
    }



    /// Remove the files that the program has written in a directory, the
    /// manifest first, and the directory if it is empty then; otherwise adds a
    /// sentence to @p remarks.
    void
    remove_own(const fs::path &directory, std::vector<std::string> &remarks)
    {
      static const std::regex own("manifest[.]txt[.]part|run[.]bin|"
                                  "(mesh|fields|quantity)_[0-9]+[.]bin");
      bool                    has_removed = false;
      if (is_finished(directory))
        has_removed = fs::remove(directory / manifest_name);
      std::vector<std::string> others;
      for (const auto &entry : fs::directory_iterator(directory))
        if (const std::string name = entry.path().filename().string();
            std::regex_match(name, own) &&
            fs::is_regular_file(entry.symlink_status()))
          has_removed = fs::remove(entry.path());
        else
          others.push_back(excerpt(name));
      std::sort(others.begin(), others.end());
      if (others.empty())
        fs::remove(directory);
      else if (has_removed)
        remarks.push_back("Note: '" + directory.string() +
                          "' stays, since this program has not written " +
                          enumeration(others, 3) + " in it.");
    }
  } // namespace



  std::string
  CheckpointManifest::text() const
  {
    nlohmann::ordered_json json{{key_of_format, format},
                                {"version", version},
                                {"ranks", n_ranks},
                                {"step", n},
                                {"time", t},
                                {"files", files},
                                {"parameters", parameters}};
    json["checksum"] = checksum(json_text(json));
    return json_text(json);
  }



  CheckpointManifest
  CheckpointManifest::of_text(const std::string &text)
  {
    CheckpointManifest manifest;
    try
      {
        auto       json = nlohmann::ordered_json::parse(text);
        const auto sum  = json.at("checksum");
        json.erase("checksum");
        if (sum == checksum(json_text(json)) &&
            json.at(key_of_format) == format)
          {
            json.at("version").get_to(manifest.version);
            json.at("ranks").get_to(manifest.n_ranks);
            json.at("step").get_to(manifest.n);
            json.at("time").get_to(manifest.t);
            json.at("files").get_to(manifest.files);
            json.at("parameters").get_to(manifest.parameters);
            return manifest;
          }
      }
    catch (const nlohmann::json::exception &)
      {} // see below
    refuse("the manifest is damaged or of another version of the program");
  }



  CheckpointStore::CheckpointStore(const std::string &directory,
                                   const MPI_Comm     communicator)
    : directory(directory.back() == '/' ? directory : directory + '/')
    , communicator(communicator)
  {}



  void
  CheckpointStore::on_root(const std::function<void()> &work) const
  {
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        work();
    });
  }



  std::map<unsigned int, bool>
  CheckpointStore::steps() const
  {
    static const std::regex      name("step_([0-9]{6,9})");
    std::map<unsigned int, bool> result;
    std::error_code              error;
    fs::directory_iterator       place(directory, error);
    if (error == std::errc::no_such_file_or_directory)
      return result;
    for (; !error && place != fs::directory_iterator(); place.increment(error))
      {
        const std::string file = place->path().filename().string();
        std::smatch       parts;
        if (fs::is_directory(place->symlink_status()) &&
            std::regex_match(file, parts, name))
          result[std::stoul(parts[1])] = is_finished(place->path());
      }
    if (error)
      refuse("The directory '" + directory +
             "' for checkpoints cannot be read: " + error.message() + '.');
    return result;
  }



  void
  CheckpointStore::make_directory() const
  {
    on_root([&]() {
      std::error_code error;
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
    const std::string        place = path(manifest.n) + '/';
    std::vector<std::string> remarks;
    try
      {
        on_root([&]() {
          if (fs::exists(place))
            remove_own(place, remarks);
          fs::create_directories(place);
        });
        fail_together(communicator, [&]() {
          for (const auto &[name, bytes] : files)
            {
              write_file(place + name, bytes);
              manifest.files[name] = {{bytes.size(), checksum(bytes)}};
            }
        });
        for (const auto &part :
             Utilities::MPI::gather(communicator, manifest.files))
          manifest.files.insert(part.begin(), part.end());
        on_root([&]() {
          synchronize_directory(place);
          replace_file(place + manifest_name,
                       manifest.text(),
                       /* to_disk = */ true);
          synchronize_directory(place);
          synchronize_directory(directory);
        });
      }
    catch (const std::exception &exception)
      {
        // Free the space on disk; earlier checkpoints stay.
        if (Utilities::MPI::this_mpi_process(communicator) == 0)
          try
            {
              remove_own(place, remarks);
            }
          catch (const std::exception &)
            {}
        refuse("The checkpoint of step " + std::to_string(manifest.n) +
               " failed: " + reason(exception));
      }
    remarks            = Utilities::MPI::broadcast(communicator, remarks);
    const auto removed = remove_others(manifest.n, n_kept).remarks;
    remarks.insert(remarks.end(), removed.begin(), removed.end());
    return remarks;
  }



  std::optional<CheckpointManifest>
  CheckpointStore::newest(std::vector<std::string> &remarks) const
  {
    std::map<unsigned int, bool> found;
    on_root([&]() { found = steps(); });
    found                      = Utilities::MPI::broadcast(communicator, found);
    const unsigned int rank    = Utilities::MPI::this_mpi_process(communicator),
                       n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    for (auto step = found.rbegin(); step != found.rend(); ++step)
      if (step->second)
        try
          {
            // Only rank 0 reads: all ranks have to see the same text.
            std::string text;
            on_root([&]() {
              text = read_file_if_any(path(step->first) + '/' + manifest_name)
                       .value();
            });
            text = Utilities::MPI::broadcast(communicator, text);
            CheckpointManifest manifest;
            fail_together(communicator, [&]() {
              manifest       = CheckpointManifest::of_text(text);
              manifest.n     = step->first;
              unsigned int i = 0;
              for (const auto &file : manifest.files)
                if (i++ % n_ranks == rank)
                  read(manifest, file.first);
            });
            return manifest;
          }
        catch (const std::exception &exception)
          {
            std::string why = reason(exception);
            if (why.back() == '.')
              why.pop_back();
            remarks.push_back("the checkpoint '" + path(step->first) +
                              "' cannot be used: " + why);
          }
    return {};
  }



  std::string
  CheckpointStore::read(const CheckpointManifest &manifest,
                        const std::string        &name) const
  {
    const auto bytes = read_file_if_any(path(manifest.n) + '/' + name);
    if (!bytes)
      refuse("the file " + excerpt(name) + " is missing");
    const auto expected = manifest.files.at(name);
    if (bytes->size() != expected[0] || checksum(*bytes) != expected[1])
      refuse("the file " + excerpt(name) + " is damaged");
    return *bytes;
  }



  CheckpointStore::Removal
  CheckpointStore::remove_others(const unsigned int n,
                                 const unsigned int n_kept) const
  {
    Removal removal;
    on_root([&]() {
      unsigned int kept  = 0;
      const auto   found = steps();
      try
        {
          for (auto step = found.rbegin(); step != found.rend(); ++step)
            if (step->second && step->first <= n && kept < n_kept)
              ++kept;
            else
              {
                remove_own(path(step->first), removal.remarks);
                removal.n_checkpoints += step->second;
              }
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
} // namespace Viscoplastic
