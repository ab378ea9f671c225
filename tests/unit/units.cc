// SPDX-License-Identifier: LGPL-2.1-or-later

// Units of a scene: numbers with units in parameter files, what is refused, and
// the names of units in results.

#include "refusals.h"
#include <viscoplastic_contact/parameters/dimension_check.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/quantities.h>

#include <cmath>
#include <sstream>

namespace
{
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  const Units si("m", "s", "Pa"), rock("m", "day", "MPa"),
    machine("mm", "h", "MPa");

  const std::vector<std::string> in_rock{"Units/Length=m",
                                         "Units/Time=day",
                                         "Units/Stress=MPa",
                                         "Material/Young's modulus=25000"};



  /// Without files, in meters, days and megapascals.
  std::vector<std::string>
  with_units(std::vector<std::string> overrides)
  {
    overrides.insert(overrides.begin(), in_rock.begin(), in_rock.end());
    return overrides;
  }



  /// The text after the first number and its unit.
  std::string
  rest_behind_unit(const std::string &text)
  {
    const auto found = read_unit(text, end_of_number(text, 0));
    return found ? text.substr(found->end) : "no unit";
  }



  std::string
  converted(const std::string &text,
            const Units       &units,
            const Dimension   &dimension)
  {
    return without_units(text, {dimension}, units);
  }



  TEST(Units, ReadsProductsAndStopsBeforeExpressions)
  {
    for (const auto &[text, rest] :
         std::vector<std::pair<std::string, std::string>>{
           {"25 MPa", ""},
           {"25   MPa  ", "  "},
           {"22 kN/m^3", ""},
           {"1e-5 MPa^-5/day*x", "*x"},
           {"1e-5 MPa^(-5) / day", ""},
           {"3e18 Pa s", ""},
           {"3e18 Pa*s + 1", " + 1"},
           {"25 MPa*(1 - x)", "*(1 - x)"},
           {"25 MPa*x", "*x"},
           {"25 MPa/2", "/2"},
           {"25 MPa/x", "/x"},
           {"25 MPa*min(t, 3)", "*min(t, 3)"},
           {"25 MPa*m(t)", "*m(t)"},
           {"5/day", ""},
           {"5 / day + 1", " + 1"},
           {"5 mm/h; 0", "; 0"},
           {"1 year: 10", ": 10"},
           {"5/x", "no unit"},
           {"5/h(t)", "no unit"},
           {"5 + 3", "no unit"},
           {"5", "no unit"},
           {"5 min(3, 4)", "no unit"}})
      EXPECT_EQ(rest_behind_unit(text), rest) << text;
    const auto viscosity = read_unit("3 MPa h", 1);
    EXPECT_EQ(viscosity->unit.name, "MPa h");
    EXPECT_DOUBLE_EQ(viscosity->unit.si, 3.6e9);
    EXPECT_TRUE((viscosity->unit.dimension == Dimension{0., 1., 1.}));
    // N = kg m/s^2
    const auto weight = read_unit("1 kg/m^3*m/s^2", 1);
    EXPECT_TRUE((weight->unit.dimension == Dimension{-1., 0., 1.}));
    EXPECT_DOUBLE_EQ(weight->unit.si, 1.);
    EXPECT_EQ(read_unit("3 MPaa", 1)->unknown_name, "MPaa");
    EXPECT_EQ(read_unit("3 Pa second", 1)->unknown_name, "second");
  }



  TEST(Units, NumbersInTheUnitsOfTheScene)
  {
    const Dimension none, length{1., 0., 0.}, time{0., 1., 0.},
      stress{0., 0., 1.}, weight{-1., 0., 1.};
    EXPECT_EQ(converted("1 year: 12, 2 years: 6", rock, time),
              "365.25: 12, 730.5: 6");
    EXPECT_EQ(converted("1 year", si, time), "31557600");
    EXPECT_EQ(converted("25 GPa", rock, stress), "25000");
    EXPECT_EQ(converted("2.50 MPa", rock, stress), "2.50"); // as it is
    EXPECT_EQ(converted("25 MPa", si, stress), "25000000");
    EXPECT_EQ(converted("5 mm; -3e-1 km", rock, length), "0.005; -300");
    EXPECT_EQ(converted("22 kN/m^3", rock, weight), "0.022");
    EXPECT_EQ(converted("2200 kg/m^3*9.81 m/s^2", si, weight), "2200*9.81");
    EXPECT_EQ(converted("5 kg/(m s^2) + 2 kN/(m)^2*(x/(3 m))", si, stress),
              "5 + 2000*(x/(3))");
    EXPECT_EQ(converted("25 MPa*(1 - x/(2 km))", machine, stress),
              "25*(1 - x/(2000000))");
    EXPECT_DOUBLE_EQ(std::stod(converted("5 mm/h*t", si, length)), 5e-3 / 3600);
    EXPECT_EQ(converted("if(x > 10 m, 7, id)", machine, none),
              "if(x > 10000, 7, id)");
    EXPECT_EQ(converted("x2 + 3*t", rock, length), "x2 + 3*t");
    // Numbers keep their digits if their unit is that of the scene.
    EXPECT_EQ(converted("1e-5 MPa^-5/day", rock, {0., -1., -5.}), "1e-5");
    EXPECT_DOUBLE_EQ(std::stod(
                       converted("1e-5 MPa^-5/day", si, {0., -1., -5.})),
                     1e-35 / 86400.);
  }



