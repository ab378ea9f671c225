// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A statement of a parameter file or of the command line.
  struct ParameterLine
  {
    /// The name of the file and the line, or the option and 0.
    std::string  source;
    unsigned int number;
    /// The text as ParameterHandler reads it, on one line and without comment.
    std::string text;
    /// The subsections around it, each with a `/' behind it.
    std::string section;
    /// The name of the entry that the line sets or of the subsection that it
    /// opens, if any.
    std::string name       = {};
    std::string value      = {};
    bool        is_opening = false;

    /// The absolute path of a file that the line names: beside the file that
    /// the line stands in, or in the working directory. Throws ExcMessage if it
    /// is in neither.
    std::string
    locate(const std::string &file) const;

    /// "'scene.prm', line 3" or "--set 'Time/Phases=1: 4'", for messages.
    std::string
    origin() const
    {
      return number == 0 ? source :
                           "'" + source + "', line " + std::to_string(number);
    }
  };

  /// The last line that sets an entry, given by its path; null if none does.
  const ParameterLine *
  last_line(const std::vector<ParameterLine> &lines, const std::string &path);

  /// What ParameterHandler is to read: the statements of some files, with those
  /// that they include in their places, and then of the assignments
  /// `Section/Entry=value' of the command line. Whether names and values are
  /// right is left to ParameterHandler. Here is what it does not do: includes
  /// are relative to the including file and close what they open, the same
  /// entry twice in one file is an error, and `Boundary 03' is `Boundary 3'.
  ///
  /// Throws ExcMessage with file and line.
  std::vector<ParameterLine>
  read_parameter_lines(const std::vector<std::string> &files,
                       const std::vector<std::string> &assignments);
} // namespace Viscoplastic
