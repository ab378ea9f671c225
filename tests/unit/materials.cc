// SPDX-License-Identifier: LGPL-2.1-or-later

// Materials, which consist of an elastic tensor and a law.

#include "refusals.h"
#include "tensors.h"
#include <viscoplastic_contact/parameters/entry.h>
#include <viscoplastic_contact/scene/material.h>

#include <gtest/gtest.h>


namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <int dim>
  Material<dim>
  make_material(const std::string &entries)
  {
    ParameterHandler   prm;
    MaterialParameters parameters;
    declare_section(prm, "Material 2", entries_in(parameters, built_in_laws()));
    prm.parse_input_from_string("subsection Material 2\n" + entries +
                                "\nend\n");
    return Material<dim>("Material 2", parameters, prm);
  }

  const std::string plane_voigt_matrix =
    "set Voigt matrix = 5, 1, 2, 0, 0, 0.3; 1, 6, 3, 0, 0, 0.4; 2, 3, 7, 0, "
    "0, 0.5; 0, 0, 0, 8, 0.6, 0; 0, 0, 0, 0.6, 9, 0; 0.3, 0.4, 0.5, 0, 0, 10";



  TEST(Materials, Isotropic)
  {
    const auto material = make_material<2>("set Young's modulus = 1 + x\n"
                                           "set Poisson's ratio = 0.1*y");
    EXPECT_EQ(material.section, "Material 2");
    EXPECT_EQ(material.law_name, "elastic");
    EXPECT_EQ(material.law, nullptr);
    EXPECT_FALSE(material.is_uniform());
    const Stiffness expected = Stiffness::isotropic(4., 0.2);
    const Stiffness E        = material.stiffness(Point<2>(3., 2.));
    EXPECT_EQ(E.shear_modulus(), expected.shear_modulus());
    EXPECT_EQ(E.bulk_modulus(), expected.bulk_modulus());
    EXPECT_TRUE(make_material<3>("set Young's modulus = 2e9").is_uniform());
  }



  TEST(Materials, VoigtMatrix)
  {
    const auto plane = make_material<2>(plane_voigt_matrix);
    EXPECT_TRUE(plane.is_uniform());
    const Stiffness E = plane.stiffness(Point<2>());
    expect_near(E.stress(symmetric(1, 0, 0)), symmetric(5, 1, 2, 0.3), 1e-14);
    expect_near(E.stress(symmetric(0, 0, 0, 0.5)),
                symmetric(0.3, 0.4, 0.5, 10),
                1e-14);
    // A plane strain has no shear stress out of the plane.
    const Tensor2 stress = E.stress(symmetric(0.3, -0.4, 0, 0.7));
    EXPECT_EQ(stress[0][2], 0.);
    EXPECT_EQ(stress[1][2], 0.);

    // Coupling with yz, xz is for 3D only.
    std::string text = plane_voigt_matrix;
    text.replace(text.find("2, 3, 7, 0,"), 11, "2, 3, 7, 0.1,");
    text.replace(text.find("0, 0, 0, 8"), 10, "0, 0, 0.1, 8");
    EXPECT_NO_THROW(make_material<3>(text));
    expect_refusal([&] { make_material<2>(text); },
                   "'Material 2/Voigt matrix': the entry in row 3, column 4 "
                   "couples deformations in the plane with shear out of it; "
                   "it must be zero in plane strain (2D), or the scene be "
                   "3D.");
  }



  TEST(Materials, Refusals)
  {
    const auto refusal = [](const std::string &entries,
                            const std::string &sentence) {
      expect_refusal([&] { make_material<2>(entries); }, sentence);
    };
    refusal("set Young's modulus = -2e9",
            "'Material 2/Young's modulus' is -2e+09; it must be positive.");
    refusal("set Young's modulus = 1e-80",
            "'Material 2/Young's modulus' is 1e-80; it must lie between 1e-70 "
            "and 1e+70, where squares stay within the range of floating-point "
            "numbers; choose other units or look for a datum that is too large "
            "or too small.");
    refusal("set Young's modulus = 1 + t",
            "'Material 2/Young's modulus' depends on t; elastic moduli must be "
            "functions of position only.");
    refusal("set Poisson's ratio = 0.5",
            "'Material 2/Poisson's ratio' is 0.5; it must be larger than -1 "
            "and smaller than 0.5.");
    refusal("set Poisson's ratio = -1", "'Material 2/Poisson's ratio' is -1;");
    refusal("set Poisson's ratio = z",
            "The expression 'z' of 'Material 2/Poisson's ratio' cannot be "
            "parsed: there is no 'z'; its variables are x, y and t, and");
    const auto material = make_material<2>("set Young's modulus = 1 - x\n"
                                           "set Poisson's ratio = 1/y");
    expect_refusal([&] { material.stiffness(Point<2>(1., 4.)); },
                   "'Material 2/Young's modulus' is 0 at x = (1 4); it must be "
                   "positive.");
    expect_refusal([&] { material.stiffness(Point<2>(0., 2.)); },
                   "'Material 2/Poisson's ratio' is 0.5 at x = (0 2); it must "
                   "be larger than -1 and smaller than 0.5.");
    expect_refusal([&] { material.stiffness(Point<2>(0., 0.)); },
                   "The expression '1/y' of 'Material 2/Poisson's ratio' has "
                   "the value inf at x = (0 0), t = 0; it must be finite.");

    refusal(plane_voigt_matrix + "\nset Poisson's ratio = 0.2",
            "'Material 2' has a `Voigt matrix' and Young's modulus or "
            "Poisson's ratio; give either the matrix or these.");
    refusal("set Voigt matrix = 1, 2, 3",
            "'Material 2/Voigt matrix': there must be 6 rows separated by "
            "semicolons, not 1.");
    refusal("set Voigt matrix = 1; 2; 3; 4; 5; 6",
            "'Material 2/Voigt matrix': row 1 must have 6 numbers separated by "
            "commas, not 1.");
    std::string text = plane_voigt_matrix;
    text.replace(text.find("10"), 2, "ten");
    refusal(text, "'Material 2/Voigt matrix': 'ten' in row 6 is not a number.");
    text = plane_voigt_matrix;
    text.replace(text.find("10"), 2, "-10");
    refusal(text,
            "'Material 2/Voigt matrix': The smallest eigenvalue of the elastic "
            "tensor that the Voigt matrix gives is -20.");
    text = plane_voigt_matrix;
    text.replace(text.find("0.3"), 3, "0.4");
    refusal(text,
            "'Material 2/Voigt matrix': The Voigt matrix has 0.4 in row 1, "
            "column 6, and 0.3 in row 6, column 1; it must be symmetric and "
            "finite.");
  }



  TEST(Materials, HaveALaw)
  {
    const auto material =
      make_material<2>("set Law = maxwell\n"
                       "subsection maxwell\n set Viscosity = 3*x\nend");
    EXPECT_EQ(material.law_name, "maxwell");
    ASSERT_NE(material.law, nullptr);
    EXPECT_EQ(material.law->point(Point<3>(2, 0, 0), 0.).parameters[0], 6.);

    ParameterHandler   prm;
    MaterialParameters parameters;
    declare_section(prm, "Material 7", entries_in(parameters, built_in_laws()));
    prm.parse_input_from_string("subsection Material 7\n"
                                "set Law = perzyna\n"
                                "subsection perzyna\n"
                                "set Viscosity = x - z\nend\nend\n");
    expect_refusal(
      [&] { Material<2>("Material 7", parameters, prm); },
      "The expression 'x - z' of 'Material 7/perzyna/Viscosity' "
      "cannot be parsed: there is no 'z'; its variables are x, y, T "
      "and t, and pi and functions such as sin, exp, min and if are "
      "known.");
    // The refusal leaves the handler at the top level.
    EXPECT_NO_THROW(Material<3>("Material 7", parameters, prm));
  }
} // namespace
