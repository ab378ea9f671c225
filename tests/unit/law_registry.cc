// SPDX-License-Identifier: LGPL-2.1-or-later

// The registry of laws, their parameters, and the example of the manual.

#include "law_bodies.h"
#include "refusals.h"
#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  TEST(ExampleLaw, RateByHand)
  {
    // sinh(log 2) = 3/4, cosh(log 2) = 5/4.
    const FlowingBody body(garofalo(2., 1., 10.));
    expect_near(stiffness.strain(body.rate(symmetric(std::log(2.), 0, 0))),
                symmetric(-1.5, 0.75, 0.75),
                1e-14);
    EXPECT_NEAR(body.relaxation_rate(symmetric(std::log(2.), 0, 0)),
                1.5 * 0.8 * 2.5,
                1e-14);
    expect_near(FlowingBody(garofalo(2., 1., std::log(2.)))
                  .rate(symmetric(std::log(2.) + 1, 0, 0)),
                stiffness.stress(symmetric(-4, 2, 2)),
                1e-14);
  }



  // The manual shows the example law that is compiled here, and the registry as
  // it is.
  TEST(ExampleLaw, IsTheOneInTheManual)
  {
    const auto contents = [](const std::string &name) {
      std::ifstream file(VISCOPLASTIC_SOURCE_DIR "/" + name);
      EXPECT_TRUE(file) << name;
      return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const std::string manual  = contents("doc/adding_a_law.md");
    const std::string example = contents("tests/unit/example_law.cc");
    EXPECT_NE(manual.find("```cpp\n" + example + "```\n"), std::string::npos);

    // The registry has each line of the manual's list except the example.
    const std::string registry = contents("source/laws/viscoplastic_law.cc");
    const std::size_t begin    = manual.find("#define VISCOPLASTIC_LAWS");
    ASSERT_NE(begin, std::string::npos);
    std::istringstream list(
      manual.substr(begin, manual.find("```", begin) - begin));
    std::string  line;
    unsigned int n_lines = 0;
    while (std::getline(list, line))
      if (line.find("garofalo") == std::string::npos)
        {
          EXPECT_NE(registry.find(line), std::string::npos) << line;
          ++n_lines;
        }
    EXPECT_EQ(n_lines, 8);
  }



  TEST(LawParameters, VaryInSpaceAndTime)
  {
    auto law = make_law("perzyna",
                        "set Yield radius = if(x < 1, 0.1, 0.2)\n"
                        "set Hardening modulus = z\n"
                        "set Viscosity = 1 + t");
    EXPECT_TRUE(law->depends_on_position());
    EXPECT_TRUE(law->depends_on_time());
    const LawPoint point = law->point(Point<3>(2, 0, 0.3), 4.);
    EXPECT_EQ(point.parameters[0], 0.2);
    EXPECT_EQ(point.parameters[1], 0.3);
    EXPECT_EQ(point.parameters[2], 5.);
    EXPECT_EQ(point.t, 4.);
    EXPECT_EQ(point.x, Point<3>(2, 0, 0.3));
    EXPECT_EQ(law->point(Point<3>(), 0.).parameters[0], 0.1);

    RandomTensors random;
    const Tensor2 stress = random(), strain = random();
    expect_near(law->rate(stress, strain, stiffness, point),
                FlowingBody(perzyna(0.2, 5., 0.3)).rate(stress, strain),
                1e-16);

    EXPECT_FALSE(maxwell(1.)->depends_on_position());
    EXPECT_FALSE(maxwell(1.)->depends_on_time());
  }



  TEST(LawParameters, AreRefusedOutsideTheirRange)
  {
    expect_refusal([] { make_law("maxwell", "set Viscosity = 0"); },
                   "'Material/maxwell/Viscosity' is 0; it must be positive.");
    expect_refusal([] { make_law("perzyna", "set Viscosity = -1e3"); },
                   "'Material/perzyna/Viscosity' is -1000; it must be "
                   "positive.");
    expect_refusal([] { make_law("perzyna", "set Yield radius = -0.1"); },
                   "'Material/perzyna/Yield radius' is -0.1; it must be zero "
                   "or positive.");
    expect_refusal([] { make_law("perzyna", "set Hardening modulus = -2"); },
                   "'Material/perzyna/Hardening modulus' is -2; it must be "
                   "zero or positive.");
    expect_refusal([] { make_law("maxwell", "set Viscosity = 1/0"); },
                   "The expression '1/0' of 'Material/maxwell/Viscosity' has "
                   "the value inf at x = (0 0 0), t = 0; it must be finite.");
    expect_refusal(
      [] { make_law("maxwell", "set Viscosity = viscous"); },
      "The expression 'viscous' of 'Material/maxwell/Viscosity' "
      "cannot be parsed: there is no 'viscous'; its variables are x, "
      "y, z, T and t");

    const auto law = make_law("maxwell", "set Viscosity = x - t");
    EXPECT_EQ(law->point(Point<3>(3, 0, 0), 1.).parameters[0], 2.);
    expect_refusal([&] { law->point(Point<3>(3, 0, 0), 4.); },
                   "'Material/maxwell/Viscosity' is -1 at x = (3 0 0), t = 4; "
                   "it must be positive.");
  }



  TEST(LawParameters, KnowNoZInThePlane)
  {
    EXPECT_NO_THROW(make_law("maxwell", "set Viscosity = 1 + x^2 + y", 2));
    EXPECT_NO_THROW(make_law("maxwell", "set Viscosity = 1 + z^2", 3));
    expect_refusal(
      [] { make_law("maxwell", "set Viscosity = 1 + z^2", 2); },
      "The expression '1 + z^2' of 'Material/maxwell/Viscosity' "
      "cannot be parsed: there is no 'z'; its variables are x, y, T "
      "and t");
  }



  TEST(Registry, NamesAndManual)
  {
    EXPECT_EQ(viscoplastic_law_names(),
              "elastic|maxwell|zener|perzyna|norton|burgers|lubby2|parsed");

    const std::string manual = viscoplastic_law_help();
    for (const std::string name :
         {"elastic", "maxwell", "zener", "perzyna", "norton", "parsed"})
      EXPECT_NE(manual.find(name + ": G = "), std::string::npos) << name;
  }



  TEST(Registry, ElasticIsTheAbsenceOfALaw)
  {
    ParameterHandler prm;
    EXPECT_EQ(make_viscoplastic_law("elastic", prm), nullptr);
  }



  // All but the cap, which depends on the problem, have a default.
  TEST(Registry, Defaults)
  {
    for (const std::string name : {"maxwell", "zener", "perzyna", "parsed"})
      EXPECT_NO_THROW(FlowingBody(make_law(name))) << name;
    EXPECT_NO_THROW(FlowingBody(make_law("norton", "set Stress cap = 2")));
  }



  TEST(Registry, RefusesAnUnknownName)
  {
    ParameterHandler prm;
    expect_refusal(
      [&] { make_viscoplastic_law("bingham", prm); },
      "There is no viscoplastic law `bingham'; the laws are "
      "elastic|maxwell|zener|perzyna|norton|burgers|lubby2|parsed.");
  }



  // A refusal must leave the handler where the caller had it.
  TEST(Registry, RefusalLeavesTheSubsection)
  {
    ParameterHandler prm;
    declare_viscoplastic_law_parameters(prm);
    prm.parse_input_from_string(
      "subsection maxwell\n set Viscosity = -1\nend\n");
    EXPECT_THROW(make_viscoplastic_law("maxwell", prm), ExceptionBase);
    EXPECT_NE(make_viscoplastic_law("perzyna", prm), nullptr);
  }
} // namespace
