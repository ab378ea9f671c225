// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/config.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/run/command_line.h>

#include <algorithm>
#include <filesystem>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// A file that comes with the program as it can be named from here.
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


    const std::vector<std::string> flags{"--help",
                                         "--version",
                                         "--describe",
                                         "--check",
                                         "--quiet",
                                         "--verbose",
                                         "--restart"};
    const std::vector<std::string> with_value{"--set", "--log"};

    bool
    contains(const std::vector<std::string> &list, const std::string &item)
    {
      return std::find(list.begin(), list.end(), item) != list.end();
    }



    using Task    = CommandLine::Task;
    using Restart = CommandLine::Restart;



    /// Reads one argument after the other.
    class Reader
    {
    public:
      /// Throws ExcMessage, as the other functions do.
      explicit Reader(const std::vector<std::string> &arguments);

      CommandLine result;

    private:
      /// Name the command that has taken the place of an argument of earlier
      /// versions.
      void
      refuse_study(const std::string &argument) const;

      void
      read_file(const std::string &argument);

      /// An option, of which @p value stands behind '=', unless it is null.
      void
      read_flag(const std::string &option, const std::string *value);

      void
      read_option(const std::string &option, const std::string &value);

      void
      set_task(const std::string &option, const std::string &value);

      /// What excludes each other.
      void
      check() const;

      /// The argument that has decided on the task; empty for none.
      std::string task_option;
    };



    Reader::Reader(const std::vector<std::string> &arguments)
    {
      if (arguments.empty())
        result.task = Task::guide;
      bool only_files = false;
      for (std::size_t i = 0; i < arguments.size(); ++i)
        {
          const std::string &argument = arguments[i];
          refuse_study(only_files ? "" : argument);
          if (only_files || argument.empty() || argument[0] != '-')
            {
              read_file(argument);
              continue;
            }
          if (argument == "--")
            {
              only_files = true;
              continue;
            }
          const std::size_t equals = argument.find('=');
          std::string       option = argument.substr(0, equals);
          if (option == "-h")
            option = "--help";
          const bool  has_value = equals != std::string::npos;
          std::string value     = has_value ? argument.substr(equals + 1) : "";
          if (!contains(with_value, option))
            {
              read_flag(option, has_value ? &value : nullptr);
              continue;
            }
          if (!has_value)
            {
              AssertThrow(i + 1 < arguments.size(),
                          ExcMessage("The option " + option +
                                     (option == "--set" ?
                                        " needs 'Section/Entry=value'" :
                                        " needs the name of a file") +
                                     " after it."));
              value = arguments[++i];
            }
          read_option(option, value);
        }
      check();
    }



    void
    Reader::refuse_study(const std::string &argument) const
    {
      const bool is_price =
        argument == "--price" || argument.compare(0, 8, "--price=") == 0;
      const bool is_study = result.files.empty() && task_option.empty() &&
                            (argument == "study" || argument == "effects");
      if (!is_price && !is_study)
        return;
      const std::string name = is_price ? "price" : argument;
      AssertThrow(false,
                  ExcMessage("This is a command of its own: write " +
                             source_path("contrib") + '/' + name +
                             (is_price ? " 0.01 scene.prm." : " scene.prm.")));
    }



    void
    Reader::read_file(const std::string &argument)
    {
      std::error_code error;
      AssertThrow(argument.find('=') == std::string::npos ||
                    std::filesystem::exists(argument, error),
                  ExcMessage("There is no parameter file '" +
                             excerpt(argument) +
                             "'; to give an entry a value write --set '" +
                             excerpt(argument) + "'."));
      result.files.push_back(argument);
    }



    void
    Reader::read_option(const std::string &option, const std::string &value)
    {
      if (option == "--set")
        result.overrides.push_back(value);
      else
        {
          AssertThrow(!value.empty(),
                      ExcMessage("The option --log needs the name of a file "
                                 "after it."));
          AssertThrow(std::filesystem::path(value).extension() != ".prm",
                      ExcMessage("The option --log would overwrite '" +
                                 excerpt(value) +
                                 "', which looks like a parameter file; "
                                 "choose another name."));
          result.log = value;
        }
    }



    void
    Reader::read_flag(const std::string &option, const std::string *value)
    {
      if (!contains(flags, option))
        {
          std::vector<std::string> options(flags);
          options.insert(options.end(), with_value.begin(), with_value.end());
          const std::string nearest = nearest_name(option, options);
          AssertThrow(false,
                      ExcMessage(
                        "There is no option '" + excerpt(option) + "'; " +
                        (nearest.empty() ?
                           "the options are " + enumeration(options) + "." :
                           "did you mean " + nearest + "?")));
        }
      const std::string text = value ? *value : "";
      if (option == "--quiet")
        result.quiet = true;
      else if (option == "--verbose")
        result.verbose = true;
      else if (option == "--restart")
        result.restart = text == "auto" ? Restart::automatic : Restart::yes;
      else
        set_task(option, text);
      AssertThrow(
        value == nullptr ||
          (option == "--describe" && (text == "markdown" || text == "prm")) ||
          (option == "--check" && (text == "json" || text == "means")) ||
          (option == "--restart" && text == "auto"),
        ExcMessage("The option " + option +
                   (option == "--describe" ?
                      " can have the values prm and markdown, not '" :
                    option == "--check" ?
                      " can have the values json and means, not '" :
                    option == "--restart" ? " can have the value auto, not '" :
                                            " has no value, such as '") +
                   excerpt(text) + "'."));
    }



    void
    Reader::set_task(const std::string &option, const std::string &value)
    {
      AssertThrow(task_option.empty() || task_option == option,
                  ExcMessage("The options " + task_option + " and " + option +
                             " exclude each other."));
      task_option       = option;
      result.with_means = value == "means";
      result.task       = option == "--help"    ? Task::help :
                          option == "--version" ? Task::version :
                          option == "--check"   ? (value.empty() ? Task::check :
                                                                   Task::print_scene) :
                          value == "markdown"   ? Task::describe_as_markdown :
                                                  Task::describe;
    }



    void
    Reader::check() const
    {
      const bool describes = result.task == Task::describe ||
                             result.task == Task::describe_as_markdown;
      const bool reads_scene = result.task == Task::run ||
                               result.task == Task::check ||
                               result.task == Task::print_scene;
      AssertThrow(!reads_scene || !result.files.empty(),
                  ExcMessage("There is no parameter file among the arguments; "
                             "write viscoplastic_contact [options] "
                             "scene.prm."));
      AssertThrow(result.task == Task::run || result.restart == Restart::no,
                  ExcMessage("The options " + task_option +
                             " and --restart exclude each other."));
      AssertThrow(reads_scene || (describes && !result.files.empty()) ||
                    (result.files.empty() && result.overrides.empty()),
                  ExcMessage("The option " + task_option + " goes without " +
                             (describes ? "--set where there is no parameter "
                                          "file." :
                                          "parameter files and --set.")));
    }
  } // namespace



  CommandLine
  read_command_line(const std::vector<std::string> &arguments)
  {
    return Reader(arguments).result;
  }



  std::string
  help_text()
  {
    return "Usage: viscoplastic_contact [options] scene.prm [more.prm ...]\n"
           "\n"
           "Computes the scene that the parameter file describes. Further "
           "files override\n"
           "entries of the earlier ones. The scripts contrib/study, "
           "contrib/effects and\n"
           "contrib/price say what accuracy costs, what each effect changes, "
           "and which mesh\n"
           "and steps reach an error.\n"
           "\n"
           "  --set 'SECTION/ENTRY=VALUE'  override an entry of the files; may "
           "be repeated\n"
           "  --check[=json]               validate the scene and print its "
           "effects, size,\n"
           "                               solver and memory, without "
           "computing it; =json:\n"
           "                               its values and its mesh, for "
           "programs; =means:\n"
           "                               the means of its data, too\n"
           "  --describe[=markdown]        print a parameter file with every "
           "entry, its\n"
           "                               meaning, unit, default and allowed "
           "values;\n"
           "                               for a scene, with its values and the "
           "laws of\n"
           "                               its shared libraries\n"
           "  --restart                    go on from the last checkpoint of "
           "this scene\n"
           "  --restart=auto               the same, or begin where there is "
           "none\n"
           "  --quiet                      print nothing but errors\n"
           "  --verbose                    a line for each step, also of long "
           "runs\n"
           "  --log FILE                   write the messages to FILE, too\n"
           "  --version                    print version and libraries\n"
           "  -h, --help                   print this text\n"
           "  --                           what follows are files\n"
           "\n"
           "Results go to 'Output/Directory', by default output/<scene>/ in "
           "the working\n"
           "directory. Exit codes: 0 every step was solved to its tolerance, "
           "1 something\n"
           "was wrong (one sentence says what), 2 wrong arguments, 3 ended by "
           "SIGTERM or\n"
           "SIGINT after a checkpoint.\n"
           "\n"
           "In parallel: mpirun -n 4 viscoplastic_contact scene.prm\n"
           "\n"
           "Manual: " +
           source_path("doc/index.md") + "\n";
  }



  std::string
  guide_text()
  {
    const std::string demo = source_path("prm/demos/salt_pillar_2d.prm");
    return "viscoplastic_contact computes how elastic-viscoplastic bodies "
           "deform slowly, in\n"
           "contact with friction on rigid foundations. A parameter file "
           "describes the scene.\n"
           "\n"
           "Run a demo (seconds; the results are for ParaView):\n"
           "    viscoplastic_contact " +
           demo +
           "\n"
           "See whether a scene is right, and how large, before it runs:\n"
           "    viscoplastic_contact --check " +
           demo +
           "\n"
           "Begin a scene of your own from a file with every entry "
           "explained:\n"
           "    viscoplastic_contact --describe > my_scene.prm\n"
           "\n"
           "Other demos are in " +
           source_path("prm/demos") + ", the manual begins at\n" +
           source_path("README.md") + " and " + source_path("doc/scene.md") +
           ".\nAll options: viscoplastic_contact --help\n";
  }



  std::string
  version_text()
  {
    return "viscoplastic_contact " VISCOPLASTIC_CONTACT_VERSION
           " (" VISCOPLASTIC_CONTACT_GIT_REVISION
           "), deal.II " DEAL_II_PACKAGE_VERSION "\n";
  }
} // namespace Viscoplastic
