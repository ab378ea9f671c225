// SPDX-License-Identifier: LGPL-2.1-or-later

// Obstacles in the contact solver: unilateral contact and compliant
// foundations, on small convex problems.

#include "dense_bulk.h"
#include <viscoplastic_contact/contact/contact_solver.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  TEST(Obstacles, UnilateralContact)
  {
    constexpr double tolerance = 1e-9;
    for (const unsigned int n_tangents : {0, 1, 2})
      for (const bool with_corners : {false, true})
        {
          unsigned int n_open = 0, n_touch = 0, n_iterations = 0, n_solves = 0;
          for (unsigned int seed = 0; seed < 40; ++seed)
            {
              const Problem problem =
                random_unilateral_problem(seed, n_tangents, with_corners);
              const Solution reference = reference_solution(problem);
              for (const bool condensed : {true, false})
                {
                  SCOPED_TRACE("seed " + std::to_string(seed) + ", tangents " +
                               std::to_string(n_tangents) +
                               (with_corners ? ", corners" : "") +
                               (condensed ? ", condensed" : ", frozen bulk"));
                  const Result result = solve(problem, condensed, tolerance);
                  expect_solution(problem, result, reference, tolerance);
                  EXPECT_NEAR(result.report.duality_gap,
                              duality_gap(problem, result),
                              1e-12);
                  for (unsigned int p = 0; p < problem.bounds.size(); ++p)
                    if (problem.face.points[p].is_obstacle)
                      ++(result.state.sticks[p] ? n_touch : n_open);
                  n_iterations += result.report.iterations;
                  ++n_solves;

                  // A start from the solution needs no iteration.
                  const Result again = solve(
                    problem, condensed, tolerance, result.state, result.u);
                  EXPECT_EQ(again.report.iterations, 0u);
                  // At corners the active sets may not be unique.
                  if (!with_corners)
                    {
                      EXPECT_EQ(again.state.sticks, result.state.sticks);
                    }
                }
            }
          EXPECT_GT(n_open, 50u);
          EXPECT_GT(n_touch, 50u);
          EXPECT_LT(n_iterations / double(n_solves),
                    with_corners   ? 8. :
                    n_tangents < 2 ? 4. :
                                     6.);
        }
  }



  TEST(Obstacles, ObstaclesThatGiveWay)
  {
    // The duality gap of any admissible forces bounds the error.
    constexpr double tolerance = 1e-9;
    for (const unsigned int n_tangents : {0, 1, 2})
      for (const bool with_corners : {false, true})
        {
          unsigned int n_open = 0, n_pressed = 0, n_iterations = 0;
          for (unsigned int seed = 0; seed < 40; ++seed)
            for (const bool condensed : {true, false})
              {
                SCOPED_TRACE("seed " + std::to_string(seed) + ", tangents " +
                             std::to_string(n_tangents) +
                             (with_corners ? ", corners" : "") +
                             (condensed ? ", condensed" : ", frozen bulk"));
                Problem problem =
                  random_unilateral_problem(seed, n_tangents, with_corners);
                Random random(seed + 1000);
                for (auto &point : problem.face.points)
                  if (point.is_obstacle)
                    for (unsigned int piece = 0; piece < 1 + seed % 2; ++piece)
                      point.compliance.add(random.logarithmic(0.1, 1e6),
                                           power_pressure(
                                             1. + 0.5 * (seed % 4) + piece));
                const Result result = solve(problem, condensed, tolerance);
                n_iterations += result.report.iterations;

                Vector<double> unbalanced = problem.residual(result.u);
                unbalanced -= problem.force(result.state.multiplier);
                double gap =
                  0.5 * (unbalanced * solve_dense(problem.A, unbalanced));
                const auto slips = problem.slips(result.u);
                for (unsigned int c = 0; c < slips.size(); ++c)
                  {
                    const auto        &point = problem.face.points[c];
                    const Tensor<1, 2> force = result.state.multiplier[c];
                    if (point.is_obstacle)
                      {
                        const double w = slips[c][0] - problem.bounds[c],
                                     p = force[0];
                        ASSERT_GE(p, 0.);
                        const double there = point.compliance.penetration(p);
                        gap += point.compliance.energy(w) -
                               point.compliance.energy(there) - p * (w - there);
                        EXPECT_EQ(result.state.sticks[c], p > 0.);
                        ++(p > 0. ? n_pressed : n_open);
                        continue;
                      }
                    ASSERT_LE(force.norm(), problem.bounds[c] * (1. + 1e-14));
                    // At corners, sticking slips have the error of their node.
                    if (result.state.sticks[c])
                      {
                        EXPECT_LE(slips[c].norm(), 0.1 * tolerance);
                        continue;
                      }
                    gap +=
                      problem.bounds[c] * slips[c].norm() - force * slips[c];
                  }
                const double size = problem.energy_norm(result.u);
                EXPECT_LE(gap, 0.5 * std::pow(tolerance * size, 2) + 1e-14);
              }
          EXPECT_GT(n_open, 50u);
          EXPECT_GT(n_pressed, 50u);
          EXPECT_LT(n_iterations / 80., with_corners ? 10. : 7.);
        }
  }



  /// Nodes at which two pieces in unilateral contact with friction meet at an
  /// angle, in 3D at an edge. Their foundations approach or recede.
  Problem
  pushed_corners(const unsigned int seed,
                 const unsigned int dim,
                 const double       degrees)
  {
    Random      random(seed);
    Problem     problem;
    const auto  planes = planes_at_an_angle(dim, degrees);
    const auto &along  = planes[1][0]; // its normal is at a right angle
    for (unsigned int n = 0; n < 3; ++n)
      problem.add_node(dim,
                       planes,
                       {vector(0, -1), vector(-along[1], along[0])});
    fill_at_random(problem, random, 4, 0., 1.);
    for (unsigned int p = 0; p < problem.bounds.size(); ++p)
      problem.bounds[p] = problem.face.points[p].is_obstacle ?
                            random.integer(0, 2) * random.uniform(-0.3, 0.2) :
                            random.logarithmic(1e-3, 1e2);
    return problem;
  }



  TEST(Obstacles, FoundationsThatPushAgainstFriction)
  {
    // One piece holds a node that the foundation of the other moves. The
    // duality gap contains the slips of all points, also of sticking ones.
    constexpr double tolerance = 1e-9;
    for (const unsigned int dim : {2, 3})
      {
        unsigned int n_pushed = 0, n_stick = 0;
        for (const double degrees : {90., 60., 120.})
          for (unsigned int seed = 0; seed < 30; ++seed)
            for (const bool condensed : {true, false})
              {
                SCOPED_TRACE("dim " + std::to_string(dim) + ", seed " +
                             std::to_string(seed) + ", degrees " +
                             std::to_string(degrees) +
                             (condensed ? ", condensed" : ", frozen bulk"));
                const Problem problem = pushed_corners(seed, dim, degrees);
                const Result  result  = solve(problem, condensed, tolerance);
                const double  size    = problem.energy_norm(result.u);
                const auto    slips   = problem.slips(result.u);
                double        work    = 1.;
                for (unsigned int p = 0; p < slips.size(); ++p)
                  work += result.state.multiplier[p].norm() * slips[p].norm();
                EXPECT_LE(duality_gap(problem, result),
                          0.5 * std::pow(tolerance * size, 2) + 1e-11 * work);
                EXPECT_GE(duality_gap(problem, result), -1e-11 * work);
                for (unsigned int p = 0; p < slips.size(); ++p)
                  if (problem.face.points[p].is_obstacle)
                    {
                      EXPECT_LE(slips[p][0], problem.bounds[p] + 1e-11);
                      EXPECT_GE(result.state.multiplier[p][0], 0.);
                    }
                  else
                    {
                      EXPECT_LE(result.state.multiplier[p].norm(),
                                problem.bounds[p] * (1. + 1e-14));
                      n_stick += result.state.sticks[p];
                      n_pushed +=
                        !result.state.sticks[p] && problem.bounds[p] > 10.;
                    }
              }
        EXPECT_GT(n_stick, 50u);
        EXPECT_GT(n_pushed, 30u);
      }
  }



  TEST(Obstacles, WholeFaceClosesOrOpensAtOnce)
  {
    // The force on the obstacles is the excess times the load or none.
    for (const unsigned int n_tangents : {1, 2})
      for (const double excess : {-1e-3, -1e-12, 0., 1e-16, 1e-12, 1e-3})
        for (const bool condensed : {true, false})
          {
            std::ostringstream trace;
            trace << "tangents " << n_tangents << ", excess " << excess
                  << (condensed ? ", condensed" : ", frozen bulk");
            SCOPED_TRACE(trace.str());
            Random  random(7);
            Problem problem;
            for (unsigned int n = 0; n < 6; ++n)
              {
                auto rows = random_rows(random, n_tangents + 1, n_tangents + 1);
                const Tensor<1, 3> normal = rows.back();
                rows.pop_back();
                problem.add_node(n_tangents + 1, {rows}, {normal});
              }
            fill_at_random(problem, random, 4, 0.2, 0.4);
            // All obstacles are just touched by a given displacement without
            // slip, which is in equilibrium with the load.
            Vector<double>            u(problem.u_prev), force(problem.size());
            std::vector<Tensor<1, 2>> pressure(problem.bounds.size());
            for (unsigned int p = 0; p < problem.bounds.size(); ++p)
              if (problem.face.points[p].is_obstacle)
                {
                  problem.bounds[p] = 0.;
                  pressure[p][0]    = excess;
                }
            problem.A.vmult(problem.load, u);
            problem.load += problem.force(pressure);
            const Result result = solve(problem, condensed, 1e-10);
            expect_solution(problem,
                            result,
                            reference_solution(problem),
                            1e-10);
            EXPECT_LE(result.report.iterations, 6u);
          }
  }



  TEST(Obstacles, StiffnessesOfManyDecades)
  {
    // A solution is as accurate as reported, up to rounding, or refused.
    constexpr double tolerance = 1e-8;
    unsigned int     n_refused = 0, n_solved = 0;
    for (const double decades : {0., 3., 6., 9.})
      for (unsigned int seed = 0; seed < 100; ++seed)
        for (const bool condensed : {true, false})
          {
            // The other linear solver has no preconditioner for this.
            if (!condensed && decades > 3.)
              continue;
            SCOPED_TRACE("decades " + std::to_string(decades) + ", seed " +
                         std::to_string(seed) +
                         (condensed ? ", condensed" : ", frozen bulk"));
            const Problem problem = spring_network(seed, decades);
            Result        result;
            try
              {
                result = solve(problem,
                               condensed,
                               tolerance,
                               ContactState(problem.bounds),
                               problem.u_prev,
                               200,
                               problem.rounding_error(problem.u_prev));
              }
            catch (const ExceptionBase &refusal)
              {
                std::ostringstream sentence;
                refusal.print_info(sentence);
                EXPECT_NE(sentence.str().find("ounding"), std::string::npos)
                  << sentence.str();
                ++n_refused;
                continue;
              }
            ++n_solved;
            Vector<double> unbalanced = problem.residual(result.u);
            unbalanced -= problem.force(result.state.multiplier);
            cholesky_factor(problem.A).solve(unbalanced);
            const double size     = problem.energy_norm(result.u),
                         rounding = problem.rounding_error(problem.u_prev) +
                                    problem.rounding_error(result.u);
            EXPECT_LE(unbalanced.l2_norm(),
                      1.1 * std::max(result.report.error, tolerance * size) +
                        rounding);
            // Check the laws of contact up to rounding of displacements.
            const auto   slips = problem.slips(result.u);
            const double way   = 1e-11 * (result.u.linfty_norm() + 1.);
            for (unsigned int c = 0; c < slips.size(); ++c)
              {
                const auto        &point = problem.face.points[c];
                const Tensor<1, 2> force = result.state.multiplier[c];
                const double       w     = slips[c][0] - problem.bounds[c];
                if (!point.compliance.is_rigid())
                  {
                    EXPECT_GE(force[0], 0.);
                    EXPECT_LE(point.compliance.force(w - way),
                              force[0] * (1. + 1e-6) + rounding);
                    EXPECT_GE(point.compliance.force(w + way),
                              force[0] * (1. - 1e-6) - rounding);
                  }
                else if (point.is_obstacle)
                  {
                    EXPECT_LE(w, way);
                    EXPECT_GE(force[0], 0.);
                    EXPECT_TRUE(force[0] == 0. || w > -way);
                  }
                else
                  {
                    EXPECT_LE(force.norm(), problem.bounds[c] * (1. + 1e-14));
                    EXPECT_TRUE(slips[c].norm() <= way ||
                                force * slips[c] >= 0.);
                  }
              }
          }
    EXPECT_LT(n_refused, 0.02 * n_solved);
  }



  TEST(Obstacles, SlipThatBeginsBesideOneThatIsUnderWay)
  {
    // A node on the edge of a rigid and a soft plane with friction on both,
    // from a run. On the way to the minimum the slip on the rigid plane
    // vanishes and has to begin again.
    ContactLayout        face;
    ContactLayout::Point point;
    point.node       = 0;
    point.n_tangents = 2;
    point.map = {{Tensor<1, 3>({0., 1., 0.}), Tensor<1, 3>({0., 0., 1.})}};
    face.points.push_back(point);
    point.map[0] = Tensor<1, 3>({1., 0., 0.});
    face.points.push_back(point);
    point.n_tangents  = 1;
    point.is_obstacle = true;
    point.map         = {{Tensor<1, 3>({-1., 0., 0.}), Tensor<1, 3>()}};
    face.points.push_back(point);
    point.map[0] = Tensor<1, 3>({0., -1., 0.});
    point.compliance.add(0.416666666667, power_pressure(1.));
    face.points.push_back(point);
    face.has_obstacles = true;
    face.first_dof.push_back(3);
    face.first_point.push_back(4);

    const Tensor<2, 3> D(
      {{0.0953053762799, 0.029781772858, 4.58165967476e-05},
       {0.029781772858, 0.0952130180243, 4.72171061872e-05},
       {4.58165967476e-05, 4.72171061872e-05, 0.0740933787698}});
    const Tensor<1, 3> force(
      D * Tensor<1, 3>({0., -7.41943195166e-07, 0.}) +
      Tensor<1, 3>(
        {-0.000239058511726, -0.000517824549264, 0.000322814252215}));
    ContactState       state({6.36280209843e-05,
                              0.000320944246214,
                              -1.03209255237e-17,
                              -0.00108932972468});
    const Tensor<1, 3> x = relax_node(face, 0, invert(D), force, state);
    EXPECT_GT(x[2], 1e-9);
    Vector<double> residual(3), of_points(3);
    face.set_node_values(force - D * x, 0, residual);
    for (unsigned int p = 0; p < 4; ++p)
      if (!face.points[p].is_obstacle)
        state.slip[p] = slip(face.points[p], x);
      else
        state.slip[p][0] = face.points[p].map[0] * x;
    fit_multipliers(face, residual, state, of_points);
    of_points -= residual;
    EXPECT_LT(of_points.l2_norm(), 1e-12 * residual.l2_norm());
  }



  TEST(Obstacles, PressureLaws)
  {
    unsigned int n_laws = 0;
    for (const ContactLaw &law : contact_laws())
      for (const double factor : {1., 1.3, 2.})
        {
          if (!law.make)
            continue;
          SCOPED_TRACE(law.name + " with numbers times " +
                       std::to_string(factor));
          ++n_laws;
          std::vector<double> numbers;
          for (const LawEntry &entry : law.entries)
            if (entry.is_number())
              numbers.push_back(factor * std::stod(entry.default_value));
          const PressureLaw pressure = law.make(numbers);
          double            last     = 0.;
          for (const double k : {1e-3, 1., 1e5})
            for (const double w : {1e-3, 0.1, 0.7, 2.})
              {
                const double h = 1e-4 * w, p = pressure.force(k, w);
                EXPECT_GT(p, 0.);
                EXPECT_NEAR((pressure.force(k, w + h) -
                             pressure.force(k, w - h)) /
                              (2. * h),
                            pressure.slope(k, w),
                            1e-7 * p / w);
                EXPECT_NEAR((pressure.energy(k, w + h) -
                             pressure.energy(k, w - h)) /
                              (2. * h),
                            p,
                            1e-7 * p);
                EXPECT_NEAR(pressure.penetration(k, p), w, 1e-12 * w);
                EXPECT_LT(std::abs(pressure.energy(k, 1e-9 * w)), 1e-8 * p * w);
                if (w > 1e-3)
                  {
                    EXPECT_GE(pressure.slope(k, w), last * (1. - 1e-12));
                  }
                last = pressure.slope(k, w);
                // The pressure is proportional to the factor.
                EXPECT_NEAR(pressure.force(2. * k, w), 2. * p, 1e-13 * p);
              }
        }
    EXPECT_GE(n_laws, 3u);
  }
} // namespace
