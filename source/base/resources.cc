// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/resources.h>
#include <viscoplastic_contact/base/source_directory.h>

#include <filesystem>

namespace Viscoplastic
{
  std::string
  path_of_resource(const std::string &name)
  {
    namespace fs = std::filesystem;
    std::error_code error;
    // What an installation has is found wherever it was moved to.
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    for (const fs::path &directory :
         {program.parent_path().parent_path() / "share/viscoplastic_contact",
          fs::path(VISCOPLASTIC_CONTACT_SOURCE_DIRECTORY)})
      if (fs::exists(directory / name, error))
        return (directory / name).string();
    return "";
  }
} // namespace Viscoplastic
