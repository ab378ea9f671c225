// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace Viscoplastic::Testing
{
  /// Files in a directory of their own.
  class Folder
  {
  public:
    Folder()
    {
      std::string pattern =
        std::filesystem::temp_directory_path() / "unit_XXXXXX";
      path = mkdtemp(pattern.data());
    }

    ~Folder()
    {
      std::filesystem::remove_all(path);
    }

    /// The full name of a new file.
    std::string
    add(const std::string &name, const std::string &text) const
    {
      std::filesystem::create_directories((path / name).parent_path());
      std::ofstream(path / name) << text;
      return (path / name).string();
    }

    std::filesystem::path path;
  };
} // namespace Viscoplastic::Testing
