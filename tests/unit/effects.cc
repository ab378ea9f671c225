// SPDX-License-Identifier: LGPL-2.1-or-later

// What can be left out of a scene, and how far two runs are apart.

#include "folder.h"
#include <viscoplastic_contact/study/effect_variants.h>
#include <viscoplastic_contact/study/quantity_histories.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  /// The simplifications as "effect: instead (overrides)".
  std::vector<std::string>
  variants_of(const std::string &text, const bool is_physical)
  {
    Folder                   folder;
    const Parameters         scene({folder.add("scene.prm", text)});
    std::vector<std::string> result;
    for (const EffectVariant &variant : effect_variants(scene, 2.))
      if (variant.is_physical == is_physical)
        {
          std::string line = variant.effect + ": " + variant.instead + " (";
          for (const std::string &assignment : variant.overrides)
            line += assignment + ',';
          line.back() = ')';
          result.push_back(line);
          // They make a scene.
          const Parameters simpler({folder.add("scene.prm", text)},
                                   variant.overrides);
        }
    return result;
  }



  const std::string square = "set Dimension = 2\n"
                             "subsection Boundary 0\n"
                             "set Role = traction\n"
                             "set Traction = 0.3*t; 0\n"
                             "end\n"
                             "subsection Boundary 1\n"
                             "set Role = traction\n"
                             "set Traction = 0; 0\n"
                             "end\n"
                             "subsection Boundary 2\n"
                             "set Role = contact\n"
                             "set Friction law = tresca\n"
                             "set Friction bound = 0.08 + x\n"
                             "end\n"
                             "subsection Boundary 3\n"
                             "set Role = displacement\n"
                             "set Displacement = ; -t\n"
                             "end\n";



  TEST(EffectVariants, OfAnElasticScene)
  {
    const std::vector<std::string> expected{
      "traction on Boundary 0: none (Boundary 0/Traction=0; 0)",
      "friction on Boundary 2: none (Boundary 2/Friction bound=0)",
      "slip on Boundary 2: never (Boundary 2/Friction bound=1e6*(0.08 + x))",
      "displacement on Boundary 3: zero (Boundary 3/Displacement=; 0)"};
    EXPECT_EQ(variants_of(square, true), expected);
    EXPECT_EQ(
      variants_of(square, false),
      (std::vector<std::string>{
        "volumetric integration: full (Material/Volumetric integration=full)",
        "error bar: none, and a fixed tolerance (Error control/Error "
        "bar=false)"}));
  }



  TEST(EffectVariants, OfLaws)
  {
    const auto first = [](const std::string &law) {
      const auto all =
        variants_of(square + "subsection Material\n" + law + "end\n", true);
      return std::vector<std::string>(all.begin(), all.end() - 4);
    };
    EXPECT_EQ(first("set Law = maxwell\n"),
              (std::vector<std::string>{
                "viscous flow: elastic (Material/Law=elastic)"}));
    EXPECT_EQ(first("set Law = perzyna\nsubsection perzyna\n"
                    "set Hardening modulus = 2\nend\n"),
              (std::vector<std::string>{
                "viscous flow: elastic (Material/Law=elastic)",
                "hardening: none (Material/perzyna/Hardening modulus=0)"}));
    // 3 s^2 at s = 2 is 6 times that, linear
    EXPECT_EQ(first("set Law = norton\nsubsection norton\n"
                    "set Rate factor = 3\nset Exponent = 2\nend\n"),
              (std::vector<std::string>{
                "viscous flow: elastic (Material/Law=elastic)",
                "power of the flow law: 1, with the rate at the mean stress "
                "(Material/norton/Exponent=1,Material/norton/Rate factor=6)"}));
    EXPECT_EQ(
      first("set Law = zener\nsubsection zener\n"
            "set Long-term Young's modulus = 0.25\nend\n"),
      (std::vector<std::string>{
        "relaxation: elastic at once (Material/Law=elastic)",
        "relaxation: elastic with the long-term moduli (Material/Law=elastic,"
        "Material/Young's modulus=0.25,Material/Poisson's ratio=0.3)"}));
  }



  TEST(EffectVariants, OfSeveralMaterials)
  {
    const auto all = variants_of(square + "subsection Material 0\nend\n"
                                          "subsection Material 7\n"
                                          "set Young's modulus = 5\n"
                                          "set Law = maxwell\nend\n",
                                 true);
    ASSERT_EQ(all.size(), 6u);
    EXPECT_EQ(all[0],
              "viscous flow of Material 7: elastic (Material 7/Law=elastic)");
    EXPECT_EQ(all[1],
              "different materials: Material 0 everywhere (Material 7/Law="
              "elastic,Material 7/Young's modulus=1)");
  }



  /// A table of one column and its times.
  Viscoplastic::Table
  table(const std::vector<double>                        &t,
        const std::map<std::string, std::vector<double>> &columns)
  {
    Viscoplastic::Table result{{"t"}, {{"t", t}}};
    for (const auto &[name, values] : columns)
      {
        result.names.push_back(name);
        result.columns[name] = values;
      }
    return result;
  }



  TEST(QuantityHistories, DifferencesAtTheTimesOfTheFirst)
  {
    const auto run = table({0., 1., 2.},
                           {{"friction_force_x", {0., 3., 0.}},
                            {"friction_force_y", {0., 4., 0.}},
                            {"cells", {1., 2., 3.}},
                            {"reaction_3_x", {0., 1e-9, 0.}},
                            {"reaction_3_y", {0., 0., 0.}}});
    // Between its rows linear, at t = 1 the vector (3, 3).
    const auto other   = table({0., 0.5, 1.5, 2.},
                             {{"friction_force_x", {0., 2., 4., 1.}},
                                {"friction_force_y", {0., 2., 4., 0.}}});
    const auto changes = changes_between(run, other);
    ASSERT_EQ(changes.size(), 2u);
    EXPECT_EQ(changes[0].quantity, "friction_force");
    EXPECT_DOUBLE_EQ(changes[0].change, 1. / 5.);
    // What is not there is zero; what is almost zero is measured by forces
    // that are not.
    EXPECT_EQ(changes[1].quantity, "reaction_3");
    EXPECT_NEAR(changes[1].change, 1e-9 / (1e-3 * 5.), 1e-15);
    for (const QuantityChange &none : changes_between(run, run))
      EXPECT_EQ(none.change, 0.);
  }
} // namespace