  TEST(Units, DimensionsOfExpressions)
  {
    const Dimension length{1., 0., 0.}, stress{0., 0., 1.};
    std::string     chain;
    for (unsigned int i = 0; i < 20000; ++i)
      chain += "^2";
    for (const std::string text : {"25 MPa",
                                   "-25 MPa; 0; free",
                                   "0.022 MPa/m*(400 m - y)",
                                   "25 MPa*exp(-x/(3 m))*sin(2*pi*t/(1 day))",
                                   "25 MPa*min(t, 1 year)/(1 year)",
                                   "min(3 MPa, 2 kPa + 1)",
                                   "if(x < 3 m && t > 1 day, 2 MPa, 0)",
                                   "x < 3 m ? 2 MPa : 3 kPa",
                                   "sqrt(2 MPa*3 MPa)",
                                   "(2 MPa)^2/(3 MPa)",
                                   "(9 MPa^2)^0.5",
                                   "abs(3 MPa) - max(0, 2 MPa)",
                                   "2 MPa*force(t/(1 s))",
                                   "1 MPa*10^(-4*x)",
                                   "(1 MPa^2)^2^-1",
                                   "(4 MPa^2)^(1 - 3/(2*3))",
                                   "3*t*1 m",
                                   "12*min(t/(1 day), 1)",
                                   "2*3 MPa",
                                   "1e-4/2*(1 m)*3 MPa/(1 m)",
                                   "2 MPa*(("}) // for the parser of expressions
      EXPECT_EQ(wrong_dimension(text, stress), "") << text;
    EXPECT_EQ(wrong_dimension("1 m: 2, 3 m", length), "");
    for (const auto &[text, why] :
         std::vector<std::pair<std::string, std::string>>{
           {"25 m", "'25 m' is a length, but it must be a stress"},
           {"1 MPa; 2 s", "'2 s' is a time, but it must be a stress"},
           {"0.022 MPa*(400 m - y)", "a force per length, but"},
           {"25 MPa + y", "'25 MPa + y' brings together a stress and a length"},
           {"3 MPa*(t < 3 m)", "'t < 3 m' brings together a time and a length"},
           {"3 MPa*sin(t)",
            "'sin(t)' is a function of a time, but 'sin' takes"},
           {"min(3 MPa, 2 m)", "brings together a stress and a length"},
           {"if(x < 3 m, 1 MPa, 1 s)", "brings together a stress and a time"},
           {"x > 1 m ? 1 MPa : 2 m", "brings together a stress and a length"},
           {"(2 MPa)^2", "stress^2, but it must be a stress"},
           {"sqrt(2 MPa)", "stress^0.5, but it must be"},
           {"1 MPa^2^2^2", "stress^8, but it must be"},
           {"(1 MPa)^(2*3 - 1)", "stress^5, but it must be"},
           {std::string(20000, '-') + "1 MPa", "nested more than 1000 deep"},
           {std::string(20000, '(') + "1 MPa", "nested more than 1000 deep"},
           {"1 MPa" + chain, "nested more than 1000 deep"},
           {"2 MPa*min(t, 1)",
            "must be a stress; t has a unit here, t/(1 h) has"},
           {"50/2 GPa", "stress^-1, but it must be a stress"},
           {"1e-4*(15 MPa)^5", "stress^5, but it must be"},
           {"2200*9.81 m/s^2", "but it must be a stress"},
           {"2 MPa/(3 MPa)", "a pure number, but it must be a stress"}})
      EXPECT_NE(wrong_dimension(text, stress).find(why), std::string::npos)
        << text << ": " << wrong_dimension(text, stress);
    EXPECT_EQ(wrong_dimension("3 m + 2 m", {}), "");
    EXPECT_NE(wrong_dimension("3 m + 2 s", {}), "");
  }



