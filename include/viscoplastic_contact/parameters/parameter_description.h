// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Return a parameter file with every entry: meaning, unit, default and
  /// allowed values in comments, with `Boundary 0' and `Material 1' for all
  /// ids. It is itself a scene: that of @p files and @p overrides, as
  /// Parameters reads them, or, without files, a square at rest.
  std::string
  describe_parameters(const std::vector<std::string> &files     = {},
                      const std::vector<std::string> &overrides = {});

  /// Return all entries in JSON, without values: an `introduction', the
  /// descriptions of `sections' by name, and the `entries', including those of
  /// laws in shared libraries.
  std::string
  describe_parameters_as_json(const std::vector<std::string> &files     = {},
                              const std::vector<std::string> &overrides = {});
} // namespace Viscoplastic
