// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace Viscoplastic
{
  /// Version of the program, e.g. 0.1.0, and what `git describe` said of its
  /// sources; a file of their own, so that a commit changes no other object.
  extern const char *const program_version, *const git_revision;
} // namespace Viscoplastic
