// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace Viscoplastic
{
  /**
   * The full path of a file that comes with the program, which is named as in
   * the sources ("doc/index.md", "contrib/convert_mesh"): beside an installed
   * program, otherwise where the sources were when it was built. Empty if it is
   * in neither place.
   */
  std::string
  path_of_resource(const std::string &name);
} // namespace Viscoplastic
