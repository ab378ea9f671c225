// SPDX-License-Identifier: LGPL-2.1-or-later

// Time steps without a run: they change nothing but their result, and the
// schemes agree in the limit. Every test holds on any number of ranks.

#include "stepping_body.h"
#include <viscoplastic_contact/time_stepping/explicit_step.h>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  template <typename Dimension>
  class TimeStepping : public testing::Test
  {};
  TYPED_TEST_SUITE(TimeStepping, Dimensions);



  double
  difference(const DistributedVector &a, const DistributedVector &b)
  {
    // Ghosted vectors have no reliable norms across ranks.
    double largest = 0.;
    EXPECT_EQ(a.locally_owned_size(), b.locally_owned_size());
    for (std::size_t i = 0; i < a.locally_owned_size(); ++i)
      largest = std::max(largest, std::abs(a.begin()[i] - b.begin()[i]));
    return Utilities::MPI::max(largest, MPI_COMM_WORLD);
  }



  /// Expect that two states are equal bit for bit.
  template <int dim>
  void
  expect_same(const EvaluatedState<dim> &a, const EvaluatedState<dim> &b)
  {
    EXPECT_EQ(a.state.n, b.state.n);
    EXPECT_EQ(a.state.t, b.state.t);
    EXPECT_EQ(a.state.k, b.state.k);
    EXPECT_EQ(difference(a.state.u, b.state.u), 0.);
    EXPECT_EQ(difference(a.state.velocity, b.state.velocity), 0.);
    EXPECT_EQ(a.state.z, b.state.z);
    EXPECT_EQ(a.state.time_error, b.state.time_error);
    EXPECT_EQ(a.state.contact.slip, b.state.contact.slip);
    EXPECT_EQ(a.state.contact.multiplier, b.state.contact.multiplier);
    EXPECT_EQ(a.state.contact.sticks, b.state.contact.sticks);
    EXPECT_EQ(difference(a.forces.u, b.forces.u), 0.);
    EXPECT_EQ(a.forces.strain_energy, b.forces.strain_energy);
    EXPECT_EQ(a.errors.total(), b.errors.total());
    EXPECT_EQ(a.is_solution, b.is_solution);
  }



  TYPED_TEST(TimeStepping, TriedStepLeavesNothing)
  {
    constexpr int dim = TypeParam::value;
    for (const std::string scheme : {"forward Euler", "Heun", "backward Euler"})
      for (const std::string linear_solver : {"direct", "multigrid"})
        {
          if (linear_solver == "direct" &&
              Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
            continue;
          SCOPED_TRACE(scheme + ", " + linear_solver);
          SteppingBody<dim> body(maxwell + time(scheme, "1: 8") +
                                 solver(linear_solver));
          body.advance(3);
          const EvaluatedState<dim> before = body.accepted;
          const auto                preconditioner =
            body.stepper->method().preconditioner_state();
          const FlowRate rate = body.rate();
          const double   t    = before.state.t;
          const auto     once =
            body.stepper->try_step(before, &rate, {4, t, t + 0.125, 0.125});
          // Make another step in between, longer and with other slip.
          body.stepper->method().restore(before, preconditioner);
          const auto other =
            body.stepper->try_step(before, &rate, {4, t, t + 0.6, 0.6});
          EXPECT_GT(difference(other.end.state.u, once.end.state.u), 1e-3);
          expect_same(body.accepted, before);
          body.stepper->method().restore(before, preconditioner);
          const auto again =
            body.stepper->try_step(before, &rate, {4, t, t + 0.125, 0.125});
          expect_same(again.end, once.end);
          EXPECT_EQ(again.report.linear_iterations,
                    once.report.linear_iterations);
        }
  }



  TYPED_TEST(TimeStepping, RejectedStepsLeaveNothing)
  {
    // The next step is too long for the tolerance. The accepted step in its
    // place, and the state of the linear solver, are the same as without the
    // rejected step.
    constexpr int dim = TypeParam::value;
    for (const std::string scheme : {"Heun", "backward Euler"})
      {
        SCOPED_TRACE(scheme);
        const std::string text =
          maxwell + time(scheme, "8: 8") + solver("multigrid") +
          subsection("Solver", "set Contact tolerance = 1e-8");
        SteppingBody<dim> start(text);
        start.advance(3);
        const EvaluatedState<dim> &before = start.accepted;
        const auto                 preconditioner =
          start.stepper->method().preconditioner_state();
        const FlowRate rate = start.rate();

        SteppingBody<dim> rejects(
          text + subsection("Step control", "set Tolerance = 1e-4")),
          by_hand(text);
        for (auto *body : {&rejects, &by_hand})
          body->stepper->method().restore(before, preconditioner);
        const auto step = rejects.stepper->next(before);
        ASSERT_GT(step.n_rejections, 0u);
        const double t = before.state.t, k = step.end.state.k;
        const auto   once =
          by_hand.stepper->try_step(before, &rate, {4, t, t + k, k});
        EXPECT_EQ(difference(once.end.state.u, step.end.state.u), 0.);
        EXPECT_EQ(once.end.state.z, step.end.state.z);
        EXPECT_EQ(once.report.linear_iterations, step.report.linear_iterations);
        const auto learnt   = rejects.stepper->method().preconditioner_state(),
                   expected = by_hand.stepper->method().preconditioner_state();
        ASSERT_EQ(learnt.has_value(), expected.has_value());
        if (learnt)
          {
            EXPECT_EQ(learnt->lost_iterations, expected->lost_iterations);
            EXPECT_EQ(learnt->best_rate, expected->best_rate);
          }
      }
  }



  TYPED_TEST(TimeStepping, StepByHandIsThatOfARun)
  {
    constexpr int dim = TypeParam::value;
    for (const std::string scheme : {"forward Euler", "backward Euler"})
      {
        SCOPED_TRACE(scheme);
        // Steps by hand have no estimate to couple a tolerance to.
        const std::string text =
          maxwell + time(scheme, "1: 8") +
          subsection("Solver", "set Contact tolerance = 1e-10");
        const std::string bound = "0.03*(1 + t)";
        SteppingBody<dim> run(text, bound), by_hand(text, bound);
        run.advance(4);
        bool any_slips = false;
        for (unsigned int n = 1; n <= 4; ++n)
          {
            const FlowRate rate = by_hand.rate();
            const auto     step =
              by_hand.stepper->try_step(by_hand.accepted,
                                        &rate,
                                        by_hand.scene.schedule.step(n));
            EXPECT_EQ(step.end.state.contact.bound,
                      by_hand.discretization->face->bounds(step.end.state.t));
            by_hand.accepted = step.end;
            for (const bool sticks : step.end.state.contact.sticks)
              any_slips |= !sticks;
          }
        EXPECT_TRUE(by_hand.discretization->face->layout().any(any_slips));
        // Only runs estimate errors.
        by_hand.accepted.errors           = run.accepted.errors;
        by_hand.accepted.state.time_error = run.accepted.state.time_error;
        expect_same(by_hand.accepted, run.accepted);
      }
  }



  TYPED_TEST(TimeStepping, SchemesAgreeInTheLimit)
  {
    // One step of size k by both schemes differs by O(k^2).
    constexpr int       dim = TypeParam::value;
    std::vector<double> differences;
    for (const double k : {0.1, 0.05, 0.025})
      {
        std::vector<DistributedVector> u;
        for (const std::string scheme : {"forward Euler", "backward Euler"})
          {
            SteppingBody<dim> body(
              maxwell + time(scheme, "1: 8") +
              subsection("Solver", "set Contact tolerance = 1e-12"));
            // Both start from the same state, that of an elastic step.
            const FlowRate          at_rest = body.rate();
            ExplicitStep<dim>       first(*body.discretization, body.timer);
            const StepSolution<dim> start =
              first.advance({{1, 0., 0.5, 0.5},
                             body.discretization->loads.assemble(0.5),
                             body.discretization->face->bounds(0.5),
                             {},
                             1e-12,
                             body.parameters->solver,
                             body.accepted,
                             &at_rest});
            body.accepted.state = start.state;
            body.accepted.forces =
              evaluate_forces(body.discretization->stress_space,
                              body.discretization->matrix,
                              body.discretization->loads.assemble(0.5),
                              start.state);
            const FlowRate          rate = body.rate();
            const AcceptedStep<dim> step =
              body.stepper->try_step(body.accepted,
                                     &rate,
                                     {2, 0.5, 0.5 + k, k});
            u.push_back(step.end.state.u);
            // The forces of z are those of z at the end of the step.
            DistributedVector missing = step.end.forces.irreversible;
            missing -= irreversible_forces(body.discretization->stress_space,
                                           step.end.state.z);
            EXPECT_EQ(missing.linfty_norm(), 0.);
          }
        differences.push_back(difference(u[0], u[1]));
      }
    for (unsigned int i = 1; i < differences.size(); ++i)
      {
        EXPECT_GT(differences[i - 1] / differences[i], 3.);
        EXPECT_LT(differences[i - 1] / differences[i], 5.);
      }
  }
} // namespace
