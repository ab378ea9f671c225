// SPDX-License-Identifier: LGPL-2.1-or-later

// Reading of parameter files, the description of parameters, and the messages
// that refuse wrong files.

#include "body.h"
#include "folder.h"
#include "refusals.h"
#include <viscoplastic_contact/parameters/parameter_description.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/wrong_lines.h>

#include <random>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  TEST(Parameters, DefaultsAndValues)
  {
    const auto parameters =
      read_parameters("set Dimension = 3\n" +
                      subsection("Material", "set Poisson's ratio = 0.4") +
                      "subsection Boundary 7 # the foot\n"
                      "set Role = clamped\nend\n" +
                      boundary(2, "set Role = contact"));
    EXPECT_EQ(parameters->dimension, 3u);
    EXPECT_EQ(parameters->material.poissons_ratio, "0.4");
    EXPECT_EQ(parameters->material.law, "elastic");
    EXPECT_EQ(parameters->boundaries.size(), 2u);
    EXPECT_EQ(parameters->boundaries.at(7).role, BoundaryRole::clamped);
    EXPECT_EQ(parameters->boundaries.at(2).entries.at("Friction law"),
              "not given");
    EXPECT_EQ(parameters->solver.linear_solver, LinearSolver::automatic);
    EXPECT_FALSE(parameters->initial_state.equilibrate);
  }



  TEST(Parameters, Choices)
  {
    for (const TimeScheme scheme : {TimeScheme::forward_euler,
                                    TimeScheme::backward_euler,
                                    TimeScheme::heun})
      {
        const Parameters parameters({}, {"Time/Scheme=" + name_of(scheme)});
        EXPECT_EQ(parameters.time.scheme, scheme);
        EXPECT_EQ(parameters.values().at("Time/Scheme"), name_of(scheme));
      }
    EXPECT_EQ(name_of(TimeScheme::heun), "Heun");
    expect_refusal([] { Parameters p({}, {"Solver/Linear solver=magic"}); },
                   "'Solver/Linear solver' is 'magic'; it must be one of "
                   "automatic, direct, multigrid, algebraic multigrid.");
  }



  TEST(Parameters, LaterFilesAndOverridesCount)
  {
    const Folder      folder;
    const std::string scene =
      folder.add("scene.prm",
                 "set Dimension = 3\n" +
                   subsection("Time", "set Phases = 1: 4") +
                   boundary(1, "set Role = free") +
                   subsection("Material",
                              "set Law = maxwell\n" +
                                subsection("maxwell", "set Viscosity = 2")));
    const std::string other = folder.add("other.prm",
                                         boundary(1, "set Role = clamped") +
                                           boundary(20, "set Role = free"));
    const Parameters  parameters({scene, other},
                                {"Time/Phases = 2: 8",
                                  " Boundary 003 / Role =contact",
                                  "Material/maxwell/Viscosity=3 + x",
                                  "Time/Phases=3: 1"});
    EXPECT_EQ(parameters.file, scene);
    EXPECT_EQ(parameters.dimension, 3u);
    EXPECT_EQ(parameters.boundaries.size(), 3u);
    EXPECT_EQ(parameters.boundaries.at(1).role, BoundaryRole::clamped);
    EXPECT_EQ(parameters.boundaries.at(3).role, BoundaryRole::contact);
    EXPECT_EQ(parameters.boundaries.at(20).role, BoundaryRole::free);
    EXPECT_EQ(parameters.time.phases, "3: 1");
    parameters.handler.enter_subsection("Material");
    parameters.handler.enter_subsection("maxwell");
    EXPECT_EQ(parameters.handler.get("Viscosity"), "3 + x");
  }



  TEST(Parameters, TextOfFiles)
  {
    // The text has continued lines, comments, tabs, CR LF line ends, upper case
    // and a byte order mark.
    const auto parameters = read_parameters(
      "\xEF\xBB\xBFset Dimension = \\\n 3 # three\nSUBSECTION\tGeometry\r\n"
      "  set\tArguments= 1, \\  \n   2 # the rest\r\nEND\r\n"
      "subsection Loads\nset Body force = 0; a=b\nend");
    EXPECT_EQ(parameters->dimension, 3u);
    EXPECT_EQ(parameters->geometry.arguments, "1, 2");
    EXPECT_EQ(parameters->loads.body_force, "0; a=b");
  }



  TEST(Parameters, IncludedFiles)
  {
    const Folder      folder;
    const std::string scene =
      folder.add("scene.prm",
                 "include parts/time.prm # also overridden below\n"
                 "subsection Material\ninclude parts/../material.prm\nend\n" +
                   subsection("Time", "set Phases = 1: 4"));
    folder.add("parts/time.prm",
               "include more.prm\n" + subsection("Time", "set Phases = 9: 9"));
    folder.add("parts/more.prm", "set Dimension = 3");
    folder.add("material.prm", "set Law = maxwell");
    const Parameters parameters(scene);
    EXPECT_EQ(parameters.dimension, 3u);
    EXPECT_EQ(parameters.material.law, "maxwell");
    EXPECT_EQ(parameters.time.phases, "1: 4");

    const std::string cycle = folder.add("a.prm", "\ninclude b.prm");
    folder.add("b.prm", "include a.prm");
    expect_refusal([&] { Parameters p(cycle); }, "a.prm' includes itself.");
    const std::string lost = folder.add("lost.prm", "include nowhere.prm");
    expect_refusal([&] { Parameters p(lost); },
                   "'" + lost + "', line 1: the included file '" +
                     (folder.path / "nowhere.prm").string() +
                     "' does not exist.");
    // An included file closes the subsections that it opens and no others.
    const std::string open = folder.add("open.prm", "include half.prm\nend");
    folder.add("half.prm", "\nsubsection Time");
    expect_refusal([&] { Parameters p(open); },
                   "half.prm', line 2: the subsection 'Time' has no `end'.");
    const std::string closed =
      folder.add("closed.prm", "subsection Time\ninclude end.prm");
    folder.add("end.prm", "end");
    expect_refusal([&] { Parameters p(closed); },
                   "end.prm', line 1: there is no open subsection");
  }



  TEST(Parameters, MeshFileIsFoundFromAnywhere)
  {
    const Folder      folder;
    const std::string scene =
      folder.add("scene/scene.prm", "include parts/mesh.prm");
    folder.add("scene/parts/mesh.prm",
               subsection("Geometry", "set File = body.msh"));
    expect_refusal([&] { Parameters p(scene); },
                   "parts/mesh.prm', line 2: 'Geometry/File' is 'body.msh', "
                   "but there is no such file, neither beside '");
    const std::string mesh  = folder.add("scene/parts/body.msh", "");
    const std::string other = folder.add("other.msh", "");
    const Parameters  parameters(scene);
    EXPECT_EQ(parameters.geometry.file, mesh);
    parameters.handler.enter_subsection("Geometry");
    EXPECT_EQ(parameters.handler.get("File"), mesh);

    // Other names, and the command line's, start at the working directory.
    const auto work = std::filesystem::current_path();
    std::filesystem::current_path(folder.path);
    EXPECT_EQ(Parameters({scene}, {"Geometry/File=other.msh"}).geometry.file,
              other);
    EXPECT_EQ(Parameters({scene}, {"Geometry/File="}).geometry.file, "");
    const std::string variant =
      folder.add("variants/v.prm",
                 subsection("Geometry", "set File = other.msh"));
    EXPECT_EQ(Parameters(variant).geometry.file, other);
    std::filesystem::current_path(work);
  }



  TEST(Parameters, Refusals)
  {
    expect_refusal([] { Parameters parameters("/nowhere/scene.prm"); },
                   "The parameter file '/nowhere/scene.prm' does not exist.");
    expect_refusal([] { Parameters parameters("/tmp"); }, "is a directory.");
    expect_refusal(
      [] {
        read_parameters(subsection("Mesh refinement",
                                   "set Minimal level = 3\n"
                                   "set Maximal level = 2"));
      },
      "'Mesh refinement/Minimal level' = 3 must not exceed 'Maximal level' = "
      "2.");
    expect_refusal(
      [] {
        read_parameters(subsection("Mesh refinement",
                                   "set Refinement fraction = 0.7\n"
                                   "set Coarsening fraction = 0.4"));
      },
      "must add up to at most 1");
  }



  TEST(Parameters, RefusalsSayWhereAndWhatWouldBeRight)
  {
    const Folder folder;
    const auto   refused = [&folder](const std::string &text,
                                   const std::string &sentence) {
      const std::string file = folder.add("scene.prm", text);
      expect_refusal([&] { Parameters p(file); },
                     "'" + file + "', " + sentence);
    };
    // names
    refused("\nset Dimensions = 2",
            "line 2: there is no entry 'Dimensions' outside of subsections; "
            "did you mean 'Dimension'?");
    refused("subsection Material\nset youngs Modulus = 2\nend",
            "line 2: 'Material' has no entry 'youngs Modulus'; did you mean "
            "'Young's modulus'?");
    refused("subsection Boundary 1\nset Friction = 2\nend",
            "line 2: 'Boundary 1' has no entry 'Friction'; did you mean "
            "'Friction law'?");
    refused("subsection Material\nset Viscosity = 2\nend",
            "line 2: 'Material' has no entry 'Viscosity'; 'Viscosity' belongs "
            "to 'Material/maxwell', 'Material/perzyna'");
    refused("subsection Time\nset Dimension = 2\nend",
            "line 2: 'Time' has no entry 'Dimension'; it belongs outside of "
            "all subsections.");
    refused("subsection Time\nset qqqqqqq = 2\nend",
            "line 2: 'Time' has no entry 'qqqqqqq'; its entries are: Phases, "
            "Scheme, Stiffness policy.");
    refused("subsection Lods\nend",
            "line 1: there is no subsection 'Lods'; did you mean 'Loads'?");
    refused("subsection Material\nsubsection Maxwel\nend\nend",
            "line 2: 'Material' has no subsection 'Maxwel'; did you mean "
            "'maxwell'?");
    refused("\nsubsection Material\nsubsection Time\nend\nend",
            "line 3: 'Material' has no subsection 'Time', which stands outside "
            "of others; is there no `end' to 'Material'?");
    refused("subsection Material\nsubsection Boundary 3\nend\nend",
            "line 2: 'Material' has no subsection 'Boundary 3', which stands");
    refused("set Material = 2",
            "line 1: there is no entry 'Material' outside of subsections; that "
            "is the name of a subsection.");
    // ids
    refused("subsection Boundary left\nend",
            "line 1: 'left' in the subsection 'Boundary left' is no id; it "
            "must be a whole number from 0 to 999999999.");
    refused("subsection Boundary 1000000001\nend", "line 1: '1000000001' in");
    refused("subsection Material -1\nend", "line 1: '-1' in");
    refused("subsection Material 99999999999999999999999\nend", "line 1: '999");
    refused("subsection boundary 3\nend",
            "line 1: there is no subsection 'boundary 3'; did you mean "
            "'Boundary 3'?");
    refused("subsection Boundary\nend",
            "line 1: there is no subsection 'Boundary'; a boundary needs its "
            "id, as in `Boundary 0'.");
    // values
    refused("set Dimension = 4",
            "line 1: 'Dimension' is '4'; it must be a whole number from 2 to "
            "3.");
    refused("set Dimension = {3}", "line 1: 'Dimension' is '{3}'");
    refused("subsection Material\nset Law = Maxwel\nend",
            "line 2: 'Material/Law' is 'Maxwel'; it must be one of elastic, ");
    refused("subsection Material\nset Law = Maxwel\nend", "line 2: ");
    refused("subsection Solver\nset Contact tolerance = -1\nend",
            "line 2: 'Solver/Contact tolerance' is '-1'; it must be a number "
            "from 0 to 0.1.");
    refused("subsection Solver\nset Maximal contact iterations = 0\nend",
            "line 2: 'Solver/Maximal contact iterations' is '0'; it must be a "
            "whole number of at least 1.");
    refused("subsection Mesh refinement\nset Minimal level = -1\nend",
            "line 2: 'Mesh refinement/Minimal level' is '-1'; it must be a "
            "whole number of at least 0.");
    refused("subsection Initial state\nset Equilibrate = maybe\nend",
            "line 2: 'Initial state/Equilibrate' is 'maybe'; it must be true "
            "or false.");
    refused("subsection Geometry\nset Rotation axis = 0, 1\nend",
            "line 2: 'Geometry/Rotation axis' is '0, 1'; it must be a list of "
            "3 items separated by commas, each a number.");
    // text
    refused("set Dimension 2",
            "line 1: 'set Dimension 2' is no statement; a line is `set Entry = "
            "value'");
    refused("set = 2", "line 1: 'set = 2' is no statement; a line is `set");
    refused("\n\nDimension = 2",
            "line 3: 'Dimension = 2' is no statement; a line is `set Entry = "
            "value', `subsection Name', `end', `include file', or a comment "
            "after `#'.");
    refused("\nsubsection Time\nset Phases = 1: 1\n",
            "line 2: the subsection 'Time' has no `end'.");
    refused("subsection Time\nend\nend",
            "line 3: there is no open subsection that this `end' could close.");
    refused("subsection Time\nend Time", "line 2: 'end Time' is no statement");
    refused("subsection", "line 1: 'subsection' is no statement");
    refused("include #", "line 1: 'include' is no statement");
    // Numbered materials exclude one for all cells.
    refused(subsection("Material", "set Law = maxwell") +
              subsection("Material 2", "set Law = elastic"),
            "line 2: 'Material/Law' cannot be set beside 'Material 2'");
    EXPECT_EQ(message_of([] {
                read_parameters(
                  subsection("Material",
                             "set Law = elastic\nset Stress history = "
                             "quadrature points") +
                  subsection("Material 2", "set Law = maxwell"));
              }),
              "");
  }



  TEST(Parameters, TheSameEntryTwiceInAFile)
  {
    const Folder      folder;
    const std::string file =
      folder.add("scene.prm",
                 boundary(3, "set Role = free") + boundary(4, "") +
                   boundary(3, "\nset Role = clamped"));
    expect_refusal([&] { Parameters p(file); },
                   "'Boundary 3/Role' is set twice in '" + file +
                     "', in lines 2 and 9;");
    const std::string zeros =
      folder.add("zeros.prm",
                 boundary(3, "set Role = free") +
                   subsection("Boundary 03", "set Role = free"));
    expect_refusal([&] { Parameters p(zeros); }, "in lines 2 and 5;");
    // Other entries of the same subsection are no error.
    EXPECT_EQ(message_of([] {
                read_parameters(boundary(3, "set Role = free") +
                                boundary(3, "set Traction = 0; 0"));
              }),
              "");
  }



  TEST(Parameters, RefusedOverrides)
  {
    const auto refused = [](const std::string &text,
                            const std::string &sentence) {
      expect_refusal([&] { Parameters p({}, {text}); },
                     "--set '" + text + "': " + sentence);
    };
    refused("Dimension", "there is no `='; it must be 'Section/Entry=value'.");
    refused("/Dimension=2", "a name is empty");
    refused("Time/=2", "a name is empty");
    refused("Tme/Phases=1: 2",
            "there is no subsection 'Tme'; did you mean 'Time'?");
    refused("Time/Phase=1: 2",
            "'Time' has no entry 'Phase'; did you mean 'Phases'?");
    refused("Viscosity=2",
            "there is no entry 'Viscosity' outside of subsections; 'Viscosity' "
            "belongs to 'Material/maxwell'");
    refused("Dimension=5", "'Dimension' is '5'; it must be a whole number");
    refused("Output/Directory=a#b", "a value cannot contain `#'");
    refused("Boundary x/Role=free", "'x' in the subsection 'Boundary x'");
  }



  TEST(Parameters, DamagedFilesAreRefusedOrRead)
  {
    // A file with any content is read, or refused by a sentence.
    const std::string text = describe_parameters();
    const Folder      folder;
    std::mt19937      random(1);
    const std::string characters = "=#\\\n\t '{}/0-9.:;\xff\x01\"abc";
    unsigned int      n_refused  = 0;
    for (unsigned int i = 0; i < 60; ++i)
      {
        std::string damaged = text;
        for (unsigned int k = 0; k < 1 + i % 4; ++k)
          {
            const std::size_t position = random() % damaged.size();
            if (random() % 3 == 0)
              damaged.erase(position, random() % 200);
            else
              damaged[position] = characters[random() % characters.size()];
          }
        const std::string file = folder.add("scene.prm", damaged);
        try
          {
            Parameters parameters(file);
          }
        catch (const ExceptionBase &exception)
          {
            ++n_refused;
            std::ostringstream message;
            exception.print_info(message);
            EXPECT_NE(message.str().find("scene.prm'"), std::string::npos)
              << message.str();
            EXPECT_LT(message.str().size(), 1000u);
          }
      }
    EXPECT_GT(n_refused, 0u);
    // Long lines, deep nesting and long numbers are refused.
    for (const std::string &damaged :
         {std::string(1000000, ' ') + "x" + std::string(1000000, ' '),
          "set " + std::string(1000000, '=') + "\n",
          "subsection Boundary " + std::string(100000, '1') + "\nend\n",
          "set Dimension = " + std::string(100000, '(')})
      EXPECT_NE(message_of([&] { read_parameters(damaged); }), "");
    std::string nested;
    for (unsigned int i = 0; i < 100000; ++i)
      nested += "subsection Material\n";
    expect_refusal([&] { read_parameters(nested); },
                   "more than 50 subsections are inside each other");
  }



  TEST(Parameters, DescriptionIsAScene)
  {
    const std::string  text = describe_parameters();
    std::istringstream lines(text);
    std::string        line;
    while (std::getline(lines, line))
      EXPECT_LE(line.size(), 78u) << line;
    for (const char *part : {"subsection Boundary 0",
                             "# `Material 1': Bodies of several",
                             "set Law                    = elastic",
                             "allowed: one of elastic, ",
                             "Default: 0; allowed: a number from 0 to 0.1.",
                             "# maxwell: "})
      EXPECT_NE(text.find(part), std::string::npos) << part;

    // All entries but the roles have their defaults.
    const auto         described = read_parameters(text);
    std::ostringstream values, defaults;
    described->handler.print_parameters(values, ParameterHandler::ShortText);
    Parameters({},
               {"Boundary 0/Role=clamped",
                "Boundary 1/Role=free",
                "Boundary 2/Role=free",
                "Boundary 3/Role=free"})
      .handler.print_parameters(defaults, ParameterHandler::ShortText);
    EXPECT_EQ(values.str(), defaults.str());
  }



  TEST(Parameters, PatternsInWords)
  {
    EXPECT_EQ(allowed_values("[Selection a|b c ]"), "one of a, b c");
    EXPECT_EQ(allowed_values("[Integer]"), "a whole number");
    EXPECT_EQ(allowed_values(Patterns::Integer(2, 3).description()),
              "a whole number from 2 to 3");
    EXPECT_EQ(allowed_values(Patterns::Integer(0).description()),
              "a whole number of at least 0");
    EXPECT_EQ(allowed_values(Patterns::Double().description()), "a number");
    EXPECT_EQ(allowed_values(Patterns::Double(0.).description()),
              "a number of at least 0");
    EXPECT_EQ(allowed_values(Patterns::Bool().description()), "true or false");
    EXPECT_EQ(allowed_values(
                Patterns::List(Patterns::Integer(), 2, 2).description()),
              "a list of 2 items separated by commas, each a whole number");
    EXPECT_NE(allowed_values(Patterns::FileName().description()), "");
  }


  TEST(Parameters, AutomaticChoicesDependOnTheTolerance)
  {
    const Parameters without(std::vector<std::string>{});
    EXPECT_EQ(without.time.scheme, TimeScheme::forward_euler);
    EXPECT_EQ(without.refinement.strategy, RefinementStrategy::none);
    EXPECT_EQ(without.step_control.resolve_events, EventResolution::on);
    const std::string tolerance = "Error control/Tolerance=0.01";
    const Parameters  with({}, {tolerance});
    EXPECT_EQ(with.time.scheme, TimeScheme::heun);
    EXPECT_EQ(with.time.stiffness_policy, StiffnessPolicy::backward_euler);
    EXPECT_EQ(with.refinement.strategy, RefinementStrategy::residual);
    EXPECT_EQ(with.step_control.resolve_events, EventResolution::off);
    // Explicit entries take precedence over those that a tolerance implies.
    const Parameters chosen({},
                            {tolerance,
                             "Time/Scheme=forward Euler",
                             "Mesh refinement/Strategy=none",
                             "Step control/Resolve events=true"});
    EXPECT_EQ(chosen.time.scheme, TimeScheme::forward_euler);
    EXPECT_EQ(chosen.time.stiffness_policy, StiffnessPolicy::refuse);
    EXPECT_EQ(chosen.refinement.strategy, RefinementStrategy::none);
    EXPECT_EQ(chosen.step_control.resolve_events, EventResolution::on);
  }
} // namespace
