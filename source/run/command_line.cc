// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/config.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/run/command_line.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// Return the path of a file that comes with the program, relative to the
    /// working directory if it is inside of that.
    std::string
    source_path(const std::string &path)
    {
      const std::string full = path_of_resource(path);
      if (full.empty())
        return path;
      std::error_code   error;
      const std::string from_here =
        std::filesystem::proximate(full, error).string();
      return error || from_here.compare(0, 2, "..") == 0 ? full : from_here;
    }


    /// Options with the values that may follow `=', and options that require a
    /// value, which follows `=' or is the next argument.
    const std::map<std::string, std::vector<std::string>> flags{
      {"--help", {}},
      {"--version", {}},
      {"--describe", {"prm", "json"}},
      {"--check", {"json", "means"}},
      {"--quiet", {}},
      {"--verbose", {}},
      {"--restart", {"auto"}}};
    const std::map<std::string, std::string> with_value{
      {"--set", "'Section/Entry=value'"},
      {"--log", "the name of a file"}};



    using Task    = CommandLine::Task;
    using Restart = CommandLine::Restart;



    void
    read_file(const std::string &argument, CommandLine &result)
    {
      std::error_code error;
      if (argument.find('=') != std::string::npos &&
          !std::filesystem::exists(argument, error))
        refuse("There is no parameter file '" + excerpt(argument) +
               "'; to give an entry a value write --set '" + excerpt(argument) +
               "'.");
      result.files.push_back(argument);
    }



    void
    read_option(const std::string &option,
                const std::string &value,
                CommandLine       &result)
    {
      if (option == "--set")
        {
          result.overrides.push_back(value);
          return;
        }
      if (value.empty())
        refuse("The option --log needs the name of a file after it.");
      if (std::filesystem::path(value).extension() == ".prm")
        refuse("The option --log would overwrite '" + excerpt(value) +
               "', which looks like a parameter file; choose another name.");
      result.log = value;
    }



    /// Read an option; @p value is the text after '=', or null. @p of_task is
    /// the option that has set the task, empty if none has.
    void
    read_flag(const std::string &option,
              const std::string *value,
              std::string       &of_task,
              CommandLine       &result)
    {
      const auto flag = flags.find(option);
      if (flag == flags.end())
        {
          std::vector<std::string> options;
          for (const auto &known : flags)
            options.push_back(known.first);
          for (const auto &known : with_value)
            options.push_back(known.first);
          const std::string nearest = nearest_name(option, options);
          refuse("There is no option '" + excerpt(option) + "'; " +
                 (nearest.empty() ?
                    "the options are " + enumeration(options) + "." :
                    "did you mean " + nearest + "?"));
        }
      const std::string               text   = value ? *value : "";
      const std::vector<std::string> &values = flag->second;
      if (value != nullptr &&
          std::find(values.begin(), values.end(), text) == values.end())
        refuse("The option " + option +
               (values.empty() ?
                  " has no value, such as '" :
                  " can have the value" +
                    (values.size() > 1 ?
                       "s " + values.front() + " and " + values.back() :
                       ' ' + values.front()) +
                    ", not '") +
               excerpt(text) + "'.");
      if (option == "--quiet")
        result.quiet = true;
      else if (option == "--verbose")
        result.verbose = true;
      else if (option == "--restart")
        result.restart = text == "auto" ? Restart::automatic : Restart::yes;
      else
        {
          if (!of_task.empty() && of_task != option)
            refuse("The options " + of_task + " and " + option +
                   " exclude each other.");
          of_task           = option;
          result.with_means = text == "means";
          result.task       = option == "--help" ?
                                Task::help :
                              option == "--version" ?
                                Task::version :
                              option == "--check" ?
                                (text.empty() ? Task::check : Task::print_scene) :
                              text == "json" ? Task::describe_as_json :
                                               Task::describe;
        }
    }



    /// Throw ExcMessage for options and files that exclude each other.
    void
    check(const CommandLine &line, const std::string &of_task)
    {
      const bool describes =
        line.task == Task::describe || line.task == Task::describe_as_json;
      const bool reads_scene = line.task == Task::run ||
                               line.task == Task::check ||
                               line.task == Task::print_scene;
      if (reads_scene && line.files.empty())
        refuse("There is no parameter file among the arguments; write "
               "viscoplastic_contact [options] scene.prm.");
      if (line.task != Task::run && line.restart != Restart::no)
        refuse("The options " + of_task + " and --restart exclude each other.");
      if (!reads_scene && (!describes || line.files.empty()) &&
          (!line.files.empty() || !line.overrides.empty()))
        refuse("The option " + of_task + " goes without " +
               (describes ? "--set where there is no parameter file." :
                            "parameter files and --set."));
    }
  } // namespace



  CommandLine
  read_command_line(const std::vector<std::string> &arguments)
  {
    CommandLine result;
    if (arguments.empty())
      result.task = Task::guide;
    std::string of_task;
    bool        only_files = false;
    for (std::size_t i = 0; i < arguments.size(); ++i)
      {
        const std::string &argument = arguments[i];
        if (only_files || argument.empty() || argument[0] != '-')
          read_file(argument, result);
        else if (argument == "--")
          only_files = true;
        else
          {
            const std::size_t equals    = argument.find('=');
            const bool        has_value = equals != std::string::npos;
            std::string       option    = argument.substr(0, equals),
                        value = has_value ? argument.substr(equals + 1) : "";
            if (option == "-h")
              option = "--help";
            const auto needed = with_value.find(option);
            if (needed == with_value.end())
              {
                read_flag(option,
                          has_value ? &value : nullptr,
                          of_task,
                          result);
                continue;
              }
            if (!has_value)
              {
                if (i + 1 >= arguments.size())
                  refuse("The option " + option + " needs " + needed->second +
                         " after it.");
                value = arguments[++i];
              }
            read_option(option, value, result);
          }
      }
    check(result, of_task);
    return result;
  }



  std::string
  help_text()
  {
    return R"(Usage: viscoplastic_contact [options] scene.prm [more.prm ...]

Computes the scene that the parameter file describes. Further files override
entries of the earlier ones. The scripts contrib/study, contrib/effects and
contrib/price say what accuracy costs, what each effect changes, and which mesh
and steps reach an error.

  --set 'SECTION/ENTRY=VALUE'  override an entry of the files; may be repeated
  --check[=json]               validate the scene and print its effects, size,
                               solver and memory, without computing it; =json:
                               its values and its mesh, for programs; =means:
                               the means of its data, too
  --describe[=json]            print a parameter file with every entry, its
                               meaning, unit, default and allowed values;
                               for a scene, with its values and the laws of
                               its shared libraries
  --restart                    go on from the last checkpoint of this scene
  --restart=auto               the same, or begin where there is none
  --quiet                      print nothing but errors
  --verbose                    a line for each step, also of long runs
  --log FILE                   write the messages to FILE, too
  --version                    print version and libraries
  -h, --help                   print this text
  --                           what follows are files

Results go to 'Output/Directory', by default output/<scene>/ in the working
directory. Exit codes: 0 every step was solved to its tolerance, 1 something
was wrong (one sentence says what), 2 wrong arguments, 3 ended by SIGTERM or
SIGINT after a checkpoint.

In parallel: mpirun -n 4 viscoplastic_contact scene.prm

Manual: )" +
           source_path("doc/index.md") + '\n';
  }



  std::string
  guide_text()
  {
    const std::string demo = source_path("prm/demos/salt_pillar_2d.prm");
    return R"(viscoplastic_contact computes how elastic-viscoplastic bodies deform slowly, in
contact with friction on rigid foundations. A parameter file describes the scene.

Run a demo (seconds; the results are for ParaView):
    viscoplastic_contact )" +
           demo + R"(
See whether a scene is right, and how large, before it runs:
    viscoplastic_contact --check )" +
           demo + R"(
Begin a scene of your own from a file with every entry explained:
    viscoplastic_contact --describe > my_scene.prm

Other demos are in )" +
           source_path("prm/demos") + ", the manual begins at\n" +
           source_path("README.md") + " and " + source_path("doc/scene.md") +
           ".\nAll options: viscoplastic_contact --help\n";
  }



  std::string
  version_text()
  {
    return "viscoplastic_contact " + std::string(program_version) + " (" +
           git_revision + "), deal.II " DEAL_II_PACKAGE_VERSION "\n";
  }
} // namespace Viscoplastic
