// SPDX-License-Identifier: LGPL-2.1-or-later

// Projections of the initial data and the check of compatibility (2.12).

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include "body.h"
#include "refusals.h"
#include <viscoplastic_contact/discretization/compatibility.h>
#include <viscoplastic_contact/discretization/initial_state.h>

#include <cmath>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  using Stress = SymmetricTensor<2, 3>;

  template <typename Dimension>
  class InitialState : public testing::Test
  {};
  TYPED_TEST_SUITE(InitialState, Dimensions, );



  /// The box, clamped at y = 0 and free elsewhere, with initial data.
  template <int dim>
  std::string
  scene(const std::string &initial_data, const unsigned int n = 2)
  {
    std::string text = box<dim>(n) + subsection("Initial state", initial_data);
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id, id == 2 ? "set Role = clamped" : "set Role = free");
    return text;
  }



  TYPED_TEST(InitialState, ProjectionReproducesWhatTheSpaceContains)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(scene<dim>(dim == 2 ?
                                    "set Displacement = 0.1*y + 0.2*x*y; -0.3*y" :
                                    "set Displacement = 0.1*y + 0.2*x*y; -0.3*y; "
                                    "0.4*y*z"));
    body.refine_where([](const Point<dim> &x) { return x[0] < 1.; });
    body.set_up();
    const State<dim> state = make_initial_state(*body.stress_space, false);
    const auto       exact = body.interpolate([](const Point<dim> &x) {
      Tensor<1, dim> u;
      u[0] = 0.1 * x[1] + 0.2 * x[0] * x[1];
      u[1] = -0.3 * x[1];
      if (dim == 3)
        u[2] = 0.4 * x[1] * x[2];
      return u;
    });
    for (const auto i : body.space->relevant)
      EXPECT_NEAR(state.u(i), exact(i), 1e-8);
    EXPECT_EQ(state.t, 0.);
    EXPECT_EQ(state.velocity.linfty_norm(), 0.);
    EXPECT_GT(state.initial_u.size(), 0u);
  }



  TYPED_TEST(InitialState, ProjectionIsOrthogonalInTheStrainProduct)
  {
    // (eps(u0h - u0), eps(v)) = 0 for all v, by a separate quadrature.
    constexpr int dim = TypeParam::value;
    Body<dim>     body(scene<dim>(dim == 2 ?
                                    "set Displacement = x*y^2; y*(x^2 - y)" :
                                    "set Displacement = x*y^2; y*(x^2 - y); "
                                    "x*y*z"));
    body.refine_where([](const Point<dim> &x) { return x[0] > 1.; });
    body.set_up();
    const State<dim> state = make_initial_state(*body.stress_space, false);

    FEValues<dim>       values(body.fe,
                         QGauss<dim>(3),
                         update_gradients | update_JxW_values |
                           update_quadrature_points);
    std::vector<double> work(body.space->relevant.n_elements());
    for (const auto &cell : body.dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          values.reinit(cell);
          for (const unsigned int q : values.quadrature_point_indices())
            {
              const Point<dim> x = values.quadrature_point(q);
              Tensor<2, dim>   gradient; // of u0h - u0
              for (const unsigned int v : cell->vertex_indices())
                for (unsigned int i = 0; i < dim; ++i)
                  gradient[i] += state.u(cell->vertex_dof_index(v, i)) *
                                 values.shape_grad(v * dim, q);
              gradient[0][0] -= x[1] * x[1];
              gradient[0][1] -= 2. * x[0] * x[1];
              gradient[1][0] -= 2. * x[0] * x[1];
              gradient[1][1] -= x[0] * x[0] - 2. * x[1];
              if (dim == 3)
                {
                  gradient[dim - 1][0] -= x[1] * x[dim - 1];
                  gradient[dim - 1][1] -= x[0] * x[dim - 1];
                  gradient[dim - 1][dim - 1] -= x[0] * x[1];
                }
              const SymmetricTensor<2, dim> strain = symmetrize(gradient);
              for (const unsigned int v : cell->vertex_indices())
                {
                  const Tensor<1, dim> f =
                    strain * values.shape_grad(v * dim, q) * values.JxW(q);
                  for (unsigned int i = 0; i < dim; ++i)
                    work[body.space->relevant.index_within_set(
                      cell->vertex_dof_index(v, i))] += f[i];
                }
            }
        }
    DistributedVector residual = body.space->owned_vector();
    body.space->add_cartesian_load(work, residual);
    body.set_excluded_to_zero(residual);
    EXPECT_LT(residual.linfty_norm(), 1e-8);
  }



  TYPED_TEST(InitialState, IrreversibleStressIsWhatElasticityDoesNotExplain)
  {
    // z_0 = P0 sigma0 - P0 E eps(u0h), for linear sigma0 its value at centers.
    constexpr int     dim          = TypeParam::value;
    const std::string displacement = dim == 2 ?
                                       "set Displacement = 0.1*y; -0.3*y\n" :
                                       "set Displacement = 0.1*y; -0.3*y; 0\n";
    const std::string stress =
      dim == 2 ? "set Stress = x; 2*y; 0.5 + x; x - y" :
                 "set Stress = x; 2*y; 0.5 + x; x - y; 3*z; x + z";
    for (const bool at_quadrature_points : {false, true})
      {
        Body<dim> body(scene<dim>(displacement + stress), at_quadrature_points);
        body.refine_where([](const Point<dim> &x) { return x[0] < 1.; });
        body.set_up();
        const State<dim> state = make_initial_state(*body.stress_space, false);
        Stress           strain;
        strain[0][1]         = 0.05;
        strain[1][1]         = -0.3;
        const Stress elastic = Stiffness::isotropic(1., 0.3).stress(strain);
        ASSERT_EQ(state.z.size(),
                  body.stress_space->n_cells() * body.stress_space->n_samples);
        for (std::size_t c = 0, i = 0; c < body.stress_space->n_cells(); ++c)
          for (unsigned int s = 0; s < body.stress_space->n_samples; ++s, ++i)
            {
              const Point<dim> x = body.stress_space->position(c, s);
              Stress           expected;
              expected[0][0] = x[0];
              expected[1][1] = 2. * x[1];
              expected[2][2] = 0.5 + x[0];
              expected[0][1] = x[0] - x[1];
              if (dim == 3)
                {
                  expected[0][2] = 3. * x[dim - 1];
                  expected[1][2] = x[0] + x[dim - 1];
                }
              EXPECT_LT((state.z[i] - (expected - elastic)).norm(), 1e-8);
            }
      }
  }



  TYPED_TEST(InitialState, AbsentDataStayAbsent)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(scene<dim>(""));
    body.set_up();
    const State<dim> state = make_initial_state(*body.stress_space, false);
    EXPECT_TRUE(state.z.empty());
    EXPECT_EQ(state.initial_u.size(), 0u);
    EXPECT_EQ(state.u.linfty_norm(), 0.);
  }



  TYPED_TEST(InitialState, ContradictionWithPrescribedDisplacements)
  {
    constexpr int     dim = TypeParam::value;
    const std::string data =
      dim == 2 ? "set Displacement = 0.25; y" : "set Displacement = 0.25; y; 0";
    Body<dim> body(scene<dim>(data));
    body.set_up();
    expect_refusal([&] { make_initial_state(*body.stress_space, false); },
                   "The initial displacement contradicts the displacements "
                   "prescribed at t = 0 by 0.25");
    // With equilibration the contradiction is no error.
    EXPECT_EQ(message_of([&] { make_initial_state(*body.stress_space, true); }),
              "");
  }



  // ---------------------------------------------------------- compatibility

  template <int dim>
  double
  violation(const Body<dim> &body, ContactState &contact)
  {
    return compatibility_violation(*body.space,
                                   body.loads->assemble(0.),
                                   body.face.get(),
                                   body.space->ghosted_vector(),
                                   contact)
      .relative;
  }



  /// A stress in equilibrium without body force, from Airy's function
  /// sin(x) exp(y): (sin x, -sin x, 0, -cos x) exp(y), with its tractions.
  template <int dim>
  std::string
  airy(const unsigned int n, const double traction_factor)
  {
    const std::string f    = std::to_string(traction_factor) + "*exp(y)*";
    const std::string rest = dim == 3 ? "; 0" : "";
    std::string       text =
      box<dim>(n) + subsection("Initial state",
                               "set Stress = sin(x)*exp(y); -sin(x)*exp(y); 0; "
                               "-cos(x)*exp(y)" +
                                 std::string(dim == 3 ? "; 0; 0" : ""));
    text += boundary(0,
                     "set Role = traction\nset Traction = -" + f + "sin(x); " +
                       f + "cos(x)" + rest);
    text += boundary(1,
                     "set Role = traction\nset Traction = " + f + "sin(x); -" +
                       f + "cos(x)" + rest);
    text += boundary(2, "set Role = clamped");
    text += boundary(3,
                     "set Role = traction\nset Traction = -" + f + "cos(x); -" +
                       f + "sin(x)" + rest);
    for (unsigned int id = 4; id < 2 * dim; ++id)
      text += boundary(id, "set Role = free");
    return text;
  }



  TYPED_TEST(InitialState, CompatibleDataPassAtQuadratureError)
  {
    constexpr int       dim = TypeParam::value;
    std::vector<double> found;
    for (const unsigned int n : {2, 4})
      {
        Body<dim> body(airy<dim>(n, 1.));
        body.refine_where([](const Point<dim> &x) { return x[0] > 1.; });
        body.set_up();
        ContactState contact;
        found.push_back(violation(body, contact));
      }
    // The projection P0 sigma0 would be wrong by O(h) = 10 %.
    EXPECT_LT(found[0], 2e-4);
    EXPECT_LT(found[1], found[0] / 8.);

    // A stress that is 3 % too large is found to the same accuracy.
    Body<dim> body(airy<dim>(4, 1.03));
    body.set_up();
    ContactState contact;
    EXPECT_NEAR(violation(body, contact), 0.03 / 1.03, 1e-3);
  }



  TYPED_TEST(InitialState, UnbalancedLoadsAreSeen)
  {
    // Without initial stress, any load at t = 0 is a violation of 1.
    constexpr int dim  = TypeParam::value;
    const auto    text = [](const std::string &force) {
      return scene<dim>("") + subsection("Loads",
                                         "set Body force = " + force + "; 0" +
                                           std::string(dim == 3 ? "; 0" : ""));
    };
    ContactState contact;
    Body<dim>    loaded(text("1 + t"));
    loaded.set_up();
    EXPECT_NEAR(violation(loaded, contact), 1., 1e-14);
    Body<dim> later(text("t"));
    later.set_up();
    EXPECT_EQ(violation(later, contact), 0.);
  }



  /// Homogeneous shear sigma_xy = tau over a Tresca or Coulomb face at y = 0.
  template <int dim>
  std::string
  shear(const double tau, const double bound, const bool coulomb)
  {
    const std::string t        = std::to_string(tau);
    const std::string rest     = dim == 3 ? "; 0" : "";
    const auto        traction = [&](const std::string &force) {
      return "set Role = traction\nset Traction = " + force + rest;
    };
    std::string text =
      box<dim>(2) +
      subsection("Initial state",
                 "set Stress = 0; " + std::string(coulomb ? "-1" : "0") +
                   "; 0; " + t + std::string(dim == 3 ? "; 0; 0" : "")) +
      boundary(0, traction("0; -(" + t + ")")) +
      boundary(1, traction("0; " + t)) +
      boundary(2,
               coulomb ? "set Role = contact\nset Friction law = coulomb\n"
                         "set Normal stress = -1\n"
                         "set Friction coefficient = " +
                           std::to_string(bound) :
                         "set Role = contact\nset Friction law = tresca\n"
                         "set Friction bound = " +
                           std::to_string(bound)) +
      boundary(3, "set Role = clamped");
    for (unsigned int id = 4; id < 2 * dim; ++id)
      text += boundary(id, "set Role = free");
    return text;
  }



  TYPED_TEST(InitialState, FrictionHoldsWhatIsInItsBall)
  {
    constexpr int dim = TypeParam::value;
    for (const bool coulomb : {false, true})
      for (const double tau : {0.25, -0.25})
        {
          std::vector<double> found;
          for (const double bound : {0.5, 0.25, 0.2, 0.1})
            {
              Body<dim> body(shear<dim>(tau, bound, coulomb));
              body.refine_where(
                [](const Point<dim> &x) { return x[0] < 1. && x[1] < 0.5; });
              body.set_up();
              ContactState contact;
              found.push_back(violation(body, contact));
              // The body is pulled to the left where sigma_xy > 0, since nu
              // points down: lambda points to the right.
              const Tensor<1, dim> sum = body.face->resultant(contact);
              const double         expected =
                std::copysign(std::min(std::abs(tau), bound) * 2., tau);
              EXPECT_NEAR(sum[0], expected, 1e-12);
              for (unsigned int d = 1; d < dim; ++d)
                EXPECT_NEAR(sum[d], 0., 1e-12);
            }
          EXPECT_LT(found[0], 1e-13);
          EXPECT_LT(found[1], 1e-13);
          // The last two exceed the friction ball by 0.05 and 0.15.
          EXPECT_GT(found[2], 1e-3);
          EXPECT_NEAR(found[3] / found[2], 3., 1e-10);
        }
  }



  TYPED_TEST(InitialState, SizeOfTheExcess)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(shear<dim>(0.25, 0.1, false));
    body.set_up();
    ContactState contact;
    const double found = violation(body, contact);
    // The excess at each point is 0.15 m_c. It is relative to (sigma0, eps(v)),
    // which consists of the loads and, on the face, 0.25 m_c.
    const Load<dim>   load     = body.loads->assemble(0.);
    DistributedVector internal = load.values;
    body.set_excluded_to_zero(internal);
    double      excess = 0., left = 0.;
    const auto  on_face = body.face->restriction().gather(internal);
    const auto &face    = body.face->layout();
    for (unsigned int p = 0; p < face.points.size(); ++p)
      {
        const double m = body.face->weights()[p];
        excess += 0.15 * m * 0.15 * m;
        for (unsigned int i = 0; i < face.n_node_dofs(p); ++i)
          left -=
            on_face[face.first_dof[p] + i] * on_face[face.first_dof[p] + i];
        left += 0.25 * m * 0.25 * m;
      }
    excess = Utilities::MPI::sum(excess, MPI_COMM_WORLD);
    left   = Utilities::MPI::sum(left, MPI_COMM_WORLD);
    const double size =
      std::sqrt(internal.l2_norm() * internal.l2_norm() + left);
    EXPECT_NEAR(found, std::sqrt(excess) / size, 1e-12);
  }
} // namespace
