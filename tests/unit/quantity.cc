// SPDX-License-Identifier: LGPL-2.1-or-later

// Errors of quantities of interest: the dual problem gives the change by a
// residual, and the estimators' products of errors are those of known errors.
// Every test holds on any number of ranks.

#include <deal.II/grid/grid_tools.h>

#include "refusals.h"
#include "stepping_body.h"
#include <viscoplastic_contact/error/error_decay.h>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  template <typename Dimension>
  class Quantity : public testing::Test
  {};
  TYPED_TEST_SUITE(Quantity, Dimensions);



  std::string
  quantity(const std::string &column)
  {
    return subsection("Error control", "set Quantity = " + column);
  }



  template <int dim>
  std::string
  output_point()
  {
    return subsection("Output",
                      std::string("set Points = 0.3, 0.4") +
                        (dim == 3 ? ", 0.1" : ""));
  }



  /// Expect that the dual solution w gives the change of quantities by a change
  /// dz of z, which is the residual -(dz, eps(.)). The body is that of
  /// SteppingBody with other friction.
  template <int dim>
  void
  expect_dual_to_tell(const std::string              &friction,
                      const std::vector<std::string> &columns)
  {
    double frozen = 0.;
    for (const std::string &column : columns)
      for (const std::string linear_solver : {"direct", "multigrid"})
        {
          if (linear_solver == "direct" &&
              Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
            continue;
          SCOPED_TRACE(column + ", " + linear_solver);
          std::string text = SteppingBody<dim>::scene_text(
            maxwell + time("forward Euler", "1: 8") + solver(linear_solver) +
              quantity(column) + output_point<dim>(),
            "0.03");
          const std::string given =
            "set Friction law = tresca\nset Friction bound = 0.03";
          text.replace(text.find(given), given.size(), friction);
          SteppingBody<dim> body(
            typename SteppingBody<dim>::WholeScene{std::move(text)});
          // Some points stick, others slip.
          const unsigned int n = dim == 2 ? 2 : 5;
          body.advance(n);
          const Discretization<dim> &d    = *body.discretization;
          const double               t    = body.accepted.state.t;
          const TimeStep             step = {n + 1, t, t + 0.125, 0.125};
          FlowRate                   rate = body.rate();
          const auto end = body.stepper->try_step(body.accepted, &rate, step);
          const State<dim> &state    = end.end.state;
          const auto        slipping = std::count(state.contact.sticks.begin(),
                                           state.contact.sticks.end(),
                                           false);
          EXPECT_GT(Utilities::MPI::sum<unsigned int>(slipping, MPI_COMM_WORLD),
                    0u);

          const DualProblem<dim> dual(d, *body.scene.quantity);
          BulkSolver &bulk = body.stepper->method().elastic_solver()->bulk();
          CoulombLaw  law;
          law.of_pressure   = d.face->bounds_of_pressure(state.t);
          const bool follow = d.face->has_computed_pressure();
          const auto w =
            dual.solve(bulk, state.contact, follow ? &law : nullptr);
          // dz varies in space; a constant one would move nothing.
          IrreversibleStress dz(state.z.size());
          std::size_t        i = 0;
          for (const auto &cell : d.space.cells)
            for (unsigned int s = 0; s < d.stress_space.n_samples; ++s, ++i)
              for (unsigned int e = 0; e < 6; ++e)
                dz[i].access_raw_entry(e) =
                  1e-6 * std::sin(1. + e + 3. * cell->center()[0] +
                                  5. * cell->center()[dim - 1]);
          for (i = 0; i < dz.size(); ++i)
            rate.rate[i] += dz[i] / step.k;
          const auto changed =
            body.stepper->try_step(body.accepted, &rate, step);
          EXPECT_EQ(changed.end.state.contact.sticks, state.contact.sticks);
          DistributedVector residual = d.space.owned_vector();
          add_irreversible_load(d.stress_space, dz, residual);
          const double told = dual.sign() * (residual * w.w),
                       seen =
                         dual.value(changed.end.state, changed.end.forces) -
                         dual.value(state, end.end.forces);
          EXPECT_GT(std::abs(seen), 1e-9);
          EXPECT_NEAR(told,
                      seen,
                      (linear_solver == "direct" ? 1e-3 : 3e-3) *
                        (std::abs(seen) + 1e-7));
          if (follow)
            frozen = std::max(frozen,
                              std::abs(dual.sign() *
                                         (residual *
                                          dual.solve(bulk, state.contact).w) -
                                       seen) /
                                std::abs(seen));
        }
    // A dual problem with frozen bounds would be wrong.
    if (frozen > 0.)
      {
        EXPECT_GT(frozen, 0.05);
      }
  }



  TYPED_TEST(Quantity, DualTellsWhatAResidualDoes)
  {
    constexpr int dim = TypeParam::value;
    expect_dual_to_tell<dim>(
      "set Friction law = tresca\nset Friction bound = 0.03",
      {"friction_force_x",
       "friction_dissipation",
       "reaction_" + std::to_string(2 * dim - 1) + "_x",
       "reaction_" + std::to_string(2 * dim - 2) + "_" + "xyz"[dim - 1],
       "point0_x",
       "point0_y"});
  }



  /// Where friction follows the pressure of the step itself, a residual changes
  /// the bounds of slipping points.
  TYPED_TEST(Quantity, DualKnowsThatBoundsFollowThePressure)
  {
    constexpr int dim = TypeParam::value;
    expect_dual_to_tell<dim>(
      "set Friction law = coulomb\nset Friction coefficient = 0.6\n"
      "set Contact law = unilateral\nset Foundation displacement = -0.1*t",
      {"friction_force_x",
       std::string("contact_force_") + "xyz"[dim - 1],
       "reaction_" + std::to_string(2 * dim - 1) + "_x",
       "point0_x",
       "point0_y"});
  }



  /// Products of the errors of interpolants of quadratic fields are exact.
  TYPED_TEST(Quantity, ProductsOfErrorsAreThoseOfSmoothFields)
  {
    constexpr int dim = TypeParam::value;
    // The body is clamped all around, so that only interior faces count.
    std::string text =
      box<dim>(1) + subsection("Material", "set Law = elastic");
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id, "set Role = clamped");
    for (const bool stretched : {false, true})
      {
        SCOPED_TRACE(stretched);
        Body<dim> body(text);
        body.triangulation.refine_global(dim == 2 ? 5 : 3);
        if (stretched)
          GridTools::transform(
            [](Point<dim> x) {
              x[1] *= 3.;
              return x;
            },
            body.triangulation);
        body.set_up();
        // xx x^2 + yy y^2 for both fields
        const auto field = [](const Tensor<1, 2> &xx, const Tensor<1, 2> &yy) {
          return [xx, yy](const Point<dim> &x) {
            Tensor<1, dim> u;
            for (unsigned int i = 0; i < 2; ++i)
              u[i] = xx[i] * x[0] * x[0] + yy[i] * x[1] * x[1];
            return u;
          };
        };
        const auto pair = [](const double a, const double b) {
          return Tensor<1, 2>({a, b});
        };
        const DistributedVector u = body.interpolate(
                                  field(pair(1., 1.), pair(1., -2.))),
                                w = body.interpolate(
                                  field(pair(2., -1.), pair(1., 0.5)));
        const LocalCells<dim>        cells(*body.stress_space);
        const ResidualEstimator<dim> estimator(cells);
        const auto           dual = estimator.of_dual({w, {}, {}, nullptr});
        const Vector<double> products =
          estimator.multiply({u, {}, {}, nullptr}, dual);
        // Nine tenths of the strain have relaxed.
        IrreversibleStress                 z;
        std::vector<SymmetricTensor<2, 3>> strains(
          body.stress_space->n_samples);
        for (unsigned int c = 0; c < body.stress_space->n_cells(); ++c)
          {
            body.stress_space->strains(c, u.begin(), strains.data());
            for (const SymmetricTensor<2, 3> &strain : strains)
              z.push_back(-0.9 * body.stress_space->moduli(c).stress(strain));
          }
        const Vector<double> of_a_force =
          estimator.multiply({u, z, {}, nullptr, /* memory = */ 1.}, dual);
        // a(e_u, e_w) in a cell with errors such as -x (h - x)/2 u_xx.
        const double mu = 1. / 2.6, lambda = 0.3 / (1.3 * 0.4);
        for (const auto &cell : body.space->cells)
          if (!cell->at_boundary())
            {
              const double hx = cell->extent_in_direction(0),
                           hy = cell->extent_in_direction(1);
              const double xx = hx * hx / 12. * 4., yy = hy * hy / 12. * 4.;
              const double both = ((lambda + 2. * mu) * 2. + mu * -1.) * xx +
                                  (mu * 1. + (lambda + 2. * mu) * -1.) * yy;
              const double of_dual = ((lambda + 2. * mu) * 4. + mu * 1.) * xx +
                                     (mu * 1. + (lambda + 2. * mu) * 0.25) * yy;
              const unsigned int c = cell->active_cell_index();
              EXPECT_NEAR(products[c],
                          both * cell->measure(),
                          1e-9 * of_dual * cell->measure());
              EXPECT_NEAR(of_a_force[c],
                          0.1 * both * cell->measure(),
                          1e-9 * of_dual * cell->measure());
              EXPECT_NEAR(dual.squares[c],
                          of_dual * cell->measure(),
                          1e-9 * of_dual * cell->measure());
            }
      }
  }



  /// Recovered strains of quadratic fields on boxes are exact, also at the
  /// boundary, and so are products of their errors.
  TYPED_TEST(Quantity, ProductsOfRecoveredErrorsAreThoseOfSmoothFields)
  {
    constexpr int dim = TypeParam::value;
    std::string   text =
      box<dim>(dim == 2 ? 8 : 4) +
      subsection("Material", "set Law = elastic\nset Poisson's ratio = 0.4");
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id, id == 0 ? "set Role = clamped" : "set Role = free");
    Body<dim> body(text, true, /* mean_dilatation = */ true);
    GridTools::transform(
      [](Point<dim> x) {
        x[1] *= 3.;
        return x;
      },
      body.triangulation);
    body.set_up();
    // xx x^2 + yy y^2 + xy x y
    using Pair       = std::array<double, 2>;
    const auto field = [](const Pair &xx, const Pair &yy, const Pair &xy) {
      return [=](const Point<dim> &x) {
        Tensor<1, dim> u;
        for (unsigned int i = 0; i < 2; ++i)
          u[i] =
            xx[i] * x[0] * x[0] + yy[i] * x[1] * x[1] + xy[i] * x[0] * x[1];
        return u;
      };
    };
    const DistributedVector u = body.interpolate(
                              field({{1., 1.}}, {{1., -2.}}, {{3., 1.}})),
                            w = body.interpolate(
                              field({{2., -1.}}, {{1., 0.5}}, {{1., -4.}}));
    const LocalCells<dim> cells(*body.stress_space);
    // z is a pressure that varies in cells.
    const StressSpace<dim> &samples = *body.stress_space;
    IrreversibleStress      z;
    for (unsigned int c = 0; c < samples.n_cells(); ++c)
      for (unsigned int s = 0; s < samples.n_samples; ++s)
        z.push_back(
          (2. * samples.position(c, s)[0] - samples.position(c, s)[1]) *
          unit_symmetric_tensor<3>());
    const RecoveryEstimator<dim> estimator(cells);
    double                       in_doubt = 0.;
    using Linearization = typename RecoveryEstimator<dim>::Linearization;
    const auto multiply = [&](const Linearization &law) {
      typename RecoveryEstimator<dim>::OfDual dual;
      const Vector<double>                    result =
        estimator.multiply(u, z, w, nullptr, law, dual);
      in_doubt = dual.in_doubt;
      return result;
    };
    const auto   products = multiply({1., {}});
    const double mu = 1. / 2.8, K = 1. / 0.6, lambda = K - 2. / 3. * mu;
    for (const auto &cell : body.space->cells)
      {
        const double hx = cell->extent_in_direction(0),
                     hy = cell->extent_in_direction(1);
        if (cell->center()[0] < 2. * hx) // where u = 0 is prescribed
          continue;
        // The divergence of the interpolants varies in a cell. Under mean
        // dilatation that does no work, an error of -K delta_u delta_w and,
        // with the pressure of z, of -z : I delta_w/3.
        const double expected =
          ((lambda + 2. * mu) * 2. + mu * -1.) * hx * hx / 3. +
          (mu * 1. + (lambda + 2. * mu) * -1.) * hy * hy / 3. -
          K * (1. * -4. * hx * hx + 3. * 1. * hy * hy) / 12. -
          (2. * -4. * hx * hx + -1. * 1. * hy * hy) / 12.;
        EXPECT_NEAR(products[cell->active_cell_index()],
                    expected * cell->measure(),
                    1e-9 * cell->measure());
      }

    // The remainder of the law does work on w, and a step that is half as long
    // has half of the deviatoric errors.
    SymmetricTensor<2, 3> strain;
    strain[0][0] = strain[0][1]        = 1.;
    const SymmetricTensor<2, 3> beyond = samples.moduli(0).stress(strain);
    std::vector<SymmetricTensor<2, 3>> errors, halves;
    const auto remainder = [&](auto &list, const bool is_in_doubt) {
      return [&, is_in_doubt](const std::size_t,
                              const unsigned int,
                              const auto &,
                              const auto &e) {
        list.push_back(e);
        return typename Linearization::Remainder{beyond, is_in_doubt};
      };
    };
    const auto more = multiply({1., remainder(errors, false)});
    EXPECT_EQ(in_doubt, 0.);
    const auto half      = multiply({0.5, {}}),
               half_more = multiply({0.5, remainder(halves, true)});
    EXPECT_NEAR(in_doubt,
                Utilities::MPI::sum(half_more.mean_value() * half_more.size() -
                                      half.mean_value() * half.size(),
                                    MPI_COMM_WORLD),
                1e-9);
    ASSERT_EQ(errors.size(), halves.size());
    for (std::size_t i = 0; i < errors.size(); ++i)
      EXPECT_NEAR((errors[i] - 0.5 * deviator(errors[i]) - halves[i]).norm(),
                  0.,
                  1e-12);
    for (const auto &cell : body.space->cells)
      if (cell->center()[0] > 2. * cell->extent_in_direction(0))
        {
          const Point<dim>   x = cell->center();
          const unsigned int i = cell->active_cell_index();
          // At the center the interpolant has the gradient of the field.
          const double xx = 4. * x[0] + x[1], yy = -4. * x[0] + x[1],
                       xy = 0.5 * (2. * x[1] + x[0] - 2. * x[0] - 4. * x[1]);
          const double expected =
            (lambda * (xx + yy) + 2. * mu * xx + 4. * mu * xy) *
            cell->measure();
          EXPECT_NEAR(products[i] - more[i], expected, 1e-9);
          EXPECT_NEAR(half[i] - half_more[i], 2. * expected, 1e-9);
        }
  }



  TYPED_TEST(Quantity, RelaxationOfErrorsAsksNoLawOfRadialFlow)
  {
    // Rates say what becomes of errors, and only where those are carried on.
    constexpr int     dim = TypeParam::value;
    const std::string norton =
      subsection("Material",
                 "set Law = norton\nset Stress history = quadrature points\n" +
                   subsection("norton",
                              "set Rate factor = 50\nset Stress cap = 9")) +
      time("forward Euler", "1: 8");
    SteppingBody<dim> plain(norton),
      body(norton + quantity("point0_x") + output_point<dim>());
    plain.advance(1);
    EXPECT_TRUE(plain.accepted.rate->relaxation.empty());
    body.advance(3);
    const EvaluatedState<dim> &end   = body.accepted;
    const StressSpace<dim>    &space = body.discretization->stress_space;
    ErrorDecay<dim>            decay(body.discretization->laws, end.state, end);
    std::vector<SymmetricTensor<2, 3>> strains(space.n_samples);
    SymmetricTensor<2, 3>              error;
    for (unsigned int e = 0; e < 6; ++e)
      error.access_raw_entry(e) = 1. + e * e;
    double smallest = 1.; // part that is left
    for (std::size_t c = 0; c < space.n_cells(); ++c)
      {
        decay.enter(c);
        EXPECT_FALSE(decay.asks_for_stress);
        space.strains(c, end.state.u.begin(), strains.data());
        for (unsigned int s = 0; s < space.n_samples; ++s)
          {
            const std::size_t           i         = c * space.n_samples + s;
            const Stiffness            &stiffness = space.moduli(c);
            const SymmetricTensor<2, 3> stress =
              stiffness.stress(strains[s]) + end.state.z[i];
            const SymmetricTensor<2, 3> left =
                                          decay.relaxation_at(i, {}, {}, {}) *
                                          error,
                                        of_law =
                                          error_relaxation(*decay.law,
                                                           stress,
                                                           strains[s],
                                                           decay.k,
                                                           stiffness,
                                                           decay.now.point(c,
                                                                           s)) *
                                          error;
            EXPECT_LT((left - of_law).norm(), 1e-13 * error.norm());
            smallest = std::min(smallest, left.norm() / error.norm());
          }
      }
    EXPECT_LT(Utilities::MPI::min(smallest, MPI_COMM_WORLD), 0.97);
  }



  TEST(Quantities, ThatDoNotExistAreRefused)
  {
    const std::string known =
      "'Error control/Quantity': 'friction_force_z' is none of the quantities "
      "of this scene whose error can be estimated: friction_force_x, "
      "friction_force_y, friction_dissipation, reaction_2_x, reaction_2_y, reaction_3_x, "
      "reaction_3_y.";
    expect_refusal([] { SteppingBody<2> body(quantity("friction_force_z")); },
                   known);
    expect_refusal(
      [] {
        SteppingBody<2> body(
          subsection("Error control",
                     "set Quantity = reaction_2_x\nset Error bar = false"));
      },
      "'Error control/Quantity' needs the estimate of the error");
  }
} // namespace
