// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/laws/law_interface.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <string>
#include <vector>

/// Makes a shared library of laws from a file outside of the program:
///
///     VISCOPLASTIC_LAW_LIBRARY(Viscoplastic::garofalo_description())
///
/// with the descriptions of all its laws, separated by commas, stands once in
/// the library, outside of all functions. A parameter file names the library in
/// `Additional shared libraries'. See doc/adding_a_law.md.
#define VISCOPLASTIC_LAW_LIBRARY(...)                         \
  extern "C" const char *viscoplastic_contact_law_interface() \
  {                                                           \
    return VISCOPLASTIC_CONTACT_LAW_INTERFACE;                \
  }                                                           \
  extern "C" void viscoplastic_contact_describe_laws(         \
    std::vector<Viscoplastic::LawDescription> &laws)          \
  {                                                           \
    laws = {__VA_ARGS__};                                     \
  }

namespace Viscoplastic
{
  /// The laws of a shared library, which stays loaded until the program ends.
  /// Throws ExcMessage if @p file cannot be loaded, is no library of laws, or
  /// was built for another version of this program.
  std::vector<LawDescription>
  load_laws(const std::string &file);

  /// The laws of the program and of these libraries, in this order. Throws
  /// ExcMessage as load_laws() does, or if the name of a law is invalid or that
  /// of another law.
  std::vector<LawDescription>
  laws_with_libraries(const std::vector<std::string> &files);
} // namespace Viscoplastic
