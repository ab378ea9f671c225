// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The candidate that @p name was probably meant to be; empty if none is
  /// near. Case, blanks and punctuation do not count, and the beginning of a
  /// long name is near to it.
  std::string
  nearest_name(const std::string              &name,
               const std::vector<std::string> &candidates);

  /// The identifier (letters, digits and underscores, no digit first) that
  /// begins at @p begin of @p text; empty if none begins there.
  std::string
  identifier_at(const std::string &text, const std::size_t begin);

  /// Whether the identifier @p name stands in @p text by itself, not as a part
  /// of a longer one.
  bool
  mentions(const std::string &text, const std::string &name);

  /// A text from outside as part of a sentence: on one line, without control
  /// characters, and shortened to @p longest characters.
  std::string
  excerpt(const std::string &text, const std::size_t longest = 60);

  /// `a, b, c'; the first @p n_max of them if there are more.
  std::string
  enumeration(const std::vector<std::string> &names,
              const unsigned int              n_max = 20);
} // namespace Viscoplastic
