// SPDX-License-Identifier: LGPL-2.1-or-later

// Error estimators, marking, and the transfer of a state to a new mesh. Every
// test holds on any number of ranks.

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/grid/grid_tools.h>

#include "body.h"
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/mesh_adaptation.h>
#include <viscoplastic_contact/error/residual_estimator.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using Testing::boundary;
  using Testing::box;
  using Testing::geometry;

  using Stress = SymmetricTensor<2, 3>;

  const double mu = 1. / 2.6; // of the default material, E = 1, nu = 0.3



  template <int dim>
  Vector<double>
  residual_estimate(const StressSpace<dim>   &stress_space,
                    const DistributedVector  &u,
                    const IrreversibleStress &z,
                    const double              t,
                    const DistributedVector  *multiplier_density)
  {
    return ResidualEstimator<dim>(stress_space)
      .estimate(u, z, t, multiplier_density);
  }



  /// The box in 4 x 2 (x 2) cells, all of whose faces have one role.
  template <int dim>
  std::string
  box_with(const std::string &entries)
  {
    std::string text = box<dim>(2);
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id, entries);
    return text;
  }



  template <int dim>
  struct Body : public Testing::Body<dim>
  {
    using Testing::Body<dim>::Body;
    using Testing::Body<dim>::stress_space;

    /// Move inner points of the box, so that no cell stays a parallelogram.
    void
    distort()
    {
      GridTools::transform(
        [](const Point<dim> &x) {
          double bubble = x[0] * (2. - x[0]);
          for (unsigned int d = 1; d < dim; ++d)
            bubble *= 4. * x[d] * (1. - x[d]);
          Point<dim> y = x;
          y[0] += 0.1 * bubble;
          y[1] -= 0.15 * bubble * x[0];
          return y;
        },
        this->triangulation);
    }

    IrreversibleStress
    sample(const std::function<Stress(const Point<dim> &)> &field) const
    {
      IrreversibleStress z;
      for (std::size_t c = 0; c < stress_space->n_cells(); ++c)
        for (unsigned int s = 0; s < stress_space->n_samples; ++s)
          z.push_back(field(stress_space->position(c, s)));
      return z;
    }

    Stress
    integral(const IrreversibleStress &z) const
    {
      Stress result;
      for (std::size_t c = 0; c < stress_space->n_cells(); ++c)
        for (unsigned int s = 0; s < stress_space->n_samples; ++s)
          result +=
            stress_space->weight(c, s) * z[c * stress_space->n_samples + s];
      return Utilities::MPI::sum(result, MPI_COMM_WORLD);
    }

    double
    max_difference(const IrreversibleStress                        &z,
                   const std::function<Stress(const Point<dim> &)> &field) const
    {
      const IrreversibleStress exact  = sample(field);
      double                   result = 0.;
      for (std::size_t i = 0; i < z.size(); ++i)
        result = std::max(result, (z[i] - exact[i]).norm());
      return Utilities::MPI::max(result, MPI_COMM_WORLD);
    }
  };



  template <int dim>
  Tensor<1, dim>
  linear_displacement(const Point<dim> &x)
  {
    Tensor<1, dim> u;
    for (unsigned int i = 0; i < dim; ++i)
      {
        u[i] = 0.3 * (i + 1.);
        for (unsigned int j = 0; j < dim; ++j)
          u[i] += (0.7 * i - 0.4 * j + 0.1 * i * j + 0.2) * x[j];
      }
    return u;
  }



  template <int dim>
  Stress
  linear_stress(const Point<dim> &x)
  {
    Stress z;
    for (unsigned int e = 0; e < Stress::n_independent_components; ++e)
      for (unsigned int d = 0; d < dim; ++d)
        z.access_raw_entry(e) += (1. + e - 2. * d) * x[d] + 0.1;
    return z;
  }



  template <int dim>
  Stress
  wavy_stress(const Point<dim> &x)
  {
    return (1. + std::sin(9. * x[0]) * std::cos(7. * x[dim - 1])) *
           linear_stress(x);
  }



  const Stress &
  constant_stress()
  {
    static const Stress z = [] {
      Stress z;
      for (unsigned int e = 0; e < Stress::n_independent_components; ++e)
        z.access_raw_entry(e) = 0.5 - 0.3 * e;
      return z;
    }();
    return z;
  }



  /// Mark some cells for refinement and all families elsewhere for coarsening,
  /// change the mesh and carry the state over.
  template <int dim>
  typename StateTransfer<dim>::Result
  adapt(Body<dim>               &body,
        const State<dim>        &state,
        const double             refined_up_to_x,
        const DistributedVector *density = nullptr)
  {
    for (const auto &cell : body.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          if (cell->center()[0] < refined_up_to_x)
            cell->set_refine_flag();
          else if (cell->level() > 0)
            cell->set_coarsen_flag();
        }
    body.triangulation.prepare_coarsening_and_refinement();
    StateTransfer<dim> transfer(body.triangulation,
                                *body.stress_space,
                                state,
                                density);
    body.triangulation.execute_coarsening_and_refinement();
    body.set_up();
    return transfer.unpack(*body.stress_space);
  }



  struct Dim2
  {
    static constexpr int value = 2;
  };
  struct Dim3
  {
    static constexpr int value = 3;
  };

  template <typename Dimension>
  class Adaptation : public testing::Test
  {};
  using Dimensions = testing::Types<Dim2, Dim3>;
  TYPED_TEST_SUITE(Adaptation, Dimensions, );



  TYPED_TEST(Adaptation, TransferConservesStressOnDistortedCells)
  {
    constexpr int dim = TypeParam::value;
    for (const bool at_quadrature_points : {false, true})
      {
        Body<dim> body(box_with<dim>("set Role = clamped\n"),
                       at_quadrature_points);
        body.distort();
        body.refine_where([](const Point<dim> &x) { return x[0] > 0.7; });
        body.set_up();

        State<dim> state;
        state.n                 = 7;
        state.t                 = 0.25;
        state.u                 = body.interpolate(linear_displacement<dim>);
        state.velocity          = body.space->ghosted_vector();
        state.z                 = body.sample(wavy_stress<dim>);
        const Stress   integral = body.integral(state.z);
        const unsigned n_cells  = body.triangulation.n_global_active_cells();
        for (const double x : {1., 0., 0.6})
          {
            auto result = adapt(body, state, x);
            EXPECT_LT((body.integral(result.state.z) - integral).norm(),
                      1e-13 * integral.norm());
            state = std::move(result.state);
          }
        EXPECT_NE(body.triangulation.n_global_active_cells(), n_cells);
        EXPECT_EQ(state.n, 7u);
        EXPECT_EQ(state.t, 0.25);
      }
  }



  TYPED_TEST(Adaptation, TransferConservesStressOnCurvedCells)
  {
    constexpr int dim = TypeParam::value;
    for (const bool at_quadrature_points : {false, true})
      {
        Body<dim> body(geometry("hyper_ball",
                                dim == 2 ? "0, 0 : 1 : false" :
                                           "0, 0, 0 : 1 : false") +
                         boundary(0, "set Role = clamped\n"),
                       at_quadrature_points);
        body.refine_where([](const Point<dim> &x) { return x[0] > 0.1; });
        body.set_up();
        State<dim> state;
        state.u               = body.space->ghosted_vector();
        state.velocity        = body.space->ghosted_vector();
        state.z               = body.sample(wavy_stress<dim>);
        const Stress integral = body.integral(state.z);
        for (const double x : {-0.1, -2., 0.})
          {
            state = adapt(body, state, x).state;
            EXPECT_LT((body.integral(state.z) - integral).norm(),
                      1e-13 * integral.norm());
          }
      }
  }



  TYPED_TEST(Adaptation, TransferReproducesPolynomials)
  {
    constexpr int dim = TypeParam::value;
    for (const bool distorted : {false, true})
      for (const bool at_quadrature_points : {false, true})
        {
          Body<dim> body(box_with<dim>("set Role = clamped\n"),
                         at_quadrature_points);
          if (distorted)
            body.distort();
          body.refine_where([](const Point<dim> &x) { return x[0] > 0.7; });
          body.set_up();
          // What quadrature points carry exactly, also on coarsening, is
          // linear on parallelograms; otherwise constants.
          const bool linear = at_quadrature_points && !distorted;
          const std::function<Stress(const Point<dim> &)> field =
            [linear](const Point<dim> &x) {
              return linear ? linear_stress(x) : constant_stress();
            };
          State<dim> state;
          state.u        = body.interpolate(linear_displacement<dim>);
          state.velocity = state.u;
          state.z        = body.sample(field);
          DistributedVector density = state.u;
          for (const double x : {1., 0., 0.6})
            {
              const auto result = adapt(body, state, x, &density);
              state             = result.state;
              density           = result.multiplier_density;
              const DistributedVector exact =
                body.interpolate(linear_displacement<dim>);
              for (const DistributedVector &vector :
                   {state.u, state.velocity, density})
                {
                  for (const auto i : body.space->relevant)
                    EXPECT_NEAR(vector[i], exact[i], 1e-13);
                }
              EXPECT_EQ(state.initial_u.size(), 0u);
              EXPECT_LT(body.max_difference(state.z, field), 1e-12);
            }
        }
  }



  TYPED_TEST(Adaptation, TransferLeavesOutWhatIsAbsent)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(box_with<dim>("set Role = clamped\n"));
    body.set_up();
    State<dim> state;
    state.u           = body.interpolate(linear_displacement<dim>);
    state.velocity    = body.space->ghosted_vector();
    const auto result = adapt(body, state, 1.);
    EXPECT_TRUE(result.state.z.empty());
    EXPECT_EQ(result.state.initial_u.size(), 0u);
    EXPECT_EQ(result.multiplier_density.size(), 0u);
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



  TYPED_TEST(Adaptation, EstimateVanishesForUniformStress)
  {
    constexpr int dim = TypeParam::value;
    for (const bool coulomb : {false, true})
      for (const bool at_quadrature_points : {false, true})
        for (const bool mean_dilatation : {false, true})
          {
            Body<dim> body(patch<dim>(coulomb, Tensor<1, dim>()),
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
            // Friction is seen.
            const DistributedVector none = body.space->ghosted_vector();
            EXPECT_GT(total_estimate(
                        residual_estimate(*body.stress_space, u, z, 0., &none),
                        body.triangulation),
                      1e-3);
          }
  }



  TYPED_TEST(Adaptation, EstimateSeesWrongTractionWhereItActs)
  {
    constexpr int  dim = TypeParam::value;
    Tensor<1, dim> error;
    error[0] = 0.3;
    error[1] = -0.4;
    Body<dim> body(patch<dim>(false, error));
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
              expected = cell->face(f)->diameter() * cell->face(f)->measure() *
                         0.25 / (2. * mu);
        EXPECT_NEAR(estimate[cell->active_cell_index()], expected, 1e-14);
      }
  }



  TYPED_TEST(Adaptation, EstimateSeesBodyForce)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(box_with<dim>("set Role = clamped\n") +
                   "subsection Loads\nset Body force = 0; 2*t" +
                   (dim == 3 ? "; 0" : "") + "\nend\n");
    body.set_up();
    const Vector<double> estimate = residual_estimate(
      *body.stress_space, body.space->ghosted_vector(), {}, 0.5, nullptr);
    for (const auto &cell : body.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          EXPECT_NEAR(estimate[cell->active_cell_index()],
                      Utilities::fixed_power<2>(cell->diameter()) *
                        cell->measure() / (2. * mu),
                      1e-14);
        }
  }



  TYPED_TEST(Adaptation, EstimateSeesStressJumpsOnHangingFaces)
  {
    // z jumps at x = 1, where cells of different size meet; their faces are
    // those of the finer ones, of length h.
    constexpr int dim = TypeParam::value;
    for (const bool left_is_finer : {false, true})
      {
        Body<dim> body(box_with<dim>("set Role = clamped\n"));
        body.refine_where([left_is_finer](const Point<dim> &x) {
          return (x[0] < 1.) == left_is_finer;
        });
        body.set_up();
        const auto   z      = body.sample([](const Point<dim> &x) {
          return (x[0] < 1. ? 1. : -1.) * constant_stress();
        });
        const double h      = 0.25 * std::sqrt(dim - 1.);
        double       square = 0.; // of the jump
        for (unsigned int d = 0; d < dim; ++d)
          square += Utilities::fixed_power<2>(2. * constant_stress()[0][d]);
        const Vector<double> estimate = residual_estimate(
          *body.stress_space, body.space->ghosted_vector(), z, 0., nullptr);
        // Half of it on either side of the interface, which has measure 1.
        double left = 0., right = 0.;
        for (const auto &cell : body.triangulation.active_cell_iterators())
          {
            const double value = estimate[cell->active_cell_index()];
            (cell->center()[0] < 1. ? left : right) += value;
            if (std::abs(cell->center()[0] - 1.) > 0.26)
              {
                // Squares of what rounding leaves of tractions of size 1.
                EXPECT_LE(value, 1e-30);
              }
          }
        const double expected = 0.5 * h * square / (2. * mu);
        EXPECT_NEAR(Utilities::MPI::sum(left, MPI_COMM_WORLD), expected, 1e-13);
        EXPECT_NEAR(Utilities::MPI::sum(right, MPI_COMM_WORLD),
                    expected,
                    1e-13);
      }
  }



  TYPED_TEST(Adaptation, EstimateSeesMaterialInterfacesAcrossRanks)
  {
    // One strain, two moduli: the traction jumps by eps_xx (lambda + 2 mu) and
    // each side is scaled by its own 1/(2 mu).
    constexpr int dim = TypeParam::value;
    Body<dim>     body(box_with<dim>("set Role = clamped\n") +
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
    const double h      = 0.5 * std::sqrt(dim - 1.);
    const double square = 0.5 * h * 4.; // E = lambda + 2 mu for nu = 0
    double       left = 0., right = 0.;
    for (const auto &cell : body.triangulation.active_cell_iterators())
      (cell->center()[0] < 1. ? left : right) +=
        estimate[cell->active_cell_index()];
    EXPECT_NEAR(Utilities::MPI::sum(left, MPI_COMM_WORLD), square, 1e-13);
    EXPECT_NEAR(Utilities::MPI::sum(right, MPI_COMM_WORLD), square / 3., 1e-13);
  }



  TYPED_TEST(Adaptation, EstimateUsesSecondDerivatives)
  {
    // u_x = x y on the one large cell (0,1)^dim without faces that count:
    // div E eps = (0, lambda + mu), (0, mu/3) under mean dilatation.
    constexpr int dim = TypeParam::value;
    for (const bool mean_dilatation : {false, true})
      {
        std::string text = geometry("hyper_cube", "0 : 1 : true");
        for (unsigned int id = 0; id < 2 * dim; ++id)
          text += boundary(id, "set Role = clamped\n");
        Body<dim> body(text, false, mean_dilatation);
        body.set_up();
        const DistributedVector u = body.interpolate([](const Point<dim> &x) {
          Tensor<1, dim> u;
          u[0] = x[0] * x[1];
          return u;
        });
        const double            lambda = 0.3 / (1.3 * 0.4);
        const double            force = mean_dilatation ? mu / 3. : lambda + mu;
        EXPECT_NEAR(total_estimate(
                      residual_estimate(*body.stress_space, u, {}, 0., nullptr),
                      body.triangulation),
                    std::sqrt(dim * force * force / (2. * mu)),
                    1e-13);
      }
  }



  TYPED_TEST(Adaptation, MarkingRespectsLevels)
  {
    constexpr int        dim = TypeParam::value;
    Body<dim>            body(box_with<dim>("set Role = clamped\n"));
    RefinementParameters parameters;
    parameters.refinement_fraction = 0.8;
    parameters.coarsening_fraction = 0.1;
    parameters.minimal_level       = 1;
    parameters.maximal_level       = 2;
    body.triangulation.refine_global(1);
    // A peak that moves from left to right.
    for (const double peak : {0., 0., 2., 2.})
      {
        Vector<double> estimate(body.triangulation.n_active_cells());
        for (const auto &cell : body.triangulation.active_cell_iterators())
          estimate[cell->active_cell_index()] =
            std::exp(-10. * std::abs(cell->center()[0] - peak));
        mark_cells(body.triangulation, estimate, parameters);
        body.triangulation.execute_coarsening_and_refinement();
        int coarsest = 100, finest = 0;
        for (const auto &cell : body.triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            {
              coarsest = std::min(coarsest, cell->level());
              finest   = std::max(finest, cell->level());
            }
        EXPECT_EQ(Utilities::MPI::min(coarsest, MPI_COMM_WORLD), 1);
        EXPECT_EQ(Utilities::MPI::max(finest, MPI_COMM_WORLD), 2);
      }
    // Nothing left to do.
    parameters.coarsening_fraction = 0.;
    parameters.maximal_level       = 1;
    Vector<double> estimate(body.triangulation.n_active_cells());
    estimate = 1.;
    EXPECT_FALSE(mark_cells(body.triangulation, estimate, parameters));
    estimate                 = 0.;
    parameters.maximal_level = 6;
    EXPECT_FALSE(mark_cells(body.triangulation, estimate, parameters));
  }



  TYPED_TEST(Adaptation, MarkingThatChangesAlmostNothingKeepsTheMesh)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(box_with<dim>("set Role = clamped\n"));
    body.triangulation.refine_global(1);
    body.refine_where([](const Point<dim> &x) { return x[0] < 1.; });
    // The fine half cannot be refined further; the other one has a share of
    // the estimate.
    RefinementParameters parameters;
    parameters.refinement_fraction = 1.;
    parameters.coarsening_fraction = 0.;
    parameters.maximal_level       = 2;
    Vector<double> estimate(body.triangulation.n_active_cells());
    const auto     mark = [&](const double share) {
      for (const auto &cell : body.triangulation.active_cell_iterators())
        {
          const bool is_fine = cell->center()[0] < 1.;
          estimate[cell->active_cell_index()] =
            cell->measure() * (is_fine ? 1. - share : share);
        }
      return mark_cells(body.triangulation, estimate, parameters);
    };
    const auto any_flag = [&] {
      for (const auto &cell : body.triangulation.active_cell_iterators())
        if (cell->refine_flag_set() || cell->coarsen_flag_set())
          return true;
      return false;
    };
    parameters.smallest_share = 0.02;
    EXPECT_FALSE(mark(0.019));
    EXPECT_FALSE(any_flag());
    EXPECT_TRUE(mark(0.021));
    parameters.smallest_share = 0.;
    EXPECT_TRUE(mark(0.001));

    // Coarsening alone: of one family in vain, of all of them not.
    for (const auto &cell : body.triangulation.active_cell_iterators())
      cell->clear_refine_flag();
    parameters.smallest_share      = 0.02;
    parameters.refinement_fraction = 0.;
    parameters.coarsening_fraction = 0.001;
    for (const auto &cell : body.triangulation.active_cell_iterators())
      {
        const bool is_in_the_corner =
          cell->level() == 2 && cell->center().norm() < 0.25 * std::sqrt(dim);
        estimate[cell->active_cell_index()] = is_in_the_corner ? 1e-9 : 1.;
      }
    EXPECT_FALSE(mark_cells(body.triangulation, estimate, parameters));
    EXPECT_FALSE(any_flag());
    parameters.coarsening_fraction = 1.;
    EXPECT_TRUE(mark_cells(body.triangulation, estimate, parameters));
  }



  TYPED_TEST(Adaptation, MarkingRespectsTheBudget)
  {
    constexpr int        dim = TypeParam::value;
    Body<dim>            body(box_with<dim>("set Role = clamped\n"));
    RefinementParameters parameters;
    parameters.refinement_fraction = 0.9;
    parameters.coarsening_fraction = 0.02;
    parameters.cell_budget         = 300;
    std::vector<unsigned int> n_cells;
    for (unsigned int round = 0; round < 8; ++round)
      {
        // A corner singularity that no mesh resolves.
        Vector<double> estimate(body.triangulation.n_active_cells());
        for (const auto &cell : body.triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            {
              const Point<dim> x = cell->center();
              estimate[cell->active_cell_index()] =
                cell->measure() / (x[0] + 0.5 * x[1] + 0.2 * x[dim - 1]);
            }
        mark_cells(body.triangulation, estimate, parameters);
        body.triangulation.execute_coarsening_and_refinement();
        n_cells.push_back(body.triangulation.n_global_active_cells());
      }
    // Beyond the budget only by cells that grade the mesh.
    EXPECT_GT(n_cells.back(), 280u);
    for (const unsigned int n : n_cells)
      EXPECT_LT(n, 315u);
  }
} // namespace
