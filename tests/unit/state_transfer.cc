// SPDX-License-Identifier: LGPL-2.1-or-later

// The transfer of a state to a new mesh, on any number of ranks.

#include "sampled_body.h"
#include <viscoplastic_contact/error/history_reconstruction.h>
#include <viscoplastic_contact/error/memory_loss.h>
#include <viscoplastic_contact/error/state_transfer.h>

#include <cmath>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class Transfer : public testing::Test
  {};
  TYPED_TEST_SUITE(Transfer, Dimensions, );



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



  /// Mark some cells for refinement and all families elsewhere for coarsening,
  /// change the mesh and carry the state over.
  template <int dim>
  typename StateTransfer<dim>::Result
  adapt(SampledBody<dim>        &body,
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



  TYPED_TEST(Transfer, ConservesStressOnDistortedCells)
  {
    constexpr int dim = TypeParam::value;
    for (const bool at_quadrature_points : {false, true})
      {
        SampledBody<dim> body(box_with<dim>("set Role = clamped\n"),
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



  TYPED_TEST(Transfer, ConservesStressOnCurvedCells)
  {
    constexpr int dim = TypeParam::value;
    for (const bool at_quadrature_points : {false, true})
      {
        SampledBody<dim> body(geometry("hyper_ball",
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



  /// The mismatch of stress with u and z on a new mesh is added to z in
  /// proportion to creep, and its deviator only.
  TYPED_TEST(Transfer, CreepTakesItsShareOfAMismatch)
  {
    constexpr int    dim = TypeParam::value;
    SampledBody<dim> body(box_with<dim>("set Role = clamped\n"), true);
    body.set_up();
    State<dim> state;
    state.u              = body.space->ghosted_vector();
    const Stress       s = deviator(constant_stress());
    IrreversibleStress stress =
      body.sample([&](const Point<dim> &) { return 0.76 * s; });
    state.z = body.sample([&](const Point<dim> &) { return 0.75 * s; });
    const auto share_beyond = [&](const double enough, const double error) {
      return share_mismatch(*body.stress_space, stress, enough, error, state);
    };
    const double share = 0.75 / (0.75 + 0.76), part = share * 0.01 / 0.76,
                 infinite            = std::numeric_limits<double>::infinity();
    const IrreversibleStress carried = state.z;
    EXPECT_FALSE(share_beyond(1.0001 * part, infinite));
    EXPECT_EQ(state.z, carried);
    EXPECT_TRUE(share_beyond(0.9999 * part, infinite));
    state.z = carried;
    // Half of the energy norm of the stress.
    const StressSpace<dim> &space  = *body.stress_space;
    double                  square = 0.;
    for (std::size_t c = 0; c < space.n_cells(); ++c)
      for (unsigned int q = 0; q < space.n_samples; ++q)
        square +=
          space.weight(c, q) * space.moduli(c).complementary_square(0.76 * s);
    const double half =
      0.5 * std::sqrt(Utilities::MPI::sum(square, space.space.communicator));
    EXPECT_FALSE(share_beyond(2.0002 * part, half));
    EXPECT_TRUE(share_beyond(1.9998 * part, half));
    state.z = carried;
    EXPECT_TRUE(share_beyond(1.0001 * part, 0.));
    EXPECT_LT(body.max_difference(state.z,
                                  [&](const Point<dim> &) {
                                    return (0.75 + share * 0.01) * s;
                                  }),
              1e-14);

    // Mismatch of pressure does not change z, nor does any mismatch without z.
    const IrreversibleStress before = state.z;
    for (Stress &tensor : stress = state.z)
      tensor += 0.3 * unit_symmetric_tensor<3>();
    EXPECT_FALSE(share_beyond(0., infinite));
    EXPECT_EQ(state.z, before);
    state.z.assign(state.z.size(), Stress());
    EXPECT_FALSE(share_beyond(0., infinite));
    EXPECT_EQ(state.z, IrreversibleStress(state.z.size()));
  }



  /// Jumps between cells become slopes, also next to hanging nodes and at
  /// boundaries; the remaining jumps are the error.
  TYPED_TEST(Transfer, ChildrenTakeTheSlopesOfNeighbors)
  {
    constexpr int dim = TypeParam::value;
    for (const bool at_quadrature_points : {true, false})
      {
        SampledBody<dim> body(box_with<dim>("set Role = clamped\n"),
                              at_quadrature_points);
        body.triangulation.refine_global(1);
        body.refine_where([](const Point<dim> &x) { return x[0] > 0.7; });
        body.set_up();
        const StressSpace<dim> &space = *body.stress_space;
        // Samples with the cell means of a field, and the error of samples.
        const auto jumps_of = [&](const auto &field) {
          IrreversibleStress z;
          for (const auto &cell : space.space.cells)
            z.insert(z.end(), space.n_samples, field(cell->center()));
          return z;
        };
        const auto error = [&](const auto &field, const auto &z) {
          // Points are samples, or the centers of children.
          const Quadrature<dim> points =
            at_quadrature_points ?
              Quadrature<dim>(QGauss<dim>(2)) :
              Quadrature<dim>(QIterated<dim>(QMidpoint<1>(), 2));
          const unsigned int n = z.size() / space.n_cells();
          FEValues<dim>      values(space.space.dof_handler.get_fe(),
                               points,
                               update_quadrature_points | update_JxW_values);
          double             square = 0.;
          for (std::size_t c = 0; c < space.n_cells(); ++c)
            {
              values.reinit(space.space.cells[c]);
              for (const unsigned int q : values.quadrature_point_indices())
                square += values.JxW(q) * space.moduli(c).complementary_square(
                                            z[c * n + (n > 1 ? q : 0)] -
                                            field(values.quadrature_point(q)));
            }
          return std::sqrt(Utilities::MPI::sum(square, MPI_COMM_WORLD));
        };
        const auto estimate = [](const HistoryReconstruction &result) {
          return std::sqrt(Utilities::MPI::sum(result.squared_error.l1_norm(),
                                               MPI_COMM_WORLD));
        };
        const auto   linear = jumps_of(linear_stress<dim>);
        auto         result = reconstruct_history(space, linear, linear);
        const double lost   = error(linear_stress<dim>, linear);
        EXPECT_EQ(result.z, result.stress);
        EXPECT_LT(error(linear_stress<dim>, result.z), 0.01 * lost);
        EXPECT_LT(estimate(result), 0.01 * lost);

        const auto curved = [](const Point<dim> &x) {
          return x[0] * x[0] * linear_stress(x);
        };
        const auto jumps = jumps_of(curved);
        result           = reconstruct_history(space, jumps, jumps);
        EXPECT_LT(error(curved, result.z), 0.25 * error(curved, jumps));
        EXPECT_NEAR(estimate(result) / error(curved, result.z), 1., 0.5);
      }
  }



  TYPED_TEST(Transfer, LosesWhatWasForetold)
  {
    constexpr int dim = TypeParam::value;
    for (const bool at_quadrature_points : {false, true})
      {
        SampledBody<dim> body(box_with<dim>("set Role = clamped\n"),
                              at_quadrature_points);
        body.refine_where([](const Point<dim> &x) { return x[0] < 1.5; });
        body.set_up();
        State<dim> state;
        state.u         = body.space->ghosted_vector();
        state.velocity  = state.u;
        state.z         = body.sample(wavy_stress<dim>);
        const auto mark = [&] {
          for (const auto &cell : body.triangulation.active_cell_iterators())
            if (cell->is_locally_owned() && cell->level() > 0)
              cell->set_coarsen_flag();
          body.triangulation.prepare_coarsening_and_refinement();
        };
        const auto loss = [&](const IrreversibleStress &z) {
          return memory_loss(body.triangulation, *body.stress_space, z);
        };
        EXPECT_EQ(loss(state.z), 0.); // nothing is marked
        mark();
        const double foretold = loss(state.z);
        EXPECT_EQ(loss(IrreversibleStress()), 0.);
        EXPECT_LT(loss(body.sample(
                    [](const Point<dim> &) { return constant_stress(); })),
                  1e-14);

        // Less is lost if fewer families are coarsened.
        const double allowed = 0.9 * foretold;
        limit_memory_loss(body.triangulation,
                          *body.stress_space,
                          state.z,
                          allowed);
        EXPECT_LE(loss(state.z), allowed);
        EXPECT_GT(loss(state.z), 0.);
        mark();
        limit_memory_loss(body.triangulation,
                          *body.stress_space,
                          state.z,
                          2. * foretold);
        EXPECT_EQ(loss(state.z), foretold);

        // Coarsen and refine again: the change of z is the loss.
        const auto n_cells = body.triangulation.n_global_active_cells();
        state              = adapt(body, state, -1.).state;
        EXPECT_EQ(body.triangulation.n_global_levels(), 1u);
        state = adapt(body, state, 1.5).state;
        EXPECT_EQ(body.triangulation.n_global_active_cells(), n_cells);
        const IrreversibleStress before = body.sample(wavy_stress<dim>);
        ASSERT_EQ(state.z.size(), before.size());
        double square = 0.;
        for (std::size_t c = 0, i = 0; c < body.stress_space->n_cells(); ++c)
          for (unsigned int s = 0; s < body.stress_space->n_samples; ++s, ++i)
            {
              const Stress lost = state.z[i] - before[i];
              square += body.stress_space->weight(c, s) *
                        (body.stress_space->moduli(c).strain(lost) * lost);
            }
        EXPECT_NEAR(std::sqrt(Utilities::MPI::sum(square, MPI_COMM_WORLD)),
                    foretold,
                    1e-12 * foretold);
      }
  }



  TYPED_TEST(Transfer, ReproducesPolynomials)
  {
    constexpr int dim = TypeParam::value;
    for (const bool distorted : {false, true})
      for (const bool at_quadrature_points : {false, true})
        {
          SampledBody<dim> body(box_with<dim>("set Role = clamped\n"),
                                at_quadrature_points);
          if (distorted)
            body.distort();
          body.refine_where([](const Point<dim> &x) { return x[0] > 0.7; });
          body.set_up();
          // Quadrature points carry linear fields exactly on parallelograms,
          // also in coarsening, otherwise constants.
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



  TYPED_TEST(Transfer, LeavesOutWhatIsAbsent)
  {
    constexpr int    dim = TypeParam::value;
    SampledBody<dim> body(box_with<dim>("set Role = clamped\n"));
    body.set_up();
    State<dim> state;
    state.u           = body.interpolate(linear_displacement<dim>);
    state.velocity    = body.space->ghosted_vector();
    const auto result = adapt(body, state, 1.);
    EXPECT_TRUE(result.state.z.empty());
    EXPECT_EQ(result.state.initial_u.size(), 0u);
    EXPECT_EQ(result.multiplier_density.size(), 0u);
  }
} // namespace