  TEST(Units, NamesInResults)
  {
    EXPECT_EQ(Units().name(Quantity::stress), "");
    EXPECT_EQ(Units().label(Quantity::force, 2), "");
    EXPECT_FALSE(Units().are_declared());
    EXPECT_EQ(rock.label(Quantity::time, 2), " [day]");
    EXPECT_EQ(rock.label(Quantity::pure_number, 2), "");
    EXPECT_EQ(rock.suffix(Quantity::stress), " MPa");
    EXPECT_EQ(rock.name(Quantity::force, 3), "MN");
    EXPECT_EQ(rock.name(Quantity::force, 2), "MN/m");
    EXPECT_EQ(rock.name(Quantity::energy, 3), "MJ");
    EXPECT_EQ(rock.name(Quantity::velocity, 3), "m/day");
    EXPECT_EQ(rock.name(Quantity::area, 2), "m");
    EXPECT_EQ(rock.name(Quantity::volume, 3), "m^3");
    EXPECT_EQ(rock.name(Quantity::stress_norm, 3), "MPa*m^1.5");
    EXPECT_EQ(rock.name(Quantity::energy_norm, 2), "(MJ/m)^0.5");
    EXPECT_EQ(machine.name(Quantity::force, 3), "N");
    EXPECT_EQ(machine.name(Quantity::force, 2), "N/mm");
    EXPECT_EQ(machine.name(Quantity::energy, 3), "mJ");
    EXPECT_EQ(Units("cm", "s", "MPa").name(Quantity::force, 2), "MPa*cm");
    const Units by_force("mm", "s", "", "N");
    EXPECT_EQ(by_force.stress.name, "MPa");
    EXPECT_DOUBLE_EQ(by_force.stress.si, 1e6);
    EXPECT_EQ(Units("cm", "s", "", "kN").stress.name, "kN/cm^2");
    EXPECT_EQ(Units("m", "s", "N/mm^2").name(Quantity::force, 3), "MN");
    EXPECT_EQ(without_label("reaction_1_x [MN/m]"), "reaction_1_x");
    EXPECT_EQ(without_label("t"), "t");
  }



