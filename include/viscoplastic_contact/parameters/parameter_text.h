// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /**
   * A line of a parameter file that opens a subsection or sets an entry, or an
   * assignment on the command line.
   */
  struct ParameterStatement
  {
    struct Section
    {
      std::string  name;
      unsigned int line = 0;
    };

    /// Empty for the command line.
    std::string  file;
    unsigned int line = 0;
    /// The subsections that are open, including one that is opened here.
    std::vector<Section> sections;
    /// Empty where a subsection is opened.
    std::string entry, value;

    /// `Section/Subsection/Entry'.
    std::string
    path() const;

    /// "'scene.prm', line 3" or "--set 'Time/Phases=1: 4'", for messages.
    std::string
    origin() const;
  };

  /**
   * The statements of a file in deal.II's format of parameters, and of those
   * that it includes. In contrast to ParameterHandler::parse_input(), includes
   * are relative to the including file, the same entry twice in one file is an
   * error, and all messages name file and line. Numbers at the end of
   * subsections lose leading zeros, so that `Boundary 03' is `Boundary 3'.
   *
   * Throws ExcMessage.
   */
  std::vector<ParameterStatement>
  read_parameter_text(const std::string &file);

  /// The same for `Section/Entry=value'.
  ParameterStatement
  read_override(const std::string &text);
} // namespace Viscoplastic
