// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/checkpoint/checkpoint_manifest.h>

#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;

  const std::string first_words_of_manifests =
    "viscoplastic_contact checkpoint ";

  namespace
  {
    const std::string first_line = first_words_of_manifests + "15";
  }



  std::string
  CheckpointManifest::text() const
  {
    std::ostringstream text;
    text << first_line << "\nversion " << version << "\ndimension " << dimension
         << "\nranks " << n_ranks << "\nstep " << n << "\ntime "
         << std::setprecision(17) << t << '\n';
    for (const auto &file : files)
      text << "file " << file.name << ' ' << file.size << ' ' << file.checksum
           << '\n';
    for (const auto &[path, value] : parameters)
      text << "set " << path << " = " << value << '\n';
    const std::uint32_t sum = checksum(text.str());
    text << "checksum " << sum << '\n';
    return text.str();
  }



  CheckpointManifest
  CheckpointManifest::of_text(const std::string &text)
  {
    const auto require_sense = [](const bool condition) {
      if (!condition)
        refuse("the manifest is damaged");
    };
    if (text.compare(0, first_line.size() + 1, first_line + '\n') != 0)
      refuse("its format is that of another version of the program");
    const std::size_t last = text.rfind("\nchecksum ");
    require_sense(last != std::string::npos &&
                  text.substr(last + 1) ==
                    "checksum " +
                      std::to_string(checksum(text.substr(0, last + 1))) +
                      '\n');

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
            require_sense(equals != std::string::npos && equals >= 4);
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
            require_sense(file.name.find('/') == std::string::npos);
            manifest.files.push_back(file);
          }
        require_sense(!words.fail());
      }
    return manifest;
  }
} // namespace Viscoplastic
