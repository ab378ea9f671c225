// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/mesh/files/physical_names.h>

#include <fstream>
#include <regex>

namespace Viscoplastic
{
  std::map<std::pair<unsigned int, unsigned int>, std::string>
  physical_names(const std::string &file)
  {
    std::map<std::pair<unsigned int, unsigned int>, std::string> result;
    std::ifstream                                                input(file);
    std::string                                                  line;
    if (!std::getline(input, line) || line.compare(0, 11, "$MeshFormat") != 0)
      return result;
    // They come before the nodes.
    while (std::getline(input, line) && line.size() < 1000 &&
           line.compare(0, 14, "$PhysicalNames") != 0)
      if (line.compare(0, 6, "$Nodes") == 0)
        return result;
    static const std::regex group("\\s*([0-3])\\s+(\\d{1,9})\\s+\"(.*)\"\\s*");
    std::smatch             match;
    while (std::getline(input, line) && line.size() < 1000 && line[0] != '$')
      if (std::regex_match(line, match, group))
        result[{static_cast<unsigned int>(std::stoul(match[1])),
                static_cast<unsigned int>(std::stoul(match[2]))}] = match[3];
    return result;
  }
} // namespace Viscoplastic
