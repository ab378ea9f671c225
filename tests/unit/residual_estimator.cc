// SPDX-License-Identifier: LGPL-2.1-or-later

// Error estimators in space against estimates by hand, on any number of ranks.

#include "sampled_body.h"
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/residual_estimator.h>
#include <viscoplastic_contact/error/space_estimator.h>

#include <cmath>
#include <sstream>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  const double mu     = 1. / 2.6; // of the default material, E = 1, nu = 0.3
  const double across = 0.3 / (1.3 * 0.4) + 2. * mu; // lambda + 2 mu

  /// r . M^-1 r with the acoustic tensor M of this material across a face.
  template <int dim>
  double
  compliance_product(const Tensor<1, dim> &r, const Tensor<1, dim> &normal)
  {
    const double r_n = r * normal;
    return r_n * r_n / across + (r * r - r_n * r_n) / mu;
  }



  template <typename Dimension>
  class Estimate : public testing::Test
  {};
  TYPED_TEST_SUITE(Estimate, Dimensions, );



  template <int dim>
  Vector<double>
  residual_estimate(const StressSpace<dim>   &stress_space,
                    const DistributedVector  &u,
                    const IrreversibleStress &z,
                    const double              t,
                    const DistributedVector  *multiplier_density)
  {
    const LocalCells<dim> cells(stress_space);
    return ResidualEstimator<dim>(cells).estimate(
      {u, z, t, multiplier_density});
  }



  /// E eps of linear_displacement() plus constant_stress().
  template <int dim>
  Stress
  patch_stress()
  {
    Stress strain;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = i; j < dim; ++j)
        strain[i][j] =
          0.5 * ((linear_displacement(Point<dim>(Point<dim>::unit_vector(j))) -
                  linear_displacement(Point<dim>()))[i] +
                 (linear_displacement(Point<dim>(Point<dim>::unit_vector(i))) -
                  linear_displacement(Point<dim>()))[j]);
    return Stiffness::isotropic(1., 0.3).stress(strain) + constant_stress();
  }



  /// Uniform stress and data that match it: y min is a Tresca or Coulomb face,
  /// y max carries a traction, x max is a foundation without friction.
  template <int dim>
  std::string
  patch(const bool coulomb, const Tensor<1, dim> &traction_error)
  {
    const Stress   stress = patch_stress<dim>();
    Tensor<1, dim> top;
    for (unsigned int d = 0; d < dim; ++d)
      top[d] = stress[1][d] + traction_error[d];
    std::ostringstream traction, normal_stress;
    traction.precision(17);
    normal_stress.precision(17);
    for (unsigned int d = 0; d < dim; ++d)
      traction << (d > 0 ? "; " : "") << top[d];
    normal_stress << stress[1][1];

    std::string text =
      box<dim>(2) + boundary(0, "set Role = clamped\n") +
      boundary(1, "set Role = clamped\n") +
      boundary(2,
               std::string("set Role = contact\n") +
                 (coulomb ? "set Friction law = coulomb\n"
                            "set Friction coefficient = 1\n"
                            "set Normal stress = " +
                              normal_stress.str() + "\n" :
                            "set Friction law = tresca\n"
                            "set Friction bound = 1\n")) +
      boundary(3,
               "set Role = traction\nset Traction = " + traction.str() + "\n");
    for (unsigned int id = 4; id < 2 * dim; ++id)
      text += boundary(id,
                       "set Role = displacement\n"
                       "set Displacement = 0; 0; 0\n");
    return text;
  }



  /// lambda_h of the patch: minus the tangential traction on the body.
  template <int dim>
  Tensor<1, dim>
  patch_multiplier(const Point<dim> &)
  {
    Tensor<1, dim> lambda;
    for (unsigned int d = 0; d < dim; ++d)
      if (d != 1)
        lambda[d] = patch_stress<dim>()[d][1];
    return lambda;
  }



  TYPED_TEST(Estimate, VanishesForUniformStress)
  {
    constexpr int dim = TypeParam::value;
    for (const bool coulomb : {false, true})
      for (const bool at_quadrature_points : {false, true})
        for (const bool mean_dilatation : {false, true})
          {
            SampledBody<dim> body(patch<dim>(coulomb, Tensor<1, dim>()),
                                  at_quadrature_points,
                                  mean_dilatation);
            body.distort();
            body.refine_where([](const Point<dim> &x) {
              return x[0] > 0.7 && x[dim - 1] < 0.5;
            });
            body.set_up();
            const DistributedVector u =
              body.interpolate(linear_displacement<dim>);
            const DistributedVector density =
              body.interpolate(patch_multiplier<dim>);
            const auto z =
              body.sample([](const Point<dim> &) { return constant_stress(); });
            EXPECT_LT(total_estimate(residual_estimate(
                                       *body.stress_space, u, z, 0., &density),
                                     body.triangulation),
                      1e-13);
            EXPECT_LT(total_estimate(kelly_estimate(*body.space, u),
                                     body.triangulation),
                      1e-13);
            // Without the friction force there is a residual.
            const DistributedVector none = body.space->ghosted_vector();
            EXPECT_GT(total_estimate(
                        residual_estimate(*body.stress_space, u, z, 0., &none),
                        body.triangulation),
                      1e-3);
          }
  }



  TYPED_TEST(Estimate, SeesWrongTractionWhereItActs)
  {
    constexpr int  dim = TypeParam::value;
    Tensor<1, dim> error;
    error[0] = 0.3;
    error[1] = -0.4;
    SampledBody<dim> body(patch<dim>(false, error));
    body.refine_where([](const Point<dim> &x) { return x[0] < 0.7; });
    body.set_up();
    const DistributedVector density = body.interpolate(patch_multiplier<dim>);
    const Vector<double>    estimate =
      residual_estimate(*body.stress_space,
                        body.interpolate(linear_displacement<dim>),
                        body.sample(
                          [](const Point<dim> &) { return constant_stress(); }),
                        0.,
                        &density);
    for (const auto &cell : body.triangulation.active_cell_iterators())
      {
        double expected = 0.;
        if (cell->is_locally_owned())
          for (const unsigned int f : cell->face_indices())
            if (cell->at_boundary(f) && cell->face(f)->boundary_id() == 3)
              // the width across the face times its measure
              expected = cell->measure() / 6. *
                         compliance_product(error, Point<dim>::unit_vector(1));
        EXPECT_NEAR(estimate[cell->active_cell_index()], expected, 1e-14);
      }
  }



  /// The estimate of a body that is moved by w into the foundation below it,
  /// with a pressure p that contradicts the law of the foundation.
  TYPED_TEST(Estimate, SeesStatesThatNoFoundationHas)
  {
    constexpr int dim = TypeParam::value;
    struct Case
    {
      double w, p, nearest_w, nearest_p; // by the law for p and for w
    };
    const std::string rigid = "set Contact law = unilateral\n",
                      soft  = "set Contact law = normal compliance\n"
                              "set Compliance = 4\n"
                              "set Compliance exponent = 2\n";
    // the compliance law 4 w^2 is 0.01 at w = 0.05
    constexpr double                                             none = 1e10;
    const std::vector<std::pair<std::string, std::vector<Case>>> foundations{
      {rigid,
       {{0.01, 0., 0., none},
        {0.01, 0.2, 0., none},
        {-0.01, 0., -0.01, 0.},
        {-0.01, 0.2, 0., 0.},
        {-0.01, 1e-3, 0., 0.}}},
      {soft,
       {{0.05, 0.01, 0.05, 0.01},
        {0.05, 0.02, std::sqrt(0.005), 0.01},
        {0.5, 0.25, 0.25, 1.},
        {0.05, 0., 0., 0.01},
        {-0.01, 1e-3, std::sqrt(2.5e-4), 0.},
        {-0.01, 0., -0.01, 0.}}}};
    for (const auto &[foundation, cases] : foundations)
      for (const bool moves : {false, true})
        {
          std::string text =
            box<dim>(2) +
            boundary(2,
                     "set Role = contact\n" + foundation +
                       "set Gap = " + (moves ? "0.06*t" : "0.03") +
                       "\nset Friction law = none\n");
          for (unsigned int id = 0; id < 2 * dim; ++id)
            if (id != 2)
              text += boundary(id, "set Role = clamped\n");
          SampledBody<dim> body(text);
          body.refine_where([](const Point<dim> &x) { return x[0] < 0.7; });
          body.set_up();
          const auto downwards = [](const double value) {
            return [value](const Point<dim> &) {
              return -value * Point<dim>::unit_vector(1);
            };
          };
          for (const Case &c : cases)
            {
              const DistributedVector density =
                body.interpolate(downwards(c.p));
              const Vector<double> estimate =
                residual_estimate(*body.stress_space,
                                  body.interpolate(downwards(0.03 + c.w)),
                                  {},
                                  0.5,
                                  &density);
              for (const auto &cell :
                   body.triangulation.active_cell_iterators())
                {
                  double expected = 0.;
                  if (cell->is_locally_owned())
                    for (const unsigned int f : cell->face_indices())
                      if (cell->at_boundary(f) &&
                          cell->face(f)->boundary_id() == 2)
                        {
                          const double h = cell->face(f)->diameter();
                          const double off =
                            std::min(2. * mu / h * std::abs(c.w - c.nearest_w),
                                     std::abs(c.p - c.nearest_p));
                          // the body has no stress to balance the pressure
                          expected = cell->measure() / 6. *
                                     (off * off / mu + c.p * c.p / across);
                        }
                  EXPECT_NEAR(estimate[cell->active_cell_index()],
                              expected,
                              1e-14)
                    << foundation << c.w << ' ' << c.p;
                }
            }
        }
  }



  /// A kink of the displacement between two materials is no error.
  TYPED_TEST(Estimate, RecoveredStrainOfTwoMaterialsIsThatOfEach)
  {
    constexpr int dim = TypeParam::value;
    for (const bool has_two : {false, true})
      for (const bool at_quadrature_points : {false, true})
        {
          SampledBody<dim> body(box_with<dim>("set Role = clamped\n") +
                                  "subsection Material 0\nend\n"
                                  "subsection Material 3\n"
                                  "set Young's modulus = 7\nend\n",
                                at_quadrature_points);
          for (const auto &cell : body.triangulation.active_cell_iterators())
            cell->set_material_id(has_two && cell->center()[0] > 1. ? 3 : 0);
          body.refine_where(
            [](const Point<dim> &x) { return x[0] > 0.7 && x[dim - 1] < 0.5; });
          body.set_up();
          const auto field = [](const Point<dim> &x) {
            Tensor<1, dim> u = linear_displacement(x);
            u[1] += 0.7 * std::max(0., x[0] - 1.);
            return u;
          };
          State<dim> state;
          state.u = body.interpolate(field);
          const double estimate =
            total_estimate(squared_recovery_estimate(*body.stress_space, state),
                           body.triangulation);
          if (has_two)
            EXPECT_LT(estimate, 1e-13);
          else
            EXPECT_GT(estimate, 0.01);
        }
  }



  /// For a quadratic displacement the recovered strain is exact at inner nodes,
  /// and has the error of the cells' strains at the boundary.
  TYPED_TEST(Estimate, RecoveredStrainTellsTheError)
  {
    constexpr int    dim = TypeParam::value;
    SampledBody<dim> body(box_with<dim>("set Role = clamped\n"));
    body.refine_where([](const Point<dim> &) { return true; });
    body.set_up();
    State<dim> state;
    state.u = body.interpolate([](const Point<dim> &x) {
      Tensor<1, dim> u;
      u[0] = x[0] * x[0];
      return u;
    });
    const Vector<double> estimate =
      squared_recovery_estimate(*body.stress_space, state);
    const double lambda = 0.3 / (1.3 * 0.4);
    for (const auto &cell : body.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const double h        = cell->extent_in_direction(0);
          const double expected = (lambda + 2. * mu) * h * h / 3.;
          EXPECT_NEAR(estimate[cell->active_cell_index()],
                      expected * cell->measure(),
                      1e-14);
        }
  }



  TYPED_TEST(Estimate, SeesStressJumpsOnHangingFaces)
  {
    // z jumps at x = 1, where cells of different size meet.
    constexpr int dim = TypeParam::value;
    for (const bool left_is_finer : {false, true})
      {
        SampledBody<dim> body(box_with<dim>("set Role = clamped\n"));
        body.refine_where([left_is_finer](const Point<dim> &x) {
          return (x[0] < 1.) == left_is_finer;
        });
        body.set_up();
        const auto     z = body.sample([](const Point<dim> &x) {
          return (x[0] < 1. ? 1. : -1.) * constant_stress();
        });
        Tensor<1, dim> jump;
        for (unsigned int d = 0; d < dim; ++d)
          jump[d] = 2. * constant_stress()[0][d];
        const Vector<double> estimate = residual_estimate(
          *body.stress_space, body.space->ghosted_vector(), z, 0., nullptr);
        // Estimates are by the width of cells on either side of the interface,
        // which has measure 1.
        double left = 0., right = 0.;
        for (const auto &cell : body.triangulation.active_cell_iterators())
          {
            const double value = estimate[cell->active_cell_index()];
            (cell->center()[0] < 1. ? left : right) += value;
            if (std::abs(cell->center()[0] - 1.) > 0.26)
              {
                // These are squares of the rounding of tractions of size 1.
                EXPECT_LE(value, 1e-30);
              }
          }
        const double product =
          compliance_product(jump, Point<dim>::unit_vector(0));
        EXPECT_NEAR(Utilities::MPI::sum(left, MPI_COMM_WORLD),
                    (left_is_finer ? 0.25 : 0.5) / 24. * product,
                    1e-13);
        EXPECT_NEAR(Utilities::MPI::sum(right, MPI_COMM_WORLD),
                    (left_is_finer ? 0.5 : 0.25) / 24. * product,
                    1e-13);
      }
  }



  TYPED_TEST(Estimate, SeesMaterialInterfacesAcrossRanks)
  {
    // The strain is uniform and the moduli jump: the traction eps_xx (lambda +
    // 2 mu) jumps, and each side has its own acoustic tensor.
    constexpr int    dim = TypeParam::value;
    SampledBody<dim> body(box_with<dim>("set Role = clamped\n") +
                          "subsection Material\n"
                          "set Young's modulus = if(x < 1, 1, 3)\n"
                          "set Poisson's ratio = 0\nend\n");
    body.set_up();
    const DistributedVector u = body.interpolate([](const Point<dim> &x) {
      Tensor<1, dim> u;
      u[0] = x[0];
      return u;
    });
    const Vector<double>    estimate =
      residual_estimate(*body.stress_space, u, {}, 0., nullptr);
    const double square = 0.5 / 24. * 4.; // E = lambda + 2 mu for nu = 0
    double       left = 0., right = 0.;
    for (const auto &cell : body.triangulation.active_cell_iterators())
      (cell->center()[0] < 1. ? left : right) +=
        estimate[cell->active_cell_index()];
    EXPECT_NEAR(Utilities::MPI::sum(left, MPI_COMM_WORLD), square, 1e-13);
    EXPECT_NEAR(Utilities::MPI::sum(right, MPI_COMM_WORLD), square / 3., 1e-13);
  }
} // namespace
