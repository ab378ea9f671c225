// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <string>
#include <utility>

namespace Viscoplastic
{
  /// The names of the physical groups of a mesh file of Gmsh, by dimension and
  /// tag; none where the file is of another format or has no such section.
  std::map<std::pair<unsigned int, unsigned int>, std::string>
  physical_names(const std::string &file);
} // namespace Viscoplastic
