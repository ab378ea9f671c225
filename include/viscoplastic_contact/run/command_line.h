// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The arguments of the program, as options and files.
  struct CommandLine
  {
    enum class Task
    {
      guide, // no argument at all
      help,
      version,
      describe,
      describe_as_json,
      check,
      print_scene,
      run
    };

    Task                     task = Task::run;
    std::vector<std::string> files;
    /// Assignments `Section/Entry=value', in their order.
    std::vector<std::string> overrides;
    bool                     quiet = false;
    /// Whether the task print_scene adds mean values of the data.
    bool with_means = false;
    /// Whether each step gets a line, also those like the one before.
    bool verbose = false;
    /// Whether to go on from a checkpoint: not at all, from one that must be
    /// there, or from one if there is any.
    enum class Restart
    {
      no,
      yes,
      automatic
    };
    Restart restart = Restart::no;
    /// Name of the log file; empty for none.
    std::string log;
  };

  /// Read the arguments, without the program's name. Throws ExcMessage with a
  /// sentence for the user.
  ///
  /// Boost.Program_options would make this a tenth shorter, for a library more:
  /// it finds what is unknown or missing, but which options go together, and
  /// the sentences, remain. Its own do not say what is missing, and it shows
  /// options with a value that may be left out as `[=arg(=value)]'.
  CommandLine
  read_command_line(const std::vector<std::string> &arguments);

  /// The text that `--help' prints.
  std::string
  help_text();

  /// The text that the program prints without arguments: how to begin.
  std::string
  guide_text();

  /// Program, version, revision, and what it was built with.
  std::string
  version_text();
} // namespace Viscoplastic
