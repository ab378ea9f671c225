// SPDX-License-Identifier: LGPL-2.1-or-later

// The residual estimator against its plain form, and the estimate of errors.
// Every test holds on any number of ranks.

#include <deal.II/grid/grid_tools.h>

#include "body.h"
#include "plain_estimator.h"
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/error/error_estimator.h>
#include <viscoplastic_contact/error/residual_estimator.h>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  template <typename Dimension>
  class ErrorEstimators : public testing::Test
  {};
  TYPED_TEST_SUITE(ErrorEstimators, Dimensions);



  /// A scene with all boundary roles, both friction laws and all data.
  template <int dim>
  std::string
  many_boundaries(const std::string &material)
  {
    const std::string zero = dim == 3 ? "; 0" : "";
    std::string       text =
      box<dim>(2) + subsection("Material", material) +
      subsection("Loads", "set Body force = x*t; y - t" + zero) +
      boundary(0,
               "set Role = displacement\nset Displacement = 0; free" + zero) +
      boundary(1, "set Role = traction\nset Traction = x + t; y*t" + zero) +
      boundary(2,
               "set Role = contact\nset Friction law = tresca\n"
               "set Friction bound = 0.1 + if(x < 1, 0, t)") +
      boundary(3,
               "set Role = contact\nset Friction law = coulomb\n"
               "set Friction coefficient = 0.3\n"
               "set Normal stress = -1 - x*t");
    if (dim == 3)
      text +=
        boundary(4, "set Role = symmetry") + boundary(5, "set Role = clamped");
    return text;
  }



  TYPED_TEST(ErrorEstimators, FastEstimatorIsThePlainOne)
  {
    constexpr int     dim = TypeParam::value;
    const std::string anisotropic =
      "set Law = maxwell\nset Voigt matrix = 3, 1, 1, 0, 0, 0; "
      "1, 4, 1, 0, 0, 0.2; 1, 1, 5, 0, 0, 0; 0, 0, 0, 1, 0.1, 0; "
      "0, 0, 0, 0.1, 1, 0; 0, 0.2, 0, 0, 0, 1";
    const std::string isotropic =
      "set Law = maxwell\nset Young's modulus = 1 + x";
    for (const bool distorted : {false, true})
      for (const bool mean_dilatation : {false, true})
        for (const std::string &material : {isotropic, anisotropic})
          {
            Body<dim> body(many_boundaries<dim>(material),
                           /* at_quadrature_points = */ distorted,
                           mean_dilatation);
            body.refine_where([](const Point<dim> &x) {
              return x[0] > 0.6 && x[dim - 1] < 0.5;
            });
            if (distorted)
              GridTools::transform(
                [](Point<dim> x) {
                  // The boundary stays flat.
                  const double bump = 0.3 * x[0] * (2. - x[0]) * x[1] *
                                      (1. - x[1]) *
                                      (dim == 3 ? x[2] * (1. - x[2]) * 4. : 1.);
                  x[0] += bump;
                  x[1] -= 0.5 * bump;
                  return x;
                },
                body.triangulation);
            body.set_up();
            IrreversibleStress z;
            for (std::size_t c = 0; c < body.stress_space->n_cells(); ++c)
              for (unsigned int s = 0; s < body.stress_space->n_samples; ++s)
                {
                  SymmetricTensor<2, 3> sample;
                  for (unsigned int i = 0; i < 6; ++i)
                    sample.access_raw_entry(i) =
                      std::sin(i + 5. * body.stress_space->position(c, s)[0] +
                               9. * body.stress_space->position(c, s)[1]);
                  z.push_back(sample);
                }
            const DistributedVector u       = body.rough_vector(),
                                    density = body.rough_vector(0.7);
            const LocalCells<dim>        cells(*body.stress_space);
            const ResidualEstimator<dim> estimator(cells);
            for (const double t : {0., 0.4})
              {
                const Vector<double> plain = plain_residual_estimate(
                                       *body.stress_space, u, z, t, &density),
                                     fast =
                                       estimator.estimate({u, z, t, &density});
                ASSERT_EQ(plain.size(), fast.size());
                double difference = 0.;
                for (unsigned int i = 0; i < plain.size(); ++i)
                  difference =
                    std::max(difference, std::abs(plain[i] - fast[i]));
                EXPECT_GT(Utilities::MPI::max(plain.linfty_norm(),
                                              MPI_COMM_WORLD),
                          1.);
                EXPECT_LT(difference,
                          1e-10 * Utilities::MPI::max(plain.linfty_norm(),
                                                      MPI_COMM_WORLD));
              }
          }
  }


  TEST(ErrorBudget, SharesAreWhatCostsLeast)
  {
    // Compare the cost e_h^-d e_k^(-1/p) with that of other shares.
    for (const unsigned int d : {2, 3})
      for (const unsigned int p : {1, 2})
        {
          const ErrorBudget budget(0.1, d, p);
          const auto        cost = [&](const double e_k) {
            return std::pow(0.1 - e_k, -static_cast<double>(d)) *
                   std::pow(e_k, -1. / p);
          };
          const double chosen = budget.time_tolerance();
          EXPECT_LT(cost(chosen), cost(0.9 * chosen));
          EXPECT_LT(cost(chosen), cost(1.1 * chosen));
        }
  }



  TEST(ErrorBudget, TheMeshHasWhatIsLeft)
  {
    ErrorBudget budget(0.1, 2, 2); // of which 0.02 is for time steps
    budget.expect_size(2. / 0.95);
    EXPECT_DOUBLE_EQ(budget.size(1.), 2.);
    EXPECT_DOUBLE_EQ(budget.size(3.), 3.);
    EXPECT_DOUBLE_EQ(budget.initial(), 0.05);
    ErrorEstimate estimate;
    EXPECT_DOUBLE_EQ(budget.space(estimate, 2., false), 0.2);
    EXPECT_DOUBLE_EQ(budget.space(estimate, 2., true), 0.16);
    estimate.time    = 0.05; // more than its share
    estimate.initial = 0.02;
    EXPECT_DOUBLE_EQ(budget.space(estimate, 2., true), 0.13);
    estimate.initial = 1.; // too large to make up for
    EXPECT_DOUBLE_EQ(budget.space(estimate, 2., true), 0.08);
  }
} // namespace
