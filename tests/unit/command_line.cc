// SPDX-License-Identifier: LGPL-2.1-or-later

// The arguments of the program and the messages of a run on its progress.

#include "body.h"
#include "folder.h"
#include "refusals.h"
#include <viscoplastic_contact/base/mpi_singleton.h>
#include <viscoplastic_contact/base/progress.h>
#include <viscoplastic_contact/run/command_line.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

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
    EXPECT_EQ(RemainingTime().seconds(100.), 0.);
    RemainingTime remaining;
    for (unsigned int n = 1; n <= 5; ++n)
      remaining.add_step(2., 100., 0.01 * n);
    EXPECT_NEAR(remaining.seconds(100.), 190., 1e-9);
    // Twice the cells are expected to take twice the time.
    EXPECT_NEAR(remaining.seconds(200.), 380., 1e-9);
    // Earlier slow steps lose their weight.
    for (unsigned int n = 6; n <= 65; ++n)
      remaining.add_step(0.5, 100., 0.01 * n);
    EXPECT_NEAR(remaining.seconds(100.), 17.5, 0.5);
    remaining.add_step(0.5, 100., 1.);
    EXPECT_EQ(remaining.seconds(100.), 0.);
  }



  TEST(Progress, TimeLeftIsTrueFromTheTenthStepOn)
  {
    // The first step includes the set-up, each hundredth one writes fields.
    const auto seconds = [](const unsigned int n) {
      return n == 1 ? 20. : n % 100 == 0 ? 51. : 1.;
    };
    RemainingTime remaining;
    for (unsigned int n = 1; n < 5000; ++n)
      {
        remaining.add_step(seconds(n), 64., n / 5000.);
        const double truth = (5000 - n) * (n < 100 ? 1. : 1.5);
        if (n == 10 || n > 1000)
          {
            EXPECT_NEAR(remaining.seconds(64.), truth, 0.2 * truth) << n;
          }
      }
  }



  TEST(Progress, TimeLeftKnowsOfStepsThatGrow)
  {
    // In a relaxation each step is longer by a tenth than the one before: a
    // million of the first kind would be needed.
    RemainingTime      remaining;
    const unsigned int n_steps = 120;
    const double       whole   = std::pow(1.1, n_steps) - 1.;
    for (unsigned int n = 1; n < n_steps; ++n)
      {
        remaining.add_step(1., 64., (std::pow(1.1, n) - 1.) / whole);
        if (n > 5)
          {
            EXPECT_NEAR(remaining.seconds(64.), n_steps - n, 3.) << n;
          }
      }
  }



  /// The lines in the log of a run, which continues after @p n_before steps.
  std::vector<std::string>
  lines_of_run(const unsigned int n_steps,
               const bool         verbose  = false,
               const unsigned int n_before = 0)
  {
    const Folder      folder;
    const std::string log = (folder.path / "log").string();
    {
      Console  console(MPI_COMM_SELF, true, log, verbose);
      Progress progress(console);
      if (n_before > 0)
        progress.resume(static_cast<double>(n_before) / n_steps, 0.);
      for (unsigned int n = n_before + 1; n <= n_steps; ++n)
        progress.report("Step " + std::to_string(n),
                        64.,
                        static_cast<double>(n) / n_steps,
                        0.01 * (n - n_before));
    }
    std::ifstream            file(log);
    std::vector<std::string> lines;
    std::string              line;
    while (std::getline(file, line))
      lines.push_back(line);
    return lines;
  }



  TEST(Progress, LinesAreFew)
  {
    for (const unsigned int n_steps : {1u, 7u, 200u, 201u, 100000u})
      {
        const auto lines = lines_of_run(n_steps);
        EXPECT_EQ(lines.size(), std::min(n_steps, 201u));
        EXPECT_EQ(lines.front().find("Step 1  "), 0u) << lines.front();
        EXPECT_EQ(lines.back().find("Step " + std::to_string(n_steps) +
                                    "  elapsed "),
                  0u);
        EXPECT_NE(lines.back().find("left 0 s"), std::string::npos);
      }
    EXPECT_EQ(lines_of_run(1000, /* verbose = */ true).size(), 1000u);
    const auto later = lines_of_run(200000, false, 150000);
    EXPECT_EQ(later.size(), 51u);
    EXPECT_NE(later[1].find("left 8 min"), std::string::npos) << later[1];
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
