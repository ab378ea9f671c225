// SPDX-License-Identifier: LGPL-2.1-or-later

// The arguments of the program and the messages of a run on its progress.

#include "body.h"
#include "folder.h"
#include "refusals.h"
#include <viscoplastic_contact/base/mpi_singleton.h>
#include <viscoplastic_contact/base/progress.h>
#include <viscoplastic_contact/run/command_line.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <thread>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  TEST(CommandLine, Options)
  {
    using Task = CommandLine::Task;
    EXPECT_EQ(read_command_line({}).task, Task::guide);
    EXPECT_EQ(read_command_line({"--help"}).task, Task::help);
    EXPECT_EQ(read_command_line({"-h"}).task, Task::help);
    EXPECT_EQ(read_command_line({"--version"}).task, Task::version);
    EXPECT_EQ(read_command_line({"--describe"}).task, Task::describe);
    EXPECT_EQ(read_command_line({"--describe=json"}).task,
              Task::describe_as_json);
    const CommandLine line = read_command_line({"a.prm",
                                                "--set",
                                                "A/B=c=d",
                                                "--log=x",
                                                "b.prm",
                                                "--set=C=1",
                                                "--quiet",
                                                "--check",
                                                "--",
                                                "--c.prm"});
    EXPECT_EQ(line.task, Task::check);
    EXPECT_EQ(line.files,
              (std::vector<std::string>{"a.prm", "b.prm", "--c.prm"}));
    EXPECT_EQ(line.overrides, (std::vector<std::string>{"A/B=c=d", "C=1"}));
    EXPECT_TRUE(line.quiet);
    EXPECT_EQ(line.log, "x");

    const CommandLine means = read_command_line({"--check=means", "a.prm"});
    EXPECT_EQ(means.task, Task::print_scene);
    EXPECT_TRUE(means.with_means);
    EXPECT_FALSE(read_command_line({"--check=json", "a.prm"}).with_means);
  }



  TEST(CommandLine, Refusals)
  {
    const auto refused = [](const std::vector<std::string> &arguments,
                            const std::string              &sentence) {
      expect_refusal([&] { read_command_line(arguments); }, sentence);
    };
    refused({"--chek", "a.prm"},
            "There is no option '--chek'; did you mean --check?");
    refused({"-x", "a.prm"},
            "There is no option '-x'; the options are --check");
    refused({"a.prm", "--set"}, "--set needs 'Section/Entry=value' after it.");
    refused({"a.prm", "--log"}, "--log needs the name of a file after it.");
    refused({"--log", "a.prm", "b.prm"}, "would overwrite 'a.prm'");
    refused({"--check"}, "There is no parameter file among the arguments");
    refused({"--check", "--version"},
            "--check and --version exclude each other.");
    EXPECT_EQ(read_command_line({"--describe", "a.prm"}).files.size(), 1u);
    refused({"--describe", "--set", "a=b"}, "goes without --set where");
    refused({"--version", "a.prm"}, "goes without parameter files");
    refused({"--describe=html"}, "the values prm and json, not 'html'.");
    refused({"--quiet=yes", "a.prm"}, "--quiet has no value");
    refused({"--check=xml", "a.prm"}, "the values json and means, not 'xml'.");
    refused({"--check", "--restart", "a.prm"},
            "--check and --restart exclude each other.");
    refused({"a.prm", "Time/Phases=1: 2"}, "write --set 'Time/Phases=1: 2'.");
  }



  // ------------------------------------------------------------- progress

  TEST(Progress, RemainingTime)
  {
    RemainingTime remaining;
    for (unsigned int i = 0; i < 5; ++i)
      remaining.add_step(2., 100.);
    EXPECT_DOUBLE_EQ(remaining.seconds(10, 100.), 20.);
    // Twice the cells are expected to take twice the time.
    EXPECT_DOUBLE_EQ(remaining.seconds(10, 200.), 40.);
    EXPECT_EQ(remaining.seconds(0, 100.), 0.);
    // Earlier slow steps lose their weight.
    for (unsigned int i = 0; i < 60; ++i)
      remaining.add_step(0.5, 100.);
    EXPECT_NEAR(remaining.seconds(10, 100.), 5., 0.2);
    EXPECT_EQ(RemainingTime().seconds(10, 100.), 0.);
  }



  TEST(Progress, TimeLeftIsTrueFromTheTenthStepOn)
  {
    // The first step includes the set-up, each hundredth one writes fields.
    const auto seconds = [](const unsigned int n) {
      return n == 1 ? 20. : n % 100 == 0 ? 51. : 1.;
    };
    RemainingTime remaining;
    for (unsigned int n = 1; n <= 5000; ++n)
      {
        remaining.add_step(seconds(n), 64.);
        const double truth = n < 100 ? 1. : 1.5;
        if (n == 10 || n > 1000)
          {
            EXPECT_NEAR(remaining.seconds(1., 64.), truth, 0.2 * truth) << n;
          }
      }
  }



  /// The lines in the log of a run whose step n is step(n).
  std::vector<std::string>
  lines_of_run(const unsigned int                               n_steps,
               const std::function<StepProgress(unsigned int)> &step,
               const bool                                       verbose = false)
  {
    const Folder      folder;
    const std::string log = (folder.path / "log").string();
    {
      Console  console(MPI_COMM_SELF, true, log, verbose);
      Progress progress(console, n_steps);
      for (unsigned int n = 0; n <= n_steps; ++n)
        progress.report(step(n), 0.01 * n);
    }
    std::ifstream            file(log);
    std::vector<std::string> lines;
    std::string              line;
    while (std::getline(file, line))
      lines.push_back(line);
    return lines;
  }



  /// The numbers of the steps in some lines.
  std::vector<unsigned int>
  steps_of(const std::vector<std::string> &lines)
  {
    std::vector<unsigned int> result;
    for (const std::string &line : lines)
      result.push_back(std::stoul(line.substr(5)));
    return result;
  }



  StepProgress
  plain_step(const unsigned int n)
  {
    return {n, 0.1 * n, n > 0 ? 0.1 : 0., 64., 3, 0.5, {}};
  }



  TEST(Progress, LinesAreFew)
  {
    for (const unsigned int n_steps : {1u, 7u, 200u, 201u, 100000u})
      {
        // The number of iterations differs from that of the step before.
        const auto lines = lines_of_run(n_steps, [&](const unsigned int n) {
          StepProgress step       = plain_step(n);
          step.contact_iterations = 3 + (n_steps - n) % 2;
          return step;
        });
        if (n_steps <= 200)
          EXPECT_EQ(lines.size(), n_steps);
        else
          {
            EXPECT_GE(lines.size(), 200u);
            EXPECT_LE(lines.size(), 202u);
          }
        const std::string n = std::to_string(n_steps);
        EXPECT_EQ(lines.back().find("Step " + n + '/' + n + "  t = "), 0u);
        EXPECT_NE(lines.back().find("contact iterations 3  slipping 50 %  "
                                    "elapsed "),
                  std::string::npos)
          << lines.back();
        EXPECT_NE(lines.back().find("left 0 s"), std::string::npos);
      }
  }



  TEST(Progress, LinesThatAreLeftOutAreCounted)
  {
    const auto lines = lines_of_run(1000, plain_step);
    EXPECT_EQ(lines[0].find("left out"), std::string::npos);
    EXPECT_NE(lines[1].find("  (3 steps left out)"), std::string::npos)
      << lines[1];
    EXPECT_EQ(lines_of_run(1000, plain_step, /* verbose = */ true).size(),
              1000u);
  }



  TEST(Progress, EventsHaveLinesOfTheirOwn)
  {
    // The number of iterations alternates in 10000 steps.
    const auto step = [](const unsigned int n) {
      StepProgress step       = plain_step(n);
      step.contact_iterations = 3 + n % 2;
      step.slipping           = n < 1234 ? 0. : n < 6789 ? 0.3 : 1.;
      if (n >= 4321)
        step.n_cells = 128;
      return step;
    };
    const auto lines = lines_of_run(10000, step);
    EXPECT_LE(lines.size(), 206u);
    const auto steps = steps_of(lines);
    for (const unsigned int n : {1234u, 4321u, 6789u})
      EXPECT_EQ(std::count(steps.begin(), steps.end(), n), 1) << n;
    // The number of lines is bounded also if the mesh changes in each step.
    const auto meshes = lines_of_run(10000, [](const unsigned int n) {
      StepProgress step = plain_step(n);
      step.n_cells      = n;
      return step;
    });
    EXPECT_LE(meshes.size(), 402u);
  }



  /// The log of a step by a heartbeat with the waiting time @p seconds.
  std::string
  beats_of_step(const double seconds, const bool is_quiet = false)
  {
    const Folder      folder;
    const std::string log = (folder.path / "log").string();
    {
      Console         console(MPI_COMM_SELF, true, is_quiet ? "" : log);
      const Heartbeat heartbeat(console, seconds);
      Heartbeat::begin_step(3, 0.25);
      for (unsigned int i = 0; i < 4; ++i)
        {
          // Sleep for more than a hundredth of the whole time.
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
          Heartbeat::count(i < 2 ? Loop::contact : Loop::linear);
        }
    }
    Heartbeat::count(Loop::linear); // without a heartbeat
    std::ifstream      file(log);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }



  TEST(Progress, LongStepsSayWhereTheyAre)
  {
    EXPECT_EQ(beats_of_step(10.), "");
    EXPECT_EQ(beats_of_step(0., /* is_quiet = */ true), "");
    const std::string text = beats_of_step(0.);
    EXPECT_EQ(text.rfind("Still at step 3 (t = 0.25): 1 contact iterations", 0),
              0u)
      << text;
    EXPECT_NE(text.find("2 contact, 2 linear iterations  elapsed 0 s"),
              std::string::npos)
      << text;
  }



  TEST(Progress, SilenceOfManyShortStepsIsBroken)
  {
    const Folder      folder;
    const std::string log = (folder.path / "log").string();
    Console           console(MPI_COMM_SELF, true, log);
    EXPECT_FALSE(console.is_silent_for(10.));
    EXPECT_TRUE(console.is_silent_for(0.));
    // The console is silent only after a hundredth of its age.
    while (!(console.age() > 0.01))
      ;
    console.stream() << "a line" << std::endl;
    EXPECT_FALSE(console.is_silent_for(1e-9));
  }



  TEST(Progress, Durations)
  {
    EXPECT_EQ(duration(0.3), "0 s");
    EXPECT_EQ(duration(99.), "99 s");
    EXPECT_EQ(duration(100.), "2 min");
    EXPECT_EQ(duration(5000.), "83 min");
    EXPECT_EQ(duration(9000.), "2.5 h");
    EXPECT_EQ(duration(259200.), "3.0 d");
  }



  TEST(CommandLine, LoneProcessOfOpenMpi)
  {
    // Variables to be set for Open MPI, and variables of launchers.
    const std::vector<std::pair<std::string, std::string>> wanted{
      {"OMPI_MCA_ess_singleton_isolated", "1"},
      {"OMPI_MCA_orte_create_session_dirs", "0"},
      {"OMPI_MCA_pml", "ob1"}};
    const std::vector<std::string>     launchers{"OMPI_COMM_WORLD_SIZE",
                                             "PMIX_RANK",
                                             "PMI_RANK",
                                             "SLURM_STEP_ID"};
    std::map<std::string, std::string> environment;
    const auto                         take = [&](const std::string &name) {
      if (const char *value = std::getenv(name.c_str()))
        environment[name] = value;
      unsetenv(name.c_str());
    };
    for (const std::string &launcher : launchers)
      take(launcher);
    for (const auto &[name, value] : wanted)
      take(name);

    for (const auto &[name, value] : wanted)
      {
        run_without_mpi_job();
        EXPECT_STREQ(std::getenv(name.c_str()), value.c_str());
        setenv(name.c_str(), "other", 1); // set by the user
        run_without_mpi_job();
        EXPECT_STREQ(std::getenv(name.c_str()), "other");
      }
    for (const std::string &launcher : launchers)
      {
        for (const auto &[name, value] : wanted)
          unsetenv(name.c_str());
        setenv(launcher.c_str(), "1", 1);
        run_without_mpi_job();
        for (const auto &[name, value] : wanted)
          EXPECT_EQ(std::getenv(name.c_str()), nullptr) << launcher;
        unsetenv(launcher.c_str());
      }

    for (const auto &[name, value] : environment)
      setenv(name.c_str(), value.c_str(), 1);
  }



  TEST(Progress, RemarksAreKeptAndLogged)
  {
    const Folder      folder;
    const std::string log = (folder.path / "log").string();
    {
      Console console(MPI_COMM_SELF, true, log);
      console.stream() << "text" << std::endl;
      console.remark("Warning: hot.");
      console.log() << "only here" << std::endl;
      EXPECT_EQ(console.remarks(), std::vector<std::string>{"Warning: hot."});
    }
    std::ifstream     file(log);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    EXPECT_EQ(text, "text\nWarning: hot.\nonly here\n");
    expect_refusal([] { Console console(MPI_COMM_SELF, true, "/nowhere/log"); },
                   "The log file '/nowhere/log' cannot be written");
  }
} // namespace
