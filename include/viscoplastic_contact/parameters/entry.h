// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <viscoplastic_contact/base/subsection.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// An entry of a section: its name, the variable that it sets and that has
  /// its default, its help text and the values that it allows.
  struct Entry
  {
    template <typename T>
    Entry(const std::string           &name,
          T                           &variable,
          const std::string           &help,
          const Patterns::PatternBase &pattern =
            *Patterns::Tools::Convert<T>::to_pattern())
      : declare([name,
                 &variable,
                 help,
                 allowed = std::shared_ptr<const Patterns::PatternBase>(
                   pattern.clone())](ParameterHandler &prm) {
        prm.add_parameter(name, variable, help, *allowed);
      })
    {}

    /// Entries that @p declare declares by itself.
    explicit Entry(const std::function<void(ParameterHandler &)> &declare)
      : declare(declare)
    {}

    std::function<void(ParameterHandler &)> declare;
  };

  using Entries = std::vector<Entry>;
  /// Sections by their names.
  using Sections = std::vector<std::pair<std::string, Entries>>;

  inline void
  declare_section(ParameterHandler  &prm,
                  const std::string &name,
                  const Entries     &entries)
  {
    const Subsection subsection(prm, name);
    for (const Entry &entry : entries)
      entry.declare(prm);
  }

  inline void
  declare_sections(ParameterHandler &prm, const Sections &sections)
  {
    for (const auto &[name, entries] : sections)
      declare_section(prm, name, entries);
  }
} // namespace Viscoplastic
