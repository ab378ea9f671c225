// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A statement of a parameter file or of the command line.
  struct ParameterLine
  {
    /// The name of the file and the line number, or the option and 0.
    std::string  source;
    unsigned int number;
    /// The text as ParameterHandler reads it, on one line and without comment.
    std::string text;
    /// The enclosing subsections, each followed by `/'.
    std::string section;
    /// The name of the entry that the line sets or of the subsection that it
    /// opens, if any.
    std::string name       = {};
    std::string value      = {};
    bool        is_opening = false;

    bool
    sets_entry() const
    {
      return !is_opening && !name.empty();
    }

    /// The path `Section/Entry' of the entry.
    std::string
    path() const
    {
      return section + name;
    }

    /// Return the absolute path of a file that the line names, relative to the
    /// directory of the parameter file or to the working directory. Throws
    /// ExcMessage if it is in neither.
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

  /// Return the last line that sets an entry, given by its path; null if none
  /// does.
  const ParameterLine *
  last_line(const std::vector<ParameterLine> &lines, const std::string &path);

  /// Return the statements for ParameterHandler: those of the files, with
  /// included files in place, then the assignments `Section/Entry=value' of the
  /// command line. ParameterHandler checks names and values. In addition,
  /// includes are relative to the including file and must close the subsections
  /// that they open, the same entry twice in one file is an error, and
  /// `Boundary 03' becomes `Boundary 3'.
  ///
  /// Throws ExcMessage with file and line.
  std::vector<ParameterLine>
  read_parameter_lines(const std::vector<std::string> &files,
                       const std::vector<std::string> &assignments);
} // namespace Viscoplastic
