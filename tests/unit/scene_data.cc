// SPDX-License-Identifier: LGPL-2.1-or-later

// Means of the data of a scene over its boundary, its body and its time.

#include "folder.h"
#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/laws/stiffness.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/run/scene_as_json.h>
#include <viscoplastic_contact/run/scene_data.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace
{
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  /// A box of two materials, with hanging nodes, and its data.
  template <int dim>
  struct Box
  {
    explicit Box(const std::string &more = "")
      : scene({folder.add("scene.prm", text(more))})
      , mesh(MPI_COMM_WORLD)
      , data(scene, mesh)
    {
      make_mesh(scene.geometry, mesh);
    }

    static std::string
    text(const std::string &more)
    {
      std::string result = "set Dimension = " + std::to_string(dim) +
                           "\nsubsection Geometry\nset Arguments = " +
                           (dim == 2 ? "4, 2 : 0, 0 : 2, 1 : true" :
                                       "4, 2, 1 : 0, 0, 0 : 2, 1, 1 : true") +
                           "\nset Material ids = if(x < 1, 0, 7)\n"
                           "set Boundary refinements = 1: 1\nend\n"
                           "subsection Time\nset Phases = 1: 4, 3: 2\nend\n";
      for (unsigned int id = 0; id < 2 * dim; ++id)
        result += "subsection Boundary " + std::to_string(id) +
                  "\nset Role = " + (id == 0 ? "clamped" : "free") + "\nend\n";
      return result + more;
    }

    Folder                                    folder;
    const Parameters                          scene;
    parallel::distributed::Triangulation<dim> mesh;
    const SceneData<dim>                      data;
  };



  double
  value(const std::string &text, const double x, const double t)
  {
    return Expression<2>(text, "mean").value(Point<2>(x, 0.), t);
  }



  TEST(SceneData, MeansOverABoundary)
  {
    const Box<2> square;
    const Box<3> cube;
    EXPECT_NEAR(value(*square.data.over_space("x^2",
                                              {Domain::Kind::boundary, 2}),
                      0.,
                      0.),
                4. / 3.,
                1e-14);
    EXPECT_NEAR(value(*square.data.over_space("x + y^3",
                                              {Domain::Kind::boundary, 1}),
                      0.,
                      0.),
                2.25,
                1e-14);
    EXPECT_NEAR(value(*cube.data.over_space("x^2*y + z",
                                            {Domain::Kind::boundary, 4}),
                      0.,
                      0.),
                2. / 3.,
                1e-14);
    // Data that do not vary in space need no mean.
    EXPECT_NEAR(square.data.measure({Domain::Kind::boundary, 2}), 2., 1e-12);
    EXPECT_NEAR(cube.data.measure({Domain::Kind::boundary, 4}), 2., 1e-12);
    EXPECT_FALSE(square.data.over_space("3*t; 2", {Domain::Kind::boundary, 2}));
    EXPECT_FALSE(square.data.over_space("", {Domain::Kind::boundary, 2}));
  }



  TEST(SceneData, MeansOverTheBodyAndItsMaterials)
  {
    const Box<2> square;
    const Box<3> cube;
    EXPECT_NEAR(value(*square.data.over_space("x*y", {}), 0., 0.), 0.5, 1e-14);
    EXPECT_NEAR(value(*square.data.over_space("x", {Domain::Kind::material, 0}),
                      0.,
                      0.),
                0.5,
                1e-14);
    EXPECT_NEAR(value(*cube.data.over_space("x*y*z",
                                            {Domain::Kind::material, 7}),
                      0.,
                      0.),
                0.375,
                1e-14);
  }



  TEST(SceneData, ChangesInTimeStay)
  {
    const Box<2>      square;
    const std::string mean =
      *square.data.over_space("x*t^2", {Domain::Kind::boundary, 3});
    // The mean is exact at the ends of steps and linear between them.
    for (const double t : {0., 0.25, 0.5, 0.75, 1., 2., 3.})
      EXPECT_NEAR(value(mean, 0., t), t * t, 1e-13);
    EXPECT_NEAR(value(mean, 0., 2.5), 6.5, 1e-13);
    // Components without a value stay without one.
    EXPECT_EQ(*square.data.over_space("free; 0*x", {Domain::Kind::boundary, 2}),
              "free; 0");
    EXPECT_EQ(*square.data.over_space("t; x*0", {Domain::Kind::boundary, 2}),
              "t; 0");
  }



  TEST(SceneData, MeansOverTheRun)
  {
    const Box<2> square;
    EXPECT_NEAR(value(*square.data.over_time("t^3"), 0., 7.), 6.75, 1e-13);
    // The datum has a kink at the end of a phase.
    EXPECT_NEAR(value(*square.data.over_time("min(t, 1)"), 0., 7.),
                2.5 / 3.,
                1e-14);
    // The mean over time still varies in space; the letter t in other names is
    // not the time.
    const std::string mean = *square.data.over_time("sqrt(x)*t^2 + tan(0)*t");
    for (const double x : {0., 1., 4.})
      EXPECT_NEAR(value(mean, x, 7.), 3. * std::sqrt(x), 1e-13);
    EXPECT_FALSE(square.data.over_time("x; "));
  }



  TEST(SceneData, WhatAutomaticStandsFor)
  {
    const auto of = [](const std::string &material) {
      const Box<2> box("subsection Material 0\nend\nsubsection Material 7\n" +
                       material + "end\n");
      return nlohmann::json::parse(scene_as_json(
        box.scene, false, MPI_COMM_WORLD))["volumetric_integration"];
    };
    EXPECT_EQ(of(""), name_of(VolumetricIntegration::full));
    EXPECT_EQ(of("set Law = maxwell\n"),
              name_of(VolumetricIntegration::mean_dilatation));
    EXPECT_EQ(of("set Poisson's ratio = 0.3 + 0.1*x\n"),
              name_of(VolumetricIntegration::mean_dilatation));
    EXPECT_EQ(of("set Law = maxwell\nend\nsubsection Material\n"
                 "set Volumetric integration = full\n"),
              name_of(VolumetricIntegration::full));
  }



  TEST(SceneData, RampsOnlyWhereTheSlopeChanges)
  {
    const std::vector<double> t{0., 0.1, 0.2, 0.3, 0.7, 1.},
      v{1., 1., 1.05, 1.1, 1.1, -1.};
    const std::string text = piecewise_linear(t, v);
    for (std::size_t i = 0; i < t.size(); ++i)
      EXPECT_NEAR(value(text, 0., t[i]), v[i], 1e-13);
    EXPECT_NEAR(value(text, 0., 0.25), 1.075, 1e-13);
    unsigned int n = 0;
    for (std::size_t i = text.find("max"); i != std::string::npos;
         i             = text.find("max", i + 1))
      ++n;
    EXPECT_EQ(n, 3u);
    EXPECT_EQ(piecewise_linear(t, {2., 2., 2., 2., 2., 2.}), "2");
  }



  TEST(SceneAsJson, SaysWhatVariesAndWhatItsMeansAre)
  {
    const Folder     folder;
    const Parameters scene(
      {folder.add("scene.prm", Box<2>::text("")),
       folder.add("more.prm",
                  "subsection Material 0\n"
                  "set Young's modulus = 1 + x\nend\n"
                  "subsection Material 7\nset Voigt matrix = "
                  "3, 1, 1, 0, 0, 0; 1, 3, 1, 0, 0, 0; 1, 1, 3, 0, 0, 0; "
                  "0, 0, 0, 1, 0, 0; 0, 0, 0, 0, 1, 0; 0, 0, 0, 0, 0, 1\n"
                  "end\nsubsection Boundary 3\nset Role = contact\n"
                  "set Friction law = tresca\n"
                  "set Friction bound = 2*t\nend\n")});
    const auto of = [&](const bool with_means) {
      return nlohmann::json::parse(
        scene_as_json(scene, with_means, MPI_COMM_WORLD));
    };
    const nlohmann::json plain = of(false);
    EXPECT_EQ(plain["dimension"], 2);
    EXPECT_EQ(plain["cells"], 14); // eight, of which two are refined
    EXPECT_NEAR(plain["h"], 0.5, 1e-14);
    // `automatic' is replaced by the choice if that is known.
    EXPECT_EQ(plain["values"]["Time/Scheme"], "forward Euler");
    EXPECT_EQ(plain["values"]["Mesh refinement/Strategy"], "none");
    EXPECT_EQ(plain["volumetric_integration"], "full");
    EXPECT_FALSE(plain.contains("means"));
    const nlohmann::json all = of(true);
    EXPECT_EQ(all["means"].size(), 2u);
    EXPECT_NEAR(value(all["means"]["Material 0/Young's modulus"]["over_space"],
                      0.,
                      0.),
                1.5,
                1e-13);
    EXPECT_NEAR(value(all["means"]["Boundary 3/Friction bound"]["over_time"],
                      0.,
                      0.),
                3.,
                1e-13);
    EXPECT_EQ(all["areas"].size(), 1u);
    EXPECT_NEAR(all["areas"]["3"], 2., 1e-13);
    EXPECT_NEAR(all["nearest_isotropic"]["Material 7"][0], 2.5, 1e-13);
    EXPECT_NEAR(all["nearest_isotropic"]["Material 7"][1], 0.25, 1e-13);
  }



  TEST(SceneAsJson, NearestIsotropicStiffnessIsAProjection)
  {
    using namespace dealii;
    FullMatrix<double> voigt(6, 6);
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        voigt(i, j) = (i == j ? 4. + i : 0.) + 0.1 * (i + j);
    const auto nearest_isotropic = [](const Stiffness &stiffness) {
      const double nu = stiffness.poissons_ratio();
      return Stiffness::isotropic(2. * (1. + nu) * stiffness.shear_modulus(),
                                  nu);
    };
    const Stiffness general          = Stiffness::anisotropic(voigt),
                    nearest          = nearest_isotropic(general);
    const SymmetricTensor<4, 3> rest = general.tensor() - nearest.tensor();
    // The rest is orthogonal to all isotropic tensors, spanned by these two.
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
} // namespace
