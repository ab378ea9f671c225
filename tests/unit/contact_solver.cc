// SPDX-License-Identifier: LGPL-2.1-or-later

// The solver of frictional contact against projected gradients, a slow but
// reliable method, on the dual of small convex problems.

#include "dense_bulk.h"
#include "refusals.h"
#include <viscoplastic_contact/contact/contact_solver.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  /// Numbers of final states of points and of iterations, over all problems.
  struct Counts
  {
    unsigned int n_stick = 0, n_slip = 0, n_iterations = 0;
  };



  /// Both solvers of the bulk against the reference.
  void
  expect_solved(const Problem &problem, const std::string &what, Counts &counts)
  {
    constexpr double tolerance = 1e-9;
    const Solution   reference = reference_solution(problem);
    for (const bool condensed : {true, false})
      {
        SCOPED_TRACE(what + (condensed ? ", condensed" : ", frozen bulk"));
        const Result result = solve(problem, condensed, tolerance);
        expect_solution(problem, result, reference, tolerance);
        count_sets(result, counts.n_stick, counts.n_slip);
        counts.n_iterations += result.report.iterations;
      }
  }



  TEST(ContactSolver, RandomProblems)
  {
    for (const unsigned int n_tangents : {1, 2})
      {
        Counts counts;
        for (unsigned int seed = 0; seed < 40; ++seed)
          expect_solved(random_problem(seed, n_tangents),
                        "seed " + std::to_string(seed) + ", tangents " +
                          std::to_string(n_tangents),
                        counts);
        // Both kinds of points occur, and the iteration is a Newton method.
        EXPECT_GT(counts.n_stick, 50u);
        EXPECT_GT(counts.n_slip, 50u);
        EXPECT_LT(counts.n_iterations / 80., n_tangents == 1 ? 3. : 6.);
      }
  }



  TEST(ContactSolver, DualityGapIsWhatItSays)
  {
    for (const unsigned int n_tangents : {1, 2})
      for (unsigned int seed = 100; seed < 130; ++seed)
        for (const bool condensed : {true, false})
          for (const double tolerance : {1e-1, 1e-2, 1e-3})
            {
              const Problem problem = random_problem(seed, n_tangents);
              const Result  result  = solve(problem, condensed, tolerance);
              const double  gap     = duality_gap(problem, result);
              EXPECT_NEAR(result.report.duality_gap, gap, 1e-10 + 1e-8 * gap);
              EXPECT_NEAR(result.report.relative_error,
                          std::sqrt(2. * result.report.duality_gap) /
                            problem.energy_norm(result.u),
                          1e-10);
              expect_solution(problem,
                              result,
                              reference_solution(problem),
                              tolerance);
            }
  }



  TEST(ContactSolver, ZeroInfiniteAndWidelySpreadBounds)
  {
    constexpr double tolerance = 1e-9;
    for (const unsigned int n_tangents : {1, 2})
      for (unsigned int seed = 200; seed < 230; ++seed)
        for (const unsigned int kind : {0, 1, 2, 3})
          {
            Problem problem = random_problem(seed, n_tangents);
            Random  random(seed);
            for (double &bound : problem.bounds)
              {
                if (kind == 0)
                  bound = 0.;
                else if (kind == 1)
                  bound = infinity;
                else if (kind == 2)
                  bound = random.logarithmic(1e-5, 1e3);
                else
                  {
                    const unsigned int choice = random.integer(0, 3);
                    bound                     = choice == 0 ? 0. :
                                                choice == 1 ? infinity :
                                                choice == 2 ? 1e12 :
                                                              0.2;
                  }
              }
            const Solution reference = reference_solution(problem);
            for (const bool condensed : {true, false})
              {
                SCOPED_TRACE("seed " + std::to_string(seed) + ", kind " +
                             std::to_string(kind) +
                             (condensed ? ", condensed" : ", frozen bulk"));
                const Result result = solve(problem, condensed, tolerance);
                expect_solution(problem, result, reference, tolerance);
                if (kind == 0 && condensed)
                  {
                    // Without friction this is one linear solve.
                    EXPECT_LE(result.report.iterations, 1u);
                  }
                if (kind == 1)
                  {
                    for (const bool sticks : result.state.sticks)
                      EXPECT_TRUE(sticks);
                  }
              }
          }
  }



  /// A ring of equal nodes.
  Problem
  ring(const unsigned int n_nodes, const unsigned int n_tangents)
  {
    Problem problem;
    for (unsigned int n = 0; n < n_nodes; ++n)
      problem.add_node(n_tangents,
                       {n_tangents == 1 ?
                          std::vector<Tensor<1, 3>>{vector(1, 0)} :
                          std::vector<Tensor<1, 3>>{vector(1, 0),
                                                    vector(0, 1)}});
    const unsigned int n = problem.face.n_dofs();
    problem.A.reinit(n, n);
    for (unsigned int i = 0; i < n; ++i)
      {
        problem.A(i, i) += 2.1;
        problem.A(i, (i + n_tangents) % n) -= 1.;
        problem.A((i + n_tangents) % n, i) -= 1.;
      }
    problem.load.reinit(n);
    problem.u_prev.reinit(n);
    problem.bounds.assign(n_nodes, 0.3);
    return problem;
  }



  TEST(ContactSolver, TiesWhereAllNodesReachTheBoundAtOnce)
  {
    for (const unsigned int n_tangents : {1, 2})
      for (const double excess :
           {-1e-6, -1e-15, 0., 1e-16, 1e-15, 1e-12, 1e-8, 1e-3})
        for (const bool condensed : {true, false})
          {
            std::ostringstream trace;
            trace << "tangents " << n_tangents << ", excess " << excess
                  << (condensed ? ", condensed" : ", frozen bulk");
            SCOPED_TRACE(trace.str());
            Problem problem = ring(12, n_tangents);
            // The sticking force is the load with a perturbation by rounding.
            Random random(3);
            for (unsigned int i = 0; i < problem.size(); ++i)
              problem.load[i] = 0.3 * (1. + excess) *
                                (n_tangents == 1 ? 1. :
                                 i % 2 == 0      ? 0.6 :
                                                   0.8) *
                                (1. + 1e-16 * random.uniform());
            for (double &x : problem.u_prev)
              x = 1.;
            problem.A.vmult_add(problem.load, problem.u_prev);
            // Where slip is tiny, rounding of the displacement blurs its
            // direction in 3D, and with it the error bound.
            const double tolerance = n_tangents == 2 && excess >= 1e-12 ?
                                       std::max(1e-10, 1e-17 / excess) :
                                       1e-10;
            const Result result    = solve(problem, condensed, tolerance);
            expect_solution(problem,
                            result,
                            reference_solution(problem),
                            tolerance);
            EXPECT_LE(result.report.iterations, 5u);
            if (excess < -1e-7 || excess > 1e-9)
              {
                for (const bool sticks : result.state.sticks)
                  EXPECT_EQ(sticks, excess < 0.);
              }
          }
  }



  TEST(ContactSolver, ReversalFromTheOppositeSlip)
  {
    constexpr double tolerance = 1e-9;
    for (const unsigned int n_tangents : {1, 2})
      for (unsigned int seed = 300; seed < 330; ++seed)
        for (const bool condensed : {true, false})
          for (const double factor : {-1., -0.4, -3.})
            {
              SCOPED_TRACE("seed " + std::to_string(seed) + ", factor " +
                           std::to_string(factor));
              Problem problem = random_problem(seed, n_tangents);
              problem.load *= 3.;
              const Result first = solve(problem, condensed, tolerance);

              // The load reverses; the start extrapolates the old slip.
              Vector<double> start(first.u);
              start.sadd(2., -1., problem.u_prev);
              problem.u_prev = first.u;
              problem.load *= factor;
              const Result result =
                solve(problem, condensed, tolerance, first.state, start);
              expect_solution(problem,
                              result,
                              reference_solution(problem),
                              tolerance);
              EXPECT_LE(result.report.iterations, condensed ? 10u : 40u);
            }
  }



  TEST(ContactSolver, StartsFromTheSolutionAndIsDone)
  {
    for (const unsigned int n_tangents : {1, 2})
      for (unsigned int seed = 400; seed < 410; ++seed)
        {
          const Problem problem = random_problem(seed, n_tangents);
          const Result  first   = solve(problem, true, 1e-11);
          const Result again = solve(problem, true, 1e-9, first.state, first.u);
          EXPECT_EQ(again.report.iterations, 0u);
        }
  }



  // ------------------------------------------------ nodes where pieces meet

  /// Two planes, whose normals make an angle, at each of the first nodes;
  /// single ones elsewhere. @p dim components a node.
  Problem
  corner_problem(const unsigned int seed,
                 const unsigned int dim,
                 const double       degrees)
  {
    Random             random(seed);
    Problem            problem;
    const unsigned int n_corners = random.integer(1, 2);
    for (unsigned int n = 0; n < n_corners; ++n)
      problem.add_node(dim, planes_at_an_angle(dim, degrees));
    for (unsigned int n = 0; n < 3; ++n)
      problem.add_node(dim, {random_rows(random, dim - 1, dim)});
    fill_at_random(problem, random, 3, 0.05, 1.);
    return problem;
  }



  TEST(ContactSolver, TwoPlanesAtANode)
  {
    for (const unsigned int dim : {2, 3})
      {
        Counts counts;
        for (const double degrees : {90., 60., 30., 150., 120.})
          for (unsigned int seed = 500; seed < 512; ++seed)
            expect_solved(corner_problem(seed, dim, degrees),
                          "dim " + std::to_string(dim) + ", seed " +
                            std::to_string(seed) + ", degrees " +
                            std::to_string(degrees),
                          counts);
        EXPECT_GT(counts.n_stick, 50u);
        EXPECT_GT(counts.n_slip, 50u);
      }
  }



  TEST(ContactSolver, TwoPlanesWithBoundsBeyondTheLoads)
  {
    // Most bounds are larger than any force in the body, so that only points
    // with the other bounds may slip.
    constexpr double tolerance = 1e-10;
    for (const double degrees : {90., 60., 30., 150., 120.})
      for (unsigned int seed = 600; seed < 636; ++seed)
        {
          Problem problem = corner_problem(seed, 3, degrees);
          Random  random(seed);
          for (double &bound : problem.bounds)
            bound *= random.integer(0, 3) > 0 ? 1e3 : 1.;
          for (const bool condensed : {true, false})
            {
              SCOPED_TRACE("seed " + std::to_string(seed) + ", degrees " +
                           std::to_string(degrees));
              const Result result = solve(problem, condensed, tolerance);
              EXPECT_LE(result.report.relative_error, tolerance);
              EXPECT_NEAR(duality_gap(problem, result), 0., 1e-13);
            }
        }
  }



  TEST(ContactSolver, FoundationsThatMove)
  {
    // Each point slips over its own foundation, also if several share a node
    // or, at 0 degrees, all directions.
    for (const unsigned int dim : {2, 3})
      for (const double degrees : {0., 90., 30.})
        {
          Counts counts;
          for (unsigned int seed = 550; seed < 562; ++seed)
            {
              Problem problem = corner_problem(seed, dim, degrees);
              Random  random(seed);
              for (const auto &point : problem.face.points)
                {
                  Tensor<1, 2> step;
                  for (unsigned int i = 0; i < point.n_tangents; ++i)
                    step[i] = random.uniform(-0.3, 0.3);
                  problem.foundation_step.push_back(step);
                }
              expect_solved(problem,
                            "dim " + std::to_string(dim) + ", seed " +
                              std::to_string(seed) + ", degrees " +
                              std::to_string(degrees),
                            counts);
            }
          EXPECT_GT(counts.n_stick, 10u);
          EXPECT_GT(counts.n_slip, 50u);
        }
  }



  TEST(ContactSolver, SlipsThatAreAPartOfTheMotion)
  {
    // Rows that are neither orthogonal nor of unit length, as where another
    // condition holds the node in a direction oblique to the piece.
    for (const unsigned int n_tangents : {1, 2})
      {
        Counts counts;
        for (unsigned int seed = 900; seed < 930; ++seed)
          {
            Problem problem = random_problem(seed, n_tangents);
            Random  random(seed);
            for (auto &point : problem.face.points)
              {
                if (n_tangents == 2)
                  point.map[1] = 0.7 * point.map[1] +
                                 random.uniform(-0.5, 0.5) * point.map[0];
                point.map[0] *= random.uniform(0.1, 1.);
              }
            expect_solved(problem,
                          "seed " + std::to_string(seed) + ", tangents " +
                            std::to_string(n_tangents),
                          counts);
          }
        EXPECT_GT(counts.n_stick, 20u);
        EXPECT_GT(counts.n_slip, 50u);
      }
  }



  TEST(ContactSolver, GluedPlanesAtANode)
  {
    constexpr double tolerance = 1e-9;
    for (const unsigned int dim : {2, 3})
      for (const double degrees : {90., 30., 150., 10.})
        for (unsigned int seed = 600; seed < 606; ++seed)
          for (const bool condensed : {true, false})
            {
              SCOPED_TRACE("dim " + std::to_string(dim) + ", seed " +
                           std::to_string(seed) + ", degrees " +
                           std::to_string(degrees));
              Problem problem = corner_problem(seed, dim, degrees);
              problem.bounds.assign(problem.bounds.size(), infinity);
              const Result result = solve(problem, condensed, tolerance);
              // Two planes with infinite bounds hold all components of a node.
              const auto slips = problem.slips(result.u);
              for (unsigned int p = 0; p < slips.size(); ++p)
                {
                  EXPECT_TRUE(result.state.sticks[p]);
                  EXPECT_LT(slips[p].norm(), 1e-12);
                }
              // The forces are in equilibrium.
              Vector<double> unbalanced = problem.residual(result.u);
              unbalanced -= problem.force(result.state.multiplier);
              EXPECT_LT(unbalanced.l2_norm(), 1e-7);
            }
  }



  // ------------------------------------------------------ what must not pass

  TEST(ContactSolver, RefusesValuesThatAreNotFinite)
  {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const unsigned int n_tangents : {1, 2})
      for (const bool condensed : {true, false})
        {
          Problem load = random_problem(800, n_tangents);
          load.load[0] = nan;
          expect_refusal([&] { solve(load, condensed, 1e-8); }, "not finite");
          Problem at_face                  = random_problem(800, n_tangents);
          at_face.load[at_face.size() - 1] = infinity;
          expect_refusal([&] { solve(at_face, condensed, 1e-8); },
                         "not finite");
          Problem bound   = random_problem(800, n_tangents);
          bound.bounds[1] = nan;
          expect_refusal([&] { solve(bound, condensed, 1e-8); }, "not finite");
          Problem start = random_problem(800, n_tangents);
          expect_refusal(
            [&] {
              Vector<double> u(start.u_prev);
              u[u.size() - 1] = nan;
              solve(start, condensed, 1e-8, ContactState(start.bounds), u);
            },
            "not finite");
        }
  }



  TEST(ContactSolver, RefusesToReturnWhatDidNotConverge)
  {
    for (const unsigned int n_tangents : {1, 2})
      for (const unsigned int max_iterations : {0, 1})
        {
          // With inaccurate linear solves one correction does not suffice.
          const Problem problem = random_problem(810, n_tangents);
          expect_refusal(
            [&] {
              solve(problem,
                    false,
                    1e-12,
                    ContactState(problem.bounds),
                    problem.u_prev,
                    max_iterations);
            },
            "The active set iteration did not converge in " +
              std::to_string(max_iterations) + " iterations");
        }
  }



  TEST(ContactSolver, NothingToDo)
  {
    // No load, no motion: finite answers, no iterations.
    for (const unsigned int n_tangents : {1, 2})
      for (const double bound : {0., 1., infinity})
        {
          Problem problem = random_problem(820, n_tangents);
          problem.load    = 0.;
          problem.u_prev  = 0.;
          problem.bounds.assign(problem.bounds.size(), bound);
          const Result result = solve(problem, true, 1e-8);
          EXPECT_EQ(result.u.l2_norm(), 0.);
          EXPECT_EQ(result.report.iterations, 0u);
          EXPECT_EQ(result.report.relative_error, 0.);
        }
  }
} // namespace
