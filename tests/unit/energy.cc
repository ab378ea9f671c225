// SPDX-License-Identifier: LGPL-2.1-or-later

// Integrals over stresses: homogeneous states, known by hand.

#include "body.h"
#include "refusals.h"
#include <viscoplastic_contact/discretization/energy.h>

#include <cmath>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  using Stress = SymmetricTensor<2, 3>;

  template <typename Dimension>
  class Energy : public testing::Test
  {};
  TYPED_TEST_SUITE(Energy, Dimensions, );



  template <int dim>
  std::string
  scene()
  {
    std::string text = box<dim>(2,
                                "set Translation = 0.1, 0.2" +
                                  std::string(dim == 3 ? ", 0.3" : ""));
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id, "set Role = clamped");
    return text;
  }



  constexpr double volume = 2.;



  Stress
  some_stress(const double scale)
  {
    Stress stress;
    stress[0][0] = 0.3 * scale;
    stress[1][1] = -0.2 * scale;
    stress[2][2] = 0.7 * scale;
    stress[0][1] = 0.5 * scale;
    return stress;
  }



  /// A homogeneous strain, its displacement, and z that makes a given stress.
  template <int dim>
  State<dim>
  homogeneous(const Body<dim> &body, const double stretch, const Stress &stress)
  {
    State<dim> state;
    state.u = body.interpolate([stretch](const Point<dim> &x) {
      Tensor<1, dim> u;
      u[0] = stretch * (x[0] + x[1]);
      u[1] = -0.5 * stretch * x[1];
      return u;
    });
    Stress strain;
    strain[0][0] = stretch;
    strain[1][1] = -0.5 * stretch;
    strain[0][1] = 0.5 * stretch;
    state.z.assign(body.stress_space->n_cells() * body.stress_space->n_samples,
                   stress - (*body.moduli)(0).stress(strain));
    return state;
  }



  TYPED_TEST(Energy, HomogeneousStress)
  {
    constexpr int dim = TypeParam::value;
    for (const bool at_quadrature_points : {false, true})
      for (const bool mean_dilatation : {false, true})
        {
          Body<dim> body(scene<dim>() +
                           subsection("Material", "set Law = maxwell"),
                         at_quadrature_points,
                         mean_dilatation);
          body.refine_where([](const Point<dim> &x) { return x[0] < 1.; });
          body.set_up();
          const Stress     old_stress = some_stress(1.);
          const Stress     stress     = some_stress(1.8);
          const State<dim> old_state  = homogeneous(body, 0.1, old_stress);
          const State<dim> state      = homogeneous(body, 0.4, stress);
          const auto summary = summarize_stress(*body.stress_space, state);

          // The von Mises stress by its formula in components.
          const double s = 1.8;
          const double mises =
            s * std::sqrt(0.5 * (0.5 * 0.5 + 0.9 * 0.9 + 0.4 * 0.4) +
                          3. * 0.5 * 0.5);
          EXPECT_NEAR(summary.max_von_mises, mises, 1e-13);
          EXPECT_NEAR(summary.mean_von_mises, mises, 1e-13);
          // eps = 0.4 (1, 1/2; 1/2, -1/2)
          EXPECT_NEAR(summary.mean_strain, 0.4 * std::sqrt(1.75), 1e-13);
          EXPECT_NEAR(summary.stress_norm,
                      s * std::sqrt(volume * (0.09 + 0.04 + 0.49 + 2. * 0.25)),
                      1e-13);

          const Stress z = state.z[0], old_z = old_state.z[0];
          const auto   inverse = [](const Stress &tau) {
            // E = 1, nu = 0.3: (1 + nu) tau - nu tr(tau) I
            return 1.3 * tau - 0.3 * trace(tau) * unit_symmetric_tensor<3>();
          };
          const FlowEnergies energies =
            energies_of_flow(*body.laws, old_state, state);
          EXPECT_NEAR(energies.irreversible_energy,
                      0.5 * volume * (z * inverse(z)),
                      1e-13);
          EXPECT_NEAR(energies.viscous_dissipation,
                      -0.5 * volume *
                        (inverse(z - old_z) * (stress + old_stress)),
                      1e-13);
          EXPECT_NEAR(relative_stress_fluctuation(*body.stress_space, state),
                      0.,
                      1e-12);
        }
  }



  TYPED_TEST(Energy, ElasticBodyHasNoIrreversiblePart)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(scene<dim>());
    body.set_up();
    State<dim> state = homogeneous(body, 0.1, Stress());
    state.z.clear();
    const FlowEnergies energies = energies_of_flow(*body.laws, state, state);
    EXPECT_EQ(energies.irreversible_energy, 0.);
    EXPECT_EQ(energies.viscous_dissipation, 0.);
    Stress strain;
    strain[0][0] = 0.1;
    strain[1][1] = -0.05;
    strain[0][1] = 0.05;
    EXPECT_NEAR(summarize_stress(*body.stress_space, state).max_von_mises,
                von_mises((*body.moduli)(0).stress(strain)),
                1e-14);
  }



  TYPED_TEST(Energy, MeansWeighVolumesAndMaximaSeeAllCells)
  {
    // There is a stress in the right half only, where cells are smaller.
    constexpr int dim = TypeParam::value;
    Body<dim>     body(scene<dim>());
    const double  middle = 1.1;
    body.refine_where([&](const Point<dim> &x) { return x[0] > middle; });
    body.set_up();
    State<dim> state;
    state.u = body.space->ghosted_vector();
    for (std::size_t c = 0; c < body.stress_space->n_cells(); ++c)
      state.z.push_back(body.stress_space->position(c, 0)[0] > middle ?
                          some_stress(1.) :
                          Stress());
    const auto summary = summarize_stress(*body.stress_space, state);
    EXPECT_NEAR(summary.max_von_mises, von_mises(some_stress(1.)), 1e-14);
    EXPECT_NEAR(summary.mean_von_mises, 0.5 * summary.max_von_mises, 1e-14);
    EXPECT_NEAR(summary.stress_norm, some_stress(1.).norm(), 1e-14);
  }



  TYPED_TEST(Energy, FluctuationWithinCells)
  {
    // u_y = x y: eps_xy = y/2, eps_yy = x vary within cells of size h = 1/2 as
    // h/sqrt(12) in the mean square; here against a sum over one cell by hand.
    constexpr int dim = TypeParam::value;
    Body<dim>     body(scene<dim>());
    body.set_up();
    State<dim> state;
    state.u                   = body.interpolate([](const Point<dim> &x) {
      Tensor<1, dim> u;
      u[1] = x[0] * x[1];
      return u;
    });
    const Stiffness stiffness = (*body.moduli)(0);
    Stress          yy, xy;
    yy[1][1]                 = 1.;
    xy[0][1]                 = 0.5;
    const double shear       = stiffness.stress(xy) * stiffness.stress(xy);
    const double normal      = stiffness.stress(yy) * stiffness.stress(yy);
    const double h           = 0.5;
    const double fluctuation = volume * h * h / 12. * (shear + normal);
    // int x^2 over (0.1, 2.1) and int y^2 over (0.2, 1.2), each times the
    // length of the other sides.
    const double squared =
      shear * 2. * (1.728 - 0.008) / 3. + normal * (9.261 - 0.001) / 3.;
    // Mixed terms vanish: eps_xy and eps_yy are orthogonal.
    EXPECT_NEAR(relative_stress_fluctuation(*body.stress_space, state),
                std::sqrt(fluctuation / squared),
                1e-12);
  }



  // The energy evaluates parameters only of laws with an energy of their own:
  // at the end of a run others need not have a viscosity.
  TYPED_TEST(Energy, NeedsNoParametersOfMostLaws)
  {
    constexpr int dim         = TypeParam::value;
    const auto    energies_of = [](const std::string &law) {
      Body<dim> body(scene<dim>() + subsection("Material", law));
      body.set_up();
      State<dim> state = homogeneous(body, 0.1, some_stress(1.));
      state.t          = 2.;
      return energies_of_flow(*body.laws, state, state);
    };
    EXPECT_NO_THROW(energies_of(
      "set Law = maxwell\n" +
      subsection("maxwell", "set Viscosity = if(t > 1, -x - 1, x + 1)")));
    expect_refusal(
      [&] {
        energies_of(
          "set Law = zener\n" +
          subsection("zener", "set Relaxation time = if(t > 1, -x-1, x + 1)"));
      },
      "it must be positive");
  }



  TYPED_TEST(Energy, LawsAreCheckedAtAllSamples)
  {
    // The program ends all ranks if one refuses, which a test cannot do.
    if (Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      GTEST_SKIP() << "what is wrong on one rank only is refused there";
    constexpr int dim  = TypeParam::value;
    const auto    make = [](const std::string &law) {
      // The Gauss points of the last column of cells are x = 1.61 and 1.89.
      auto body =
        std::make_unique<Body<dim>>(scene<dim>() + subsection("Material", law),
                                    /* at_quadrature_points = */ true);
      body->set_up();
      return body;
    };
    // The viscosity is wrong only later, or far from the first samples.
    for (const std::string viscosity :
         {"if(t > 1 && x > 1.8, -1, 1)", "if(t > 1, -1, 1)"})
      {
        const auto body =
          make("set Law = maxwell\n" +
               subsection("maxwell", "set Viscosity = " + viscosity));
        EXPECT_NO_THROW(body->laws->check(1.));
        expect_refusal([&] { body->laws->check(1.5); },
                       "'Material/maxwell/Viscosity' is -1 at x = (");
      }
    // Check the modulus also if another parameter depends on time.
    for (const std::string time : {"1", "1 + t"})
      {
        const std::string law = "set Relaxation time = " + time + "\n" +
                                "set Long-term Poisson's ratio = 0.3\n"
                                "set Long-term Young's modulus = ";
        const auto make_zener = [&](const std::string &modulus) {
          make("set Law = zener\n" + subsection("zener", law + modulus));
        };
        EXPECT_NO_THROW(make_zener("if(x > 1.8, 0.9, 0.5)"));
        expect_refusal([&] { make_zener("if(x > 1.8, 1.1, 0.5)"); },
                       "makes the body stiffer in the long term");
      }
  }
} // namespace
