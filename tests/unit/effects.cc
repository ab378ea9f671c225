// SPDX-License-Identifier: LGPL-2.1-or-later

// What can be left out of a scene, and how far two runs are apart.

#include "folder.h"
#include <viscoplastic_contact/study/effect_result.h>
#include <viscoplastic_contact/study/quantity_histories.h>

#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <regex>
#include <sstream>

namespace
{
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  /// The text with its long numbers rounded, as means are.
  std::string
  rounded(const std::string &text)
  {
    const std::regex number("\\d+\\.\\d{9,}");
    std::string      result;
    auto             begin = text.begin();
    for (std::sregex_iterator match(text.begin(), text.end(), number), end;
         match != end;
         ++match)
      {
        std::ostringstream value;
        value << std::setprecision(9) << std::stod(match->str());
        result.append(begin, (*match)[0].first);
        result += value.str();
        begin = (*match)[0].second;
      }
    return result.append(begin, text.end());
  }



  /// The simplifications as "effect: instead (overrides)".
  std::vector<std::string>
  variants_of(const std::string &text,
              const EffectKind   kind = EffectKind::problem)
  {
    Folder                   folder;
    const Parameters         scene({folder.add("scene.prm", text)});
    const auto               data = SceneData::of(scene, MPI_COMM_WORLD);
    std::vector<std::string> result;
    for (const EffectVariant &variant : effect_variants(scene, *data, 2.))
      if (variant.kind == kind)
        {
          std::string line = variant.effect + ": " + variant.instead + " (";
          for (const std::string &assignment : variant.overrides)
            line += assignment + ',';
          line.back() = variant.overrides.empty() ? '(' : ')';
          line += variant.overrides.empty() ? ")" : "";
          result.push_back(rounded(line));
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
                             "set Friction bound = 0.08 + 0*x\n"
                             "end\n"
                             "subsection Boundary 3\n"
                             "set Role = displacement\n"
                             "set Displacement = ; -t\n"
                             "end\n";



  TEST(EffectVariants, OfAnElasticScene)
  {
    EXPECT_EQ(
      variants_of(square),
      (std::vector<std::string>{
        "traction on Boundary 0: none (Boundary 0/Traction=0; 0)",
        "traction on Boundary 0 over time: its mean (Boundary "
        "0/Traction=0.15; 0,Initial state/Equilibrate=true)",
        "friction on Boundary 2: none (Boundary 2/Friction bound=0)",
        "slip on Boundary 2: never (Boundary 2/Friction bound=1e6*(0.08 + "
        "0*x))",
        "friction bound on Boundary 2 over space: its mean (Boundary "
        "2/Friction bound=0.08)",
        "displacement on Boundary 3: none (Boundary 3/Displacement=; 0)",
        "displacement on Boundary 3 over time: its mean (Boundary "
        "3/Displacement=; -0.5,Initial state/Equilibrate=true)"}));
    EXPECT_EQ(variants_of(square, EffectKind::discretization),
              (std::vector<std::string>{
                "volumetric integration (automatic): full (Material/Volumetric "
                "integration=full)"}));
    EXPECT_EQ(variants_of(square, EffectKind::observation),
              (std::vector<std::string>{
                "error bar: none, and a fixed tolerance (Error control/Error "
                "bar=false)",
                "fields and checkpoints: none ()"}));
  }



  TEST(EffectVariants, PressureThatIsGivenInstead)
  {
    const std::string contact = "set Role = contact\n"
                                "set Contact law = unilateral\n"
                                "set Friction law = coulomb\n"
                                "set Friction coefficient = 0.3\n"
                                "end\n",
                      half    = "set Dimension = 2\n"
                                "subsection Geometry\n"
                                "set Arguments = 4, 2 : 0, 0 : 2, 1 : true\n"
                                "end\n"
                                "subsection Boundary 0\n"
                                "set Role = clamped\n"
                                "end\n"
                                "subsection Boundary 1\n"
                                "set Role = free\n"
                                "end\n"
                                "subsection Boundary 2\n" +
                             contact + "subsection Boundary 3\n",
                      free = "set Role = free\nend\n";
    const auto given = [](const std::string &text, const std::string &force) {
      Folder                   folder;
      const Parameters         scene({folder.add("scene.prm", text)});
      const auto               data = SceneData::of(scene, MPI_COMM_WORLD);
      std::vector<std::string> found;
      for (const EffectVariant &variant :
           effect_variants(scene, *data, 2., force))
        if (variant.effect.rfind("computed pressure", 0) == 0)
          {
            found = variant.overrides;
            const Parameters simpler({folder.add("scene.prm", text)}, found);
            EXPECT_EQ(simpler.boundaries.at(2).contact_law,
                      "given normal stress");
          }
      return found;
    };
    EXPECT_EQ(
      given(half + free, "3*t"),
      (std::vector<std::string>{"Boundary 2/Contact law=given normal stress",
                                "Boundary 2/Normal stress=-(3*t)/2",
                                "Boundary 2/Gap=",
                                "Boundary 2/Foundation displacement=0"}));
    // The force is not known, or belongs to two pieces.
    EXPECT_TRUE(given(half + free, "").empty());
    EXPECT_TRUE(given(half + contact, "3*t").empty());
  }



  TEST(EffectVariants, OfTheDiscretization)
  {
    const auto all = variants_of(square + "subsection Material\n"
                                          "set Law = maxwell\n"
                                          "set Volumetric integration = full\n"
                                          "end\n"
                                          "subsection Mesh refinement\n"
                                          "set Strategy = kelly\nend\n"
                                          "subsection Step control\n"
                                          "set Tolerance = 0.1\nend\n",
                                 EffectKind::discretization);
    EXPECT_EQ(
      all,
      (std::vector<std::string>{
        "volumetric integration (full): mean dilatation "
        "(Material/Volumetric integration=mean dilatation)",
        "stress history (quadrature points): cell means (Material/Stress "
        "history=cell means)",
        "time scheme (forward Euler): backward Euler (Time/Scheme=backward "
        "Euler)",
        "time scheme (forward Euler): Heun (Time/Scheme=Heun)",
        "step control: the steps of the phases (Step "
        "control/Tolerance=0)",
        "adaptive mesh: the first mesh (Mesh "
        "refinement/Strategy=none)"}));
  }



  TEST(EffectVariants, OfLaws)
  {
    const auto first = [](const std::string &law) {
      const auto all =
        variants_of(square + "subsection Material\n" + law + "end\n");
      return std::vector<std::string>(all.begin(), all.end() - 7);
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
                    "set Rate factor = 3\nset Exponent = 2\n"
                    "set Stress cap = 9\nend\n"),
              (std::vector<std::string>{
                "viscous flow: elastic (Material/Law=elastic)",
                "power of the flow law: 1, same rate at the mean stress "
                "(Material/norton/Exponent=1,Material/norton/Rate "
                "factor=2*(3))"}));
    EXPECT_EQ(
      first("set Law = zener\nsubsection zener\n"
            "set Long-term Young's modulus = 0.25\nend\n"),
      (std::vector<std::string>{
        "relaxation: elastic at once (Material/Law=elastic)",
        "relaxation: elastic with the long-term moduli (Material/Law=elastic,"
        "Material/Voigt matrix=,Material/Young's modulus=0.25,Material/"
        "Poisson's ratio=0.3)"}));
    // Expressions: no power that could be matched, but means.
    EXPECT_EQ(first("set Young's modulus = 1 + 2*x\nset Law = norton\n"
                    "subsection norton\nset Exponent = 2 + 2*t\n"
                    "set Stress cap = 9\nend\n"),
              (std::vector<std::string>{
                "viscous flow: elastic (Material/Law=elastic)",
                "Young's modulus over space: its mean (Material/Young's "
                "modulus=2)",
                "exponent over time: its mean (Material/norton/Exponent=3)"}));
  }



  TEST(EffectVariants, OfSeveralMaterials)
  {
    const auto all = variants_of(square + "subsection Material 0\nend\n"
                                          "subsection Material 7\n"
                                          "set Young's modulus = 5\n"
                                          "set Law = maxwell\nend\n");
    ASSERT_EQ(all.size(), 9u);
    EXPECT_EQ(all[0],
              "viscous flow of Material 7: elastic (Material 7/Law=elastic)");
    EXPECT_EQ(all[1],
              "different materials: Material 0 everywhere (Material 7/Law="
              "elastic,Material 7/Young's modulus=1)");
  }



  TEST(EffectVariants, Anisotropy)
  {
    const auto all =
      variants_of(square + "subsection Material\n"
                           "set Voigt matrix = 3, 1, 1, 0, 0, 0; "
                           "1, 3, 1, 0, 0, 0; 1, 1, 3, 0, 0, 0; "
                           "0, 0, 0, 1, 0, 0; 0, 0, 0, 0, 1, 0; "
                           "0, 0, 0, 0, 0, 1\nend\n");
    EXPECT_EQ(all[0],
              "anisotropy: the nearest isotropic stiffness (Material/Voigt "
              "matrix=,Material/Young's modulus=2.5,Material/Poisson's "
              "ratio=0.25)");
  }



  TEST(EffectVariants, NearestIsotropicStiffnessIsAProjection)
  {
    FullMatrix<double> voigt(6, 6);
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        voigt(i, j) = (i == j ? 4. + i : 0.) + 0.1 * (i + j);
    const Stiffness general          = Stiffness::anisotropic(voigt),
                    nearest          = nearest_isotropic(general);
    const SymmetricTensor<4, 3> rest = general.tensor() - nearest.tensor();
    // Orthogonal to all isotropic tensors, which these two span.
    const SymmetricTensor<2, 3> identity = unit_symmetric_tensor<3>();
    for (const SymmetricTensor<4, 3> &isotropic :
         {outer_product(identity, identity), deviator_tensor<3>()})
      {
        double product = 0.;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            for (unsigned int k = 0; k < 3; ++k)
              for (unsigned int l = 0; l < 3; ++l)
                product += rest[i][j][k][l] * isotropic[i][j][k][l];
        EXPECT_NEAR(product, 0., 1e-13);
      }
    EXPECT_GT(rest.norm(), 1.);
    const Stiffness again = nearest_isotropic(nearest);
    EXPECT_NEAR(again.shear_modulus(), nearest.shear_modulus(), 1e-14);
    EXPECT_NEAR(again.bulk_modulus(), nearest.bulk_modulus(), 1e-13);
  }



  TEST(EffectVariants, WhatExcludesWhat)
  {
    const auto set = [](const std::string              &effect,
                        const std::vector<std::string> &overrides) {
      return EffectVariant{effect, "", overrides};
    };
    const EffectVariant elastic = set("flow", {"Material/Law=elastic"}),
                        power   = set("power", {"Material/norton/Exponent=1"}),
                        free    = set("friction", {"Boundary 2/Bound=0"}),
                        stick   = set("slip", {"Boundary 2/Bound=9"}),
                        load =
                          set("load",
                              {"Boundary 1/Traction=1", "A/Equilibrate=true"}),
                        other = set("other", {"A/Equilibrate=true"});
    EXPECT_TRUE(elastic.excludes(power));
    EXPECT_TRUE(power.excludes(elastic));
    EXPECT_TRUE(free.excludes(stick));
    EXPECT_TRUE(free.excludes(free));
    EXPECT_FALSE(free.excludes(elastic));
    EXPECT_FALSE(load.excludes(other));
    EXPECT_EQ(both(free, load).overrides.size(), 3u);
  }



  TEST(EffectVerdicts, ByTheLargestChangeForItsError)
  {
    const auto judged = [](const std::vector<QuantityChange> &changes,
                           const EffectKind kind = EffectKind::problem) {
      EffectResult result;
      result.variant.kind = kind;
      result.changes      = changes;
      judge(result, 1e-6);
      return result;
    };
    const EffectResult clear =
      judged({{"reaction", 0.5, 0.4}, {"force", 0.03, 0.01}});
    EXPECT_EQ(clear.verdict, EffectVerdict::called_for);
    EXPECT_EQ(clear.decisive.quantity, "force");
    EXPECT_EQ(judged({{"force", 0.015, 0.01}}).verdict,
              EffectVerdict::as_large_as_the_error);
    EXPECT_EQ(judged({{"force", 0.005, 0.01}}).verdict,
              EffectVerdict::below_the_error);
    EXPECT_EQ(judged({{"force", 1e-7, 0.}}).verdict,
              EffectVerdict::never_acted);
    // Iterations may end elsewhere without an error bar.
    EXPECT_EQ(judged({{"force", 0.01, 0.02}}, EffectKind::observation).verdict,
              EffectVerdict::only_watches);
    EXPECT_EQ(judged({{"force", 0.05, 0.02}}, EffectKind::observation).verdict,
              EffectVerdict::called_for);
    // An error that is not known may be anything.
    EXPECT_EQ(judged({{"force", 3., std::nan("")}}).verdict,
              EffectVerdict::below_the_error);
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



  TEST(QuantityHistories, ContactForceOfOtherContactLaws)
  {
    const auto unilateral =
      table({0., 1.},
            {{"contact_force_y", {0., -4.}}, {"stored_energy", {0., 2.}}});
    const auto given   = table({0., 1.}, {{"stored_energy", {0., 1.}}});
    const auto changes = changes_between(unilateral, given);
    ASSERT_EQ(changes.size(), 2u);
    EXPECT_EQ(changes[0].quantity, "contact_force");
    EXPECT_EQ(changes[0].change, 0.);
    EXPECT_DOUBLE_EQ(changes[1].change, 0.5);
    const auto weaker =
      table({0., 1.},
            {{"contact_force_y", {0., -3.}}, {"stored_energy", {0., 2.}}});
    EXPECT_DOUBLE_EQ(changes_between(unilateral, weaker)[0].change, 0.25);
  }



  TEST(QuantityHistories, WhatDoesNotAddUp)
  {
    const auto of = [](const double force, const double energy) {
      return table({0., 1.},
                   {{"friction_force_x", {0., force}},
                    {"stored_energy", {0., energy}}});
    };
    // The force changes by -1 and -2, by both -3; the energy by -4 and -2, by
    // both -5.
    const auto found =
      interactions(of(10., 10.), of(9., 6.), of(8., 8.), of(7., 5.));
    ASSERT_EQ(found.size(), 2u);
    EXPECT_NEAR(found[0].change, 0., 1e-15);
    EXPECT_NEAR(found[1].change, 0.1, 1e-15);
  }
} // namespace
