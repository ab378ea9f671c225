// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/signals.h>
#include <viscoplastic_contact/laws/law_library.h>

#include <dlfcn.h>

#include <algorithm>
#include <cctype>

namespace Viscoplastic
{
  namespace
  {
    /// Return the message of dlerror() without the leading name of the file.
    std::string
    loader_message(const std::string &file)
    {
      const char       *words = dlerror();
      std::string       text  = words == nullptr ? "no reason is known" : words;
      const std::string name  = file + ": ";
      if (text.compare(0, name.size(), name) == 0)
        text.erase(0, name.size());
      return text;
    }



    /// Throw unless @p name is valid and not taken, as `elastic' is, too.
    void
    check_name(const std::string                 &name,
               const std::vector<LawDescription> &others,
               const std::string                 &file)
    {
      const bool is_word =
        !name.empty() &&
        std::all_of(name.begin(), name.end(), [](const unsigned char c) {
          return std::isalnum(c) != 0 || c == '_';
        });
      if (!is_word)
        refuse("the shared library '" + file + "' has a law with the name '" +
               excerpt(name) +
               "'; names of laws have letters, digits and underscores.");
      const std::string taken = '|' + viscoplastic_law_names(others) + '|';
      if (taken.find('|' + name + '|') != std::string::npos)
        refuse("the shared library '" + file + "' has a law with the name '" +
               name + "', which another law has; the laws without it are " +
               viscoplastic_law_names(others) + ".");
    }
  } // namespace



  std::vector<LawDescription>
  load_laws(const std::string &file)
  {
    const UnexpectedEnd unexpected_end("loading the shared library '" + file +
                                       "'");
    // RTLD_NOW resolves all symbols, so that a missing function cannot end a
    // run later. The library stays loaded, since laws are used until the end.
    void *library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
      refuse("the shared library '" + file +
             "' cannot be loaded: " + excerpt(loader_message(file), 300) +
             ". Laws have to be built for this version of the program.");

    const auto interface = reinterpret_cast<const char *(*)()>(
      dlsym(library, "viscoplastic_contact_law_interface"));
    const auto describe =
      reinterpret_cast<void (*)(std::vector<LawDescription> &)>(
        dlsym(library, "viscoplastic_contact_describe_laws"));
    if (interface == nullptr || describe == nullptr)
      refuse(
        "the shared library '" + file +
        "' has no laws: VISCOPLASTIC_LAW_LIBRARY is missing in its source.");
    const char       *version = interface();
    const std::string theirs  = version == nullptr ? "0" : version;
    if (theirs != VISCOPLASTIC_CONTACT_LAW_INTERFACE)
      refuse("the shared library '" + file + "' was built for version " +
             excerpt(theirs) +
             " of the laws' interface, but this program has " +
             VISCOPLASTIC_CONTACT_LAW_INTERFACE + "; build it again.");
    std::vector<LawDescription> laws;
    describe(laws);
    for (const LawDescription &law : laws)
      if (!law.declare || !law.make)
        refuse("the law '" + excerpt(law.name) + "' of the shared library '" +
               file +
               "' has no function 'declare' or 'make' in its description.");
    return laws;
  }



  std::vector<LawDescription>
  laws_with_libraries(const std::vector<std::string> &files)
  {
    std::vector<LawDescription> laws = built_in_laws();
    for (const std::string &file : files)
      for (LawDescription &law : load_laws(file))
        {
          check_name(law.name, laws, file);
          laws.push_back(std::move(law));
        }
    return laws;
  }
} // namespace Viscoplastic
