// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The options and files among the arguments of the program.
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
    /// Whether each step is printed, even if it is like the previous one.
    bool verbose = false;
    /// Whether to continue from a checkpoint: no; yes, throwing if there is
    /// none; or automatically, if there is one.
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
  /// Boost.Program_options would save a tenth of the code at the price of a
  /// library: it finds unknown and missing options, but checks of combinations
  /// and most sentences would remain, since its messages do not tell what is
  /// missing. It prints optional values as `[=arg(=value)]'.
  CommandLine
  read_command_line(const std::vector<std::string> &arguments);

  /// The text that `--help' prints.
  std::string
  help_text();

  /// The text that the program prints without arguments: first steps.
  std::string
  guide_text();

  /// Name, version and revision of the program, and version of deal.II.
  std::string
  version_text();
} // namespace Viscoplastic