  TEST(Units, DeclarationsThatAreRefused)
  {
    for (const auto &[names, why] :
         std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"m", "", "MPa", ""}, "'Units' has no Time; give `Length', `Time'"},
           {{"", "day", "", ""}, "'Units' has no Length, Stress"},
           {{"m", "day", "MPa", "N"}, "both `Stress' and `Force'"},
           {{"day", "m", "Pa", ""},
            "'Units/Length' is 'day', a time; it must be a length: nm, um"},
           {{"m", "dya", "Pa", ""},
            "'Units/Time' is 'dya'; did you mean 'day'?"},
           {{"m", "s", "mpa", ""},
            "'Units/Stress' is 'mpa'; did you mean 'MPa'?"},
           {{"m", "s", "MPa + 3", ""}, "which is no unit behind 'MPa'"},
           {{"m", "s", "", "MPa"}, "it must be a force: N, kN, MN"}})
      expect_refusal(
        [names = names] { Units(names[0], names[1], names[2], names[3]); },
        why);
  }



  TEST(Units, ParametersAreInTheUnitsOfTheScene)
  {
    const Parameters parameters(
      {},
      with_units({"Time/Phases=1 year: 4",
                  "Material/Young's modulus=25 GPa",
                  "Material/Law=norton",
                  "Material/norton/Rate factor=2 GPa^-5/day",
                  "Material/norton/Exponent=5",
                  "Material/norton/Stress cap=30 MPa",
                  "Step control/Largest step=12 h",
                  "Checkpoint/Wall time limit=2 h",
                  "Output/Points=5 mm, 1",
                  "Output/Directory=run 2 h",
                  "Boundary 0/Traction=1 kPa*(1 - y/(2 cm)); 0"}));
    EXPECT_TRUE(parameters.units.are_declared());
    EXPECT_EQ(parameters.time.phases, "365.25: 4");
    EXPECT_EQ(parameters.material.youngs_modulus, "25000");
    EXPECT_EQ(parameters.step_control.largest_step, 0.5);
    EXPECT_EQ(parameters.checkpoint.wall_time_limit, 7200.);
    EXPECT_EQ(parameters.output.points, "0.005, 1");
    EXPECT_EQ(parameters.output.directory, "run 2 h"); // no number
    EXPECT_EQ(parameters.boundaries.at(0).entries.at("Traction"),
              "0.001*(1 - y/(0.02)); 0");
    EXPECT_NEAR(std::stod(
                  parameters.values().at("Material/norton/Rate factor")),
                2e-15,
                1e-29);

    // The record has entries as the scene has written them.
    std::ostringstream record;
    parameters.print(record);
    for (const std::string line : {"set Phases           = 1 year: 4",
                                   "set Young's modulus        = 25 GPa",
                                   "set Rate factor = 2 GPa^-5/day",
                                   "set Length = m"})
      EXPECT_NE(record.str().find(line), std::string::npos) << line << " in\n"
                                                            << record.str();
    // If nothing has a unit, the record is that of the handler.
    const Parameters   bare({}, {"Boundary 0/Role=free"});
    std::ostringstream ours, theirs;
    bare.print(ours);
    bare.handler.print_parameters(theirs, dealii::ParameterHandler::Text);
    EXPECT_EQ(ours.str(), theirs.str());
    EXPECT_FALSE(bare.units.are_declared());
  }



  TEST(Units, TheLastValueCounts)
  {
    const Parameters parameters(
      {}, with_units({"Time/Phases=1 year: 4", "Time/Phases=3: 4"}));
    std::ostringstream record;
    parameters.print(record);
    EXPECT_EQ(parameters.time.phases, "3: 4");
    EXPECT_EQ(record.str().find("year:"), std::string::npos);
    // The dimension of an overridden entry does not count.
    EXPECT_EQ(Parameters({},
                         with_units(
                           {"Material/norton/Rate factor=1e-5 MPa^-3/day",
                            "Material/norton/Exponent=1",
                            "Material/norton/Rate factor=2"}))
                .values()
                .at("Material/norton/Rate factor"),
              "2");
    // Wall times have units without a declaration.
    EXPECT_EQ(Parameters({}, {"Checkpoint/Wall time limit=1.5 h"})
                .checkpoint.wall_time_limit,
              5400.);
  }



  TEST(Units, EntriesThatAreRefused)
  {
    for (const auto &[entry, why] :
         std::vector<std::pair<std::string, std::string>>{
           {"Time/Phases=25 MPa: 4",
            "--set 'Time/Phases=25 MPa: 4': 'Time/Phases' is '25 MPa: 4'; '25 "
            "MPa' is a stress, but it must be a time."},
           {"Time/Phases=1 year: 4 day", "the number of steps has no unit."},
           {"Time/Phases=1 yaer: 4",
            "there is no unit 'yaer'; did you mean 'year'?"},
           {"Time/Phases=1 foot: 4", "there is no unit 'foot'; units are nm"},
           {"Time/Phases=20 degC: 4", "differences are in K"},
           {"Time/Phases=1year: 4",
            "a blank must stand between '1' and its unit."},
           {"Step control/Largest step=1 m", "'1 m' is a length"},
           {"Output/Points=1 m, 2 s",
            "'2 s' is a time, but it must be a length"},
           {"Material/Young's modulus=25 kN",
            "a force, but it must be a stress"},
           {"Material/Young's modulus=1e999 Pa",
            "'1e999' leaves the range of floating-point numbers."},
           {"Material/Poisson's ratio=0.3 m",
            "a length, but it must be a pure"},
           {"Material/maxwell/Viscosity=3 Pa", "it must be a viscosity"},
           {"Loads/Body force=0; -22 kN/m^2", "it must be a force per volume"},
           // The exponent has its default 3.
           {"Material/norton/Rate factor=1e-5 MPa^-5/day",
            "'1e-5 MPa^-5/day' is time^-1 stress^-5, but it must be time^-1 "
            "stress^-3 with 'Exponent' = 3."},
           {"Boundary 0/Traction=6 MPa/dya*t; 0",
            "there is no unit 'dya'; did you mean 'day'?"},
           {"Checkpoint/Wall time limit=3 MPa", "it must be a time"}})
      expect_refusal([entry = entry] { Parameters({}, with_units({entry})); },
                     why);
    expect_refusal([] { Parameters({}, {"Time/Phases=1 year: 4"}); },
                   "'1 year' has a unit, but the scene says none: declare "
                   "`Length', `Time' and `Stress' in `subsection Units'.");
    expect_refusal([] { Parameters({}, {"Units/Length=m"}); },
                   "'Units' has no Time, Stress");
    // Later errors quote entries as written in the file.
    const Parameters parameters({},
                                with_units({"Boundary 1/Traction=0; 1 kPa*q",
                                            "Output/Points=5 mm, 1"}));
    EXPECT_EQ(parameters.quote_as_written("'0.001*q' of 'Boundary 1/Traction', "
                                          "not '0.001*q' of 'Loads'"),
              "'1 kPa*q' of 'Boundary 1/Traction', not '0.001*q' of 'Loads'");
    EXPECT_EQ(parameters.quote_as_written("'Output/Points' is '0.005, 1'"),
              "'Output/Points' is '5 mm, 1'");
    EXPECT_EQ(parameters.quote_as_written("'0.005, 1'"), "'0.005, 1'");
    // An entry without units says what it takes.
    expect_refusal(
      [] { Parameters({}, with_units({"Error control/Tolerance=3 m"})); },
      "it must be a number from 0 to 1");
  }
} // namespace
