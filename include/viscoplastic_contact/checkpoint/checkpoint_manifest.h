// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The description of a checkpoint, stored in its directory: program, scene,
  /// step and files.
  struct CheckpointManifest
  {
    /// Number and end time of the step after which the checkpoint was written.
    unsigned int n         = 0;
    double       t         = 0.;
    unsigned int dimension = 0, n_ranks = 0;
    std::string  version;
    /// Every parameter of the run, by `Section/Entry'.
    std::map<std::string, std::string> parameters;

    struct File
    {
      std::string   name;
      std::uint64_t size     = 0;
      std::uint32_t checksum = 0;

      template <typename Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &name &size &checksum;
      }
    };
    std::vector<File> files;

    /// The text of manifest.txt, which ends with a checksum of itself.
    std::string
    text() const;

    /// Throws ExcMessage if the text is damaged or of another version.
    static CheckpointManifest
    of_text(const std::string &text);
  };

  /// The beginning of the text of every manifest, in all versions.
  extern const std::string first_words_of_manifests;
} // namespace Viscoplastic
