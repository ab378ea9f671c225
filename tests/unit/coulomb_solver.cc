// SPDX-License-Identifier: LGPL-2.1-or-later

// The contact solver with friction bounds by the pressure of the step itself,
// on small dense problems, against a damped fixed point of given bounds.

#include "dense_bulk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace Viscoplastic;
using namespace Viscoplastic::Testing;

namespace
{
  struct CoulombProblem
  {
    Problem    problem;
    CoulombLaw law;
  };



  /// The kinds of nodes in random problems on rigid foundations. Half of the
  /// problems are limit cases: no load, no distance, a start in equilibrium, mu
  /// that vanishes or varies along the face.
  enum class Nodes
  {
    plain,
    oblique,     // rows that are no components of the node
    corners,     // at some of the nodes two pieces meet
    soft_corners // at right angles, and one of the two gives way
  };



  Nodes
  nodes_of(const unsigned int seed)
  {
    return seed % 5 == 4 ? Nodes::oblique :
           seed % 5 == 3 ? Nodes::corners :
                           Nodes::plain;
  }



  CoulombProblem
  random_coulomb_problem(const unsigned int seed,
                         const unsigned int n_tangents,
                         const double       largest,
                         const Nodes        nodes = Nodes::plain)
  {
    Random             random(seed);
    CoulombProblem     result;
    Problem           &problem = result.problem;
    const unsigned int n_dofs  = n_tangents + 1;
    const unsigned int n_nodes = random.integer(3, 8);
    for (unsigned int n = 0; n < n_nodes; ++n)
      {
        std::vector<Tensor<1, 3>> rows = random_rows(random, n_dofs, n_dofs);
        const bool                are_components =
          nodes == Nodes::plain || nodes == Nodes::soft_corners;
        if (are_components) // some component of the node for each row
          for (unsigned int i = 0; i < n_dofs; ++i)
            {
              rows[i]                   = Tensor<1, 3>();
              rows[i][(i + n) % n_dofs] = random.integer(0, 1) ? 1. : -1.;
            }
        std::vector<std::vector<Tensor<1, 3>>> planes;
        std::vector<Tensor<1, 3>>              normals;
        const unsigned int                     n_pieces =
          nodes >= Nodes::corners ? random.integer(1, 2) : 1;
        for (unsigned int piece = 0; piece < n_pieces; ++piece)
          {
            if (piece > 0) // at a right angle, or at any
              {
                if (nodes == Nodes::soft_corners || random.integer(0, 1))
                  std::swap(rows[0], rows.back());
                else
                  rows = random_rows(random, n_dofs, n_dofs);
              }
            normals.push_back(rows.back());
            planes.emplace_back(rows.begin(), rows.end() - 1);
          }
        problem.add_node(n_dofs, planes, normals);
        if (nodes == Nodes::soft_corners && n_pieces == 2)
          problem.face.points[problem.face.points.size() - random.integer(1, 2)]
            .compliance.add(random.logarithmic(0.1, 100.),
                            power_pressure(1. + 0.5 * random.integer(0, 2)));
      }
    fill_at_random(problem, random, random.integer(2, 6), 0., 1.);
    const unsigned int tie = seed % 2 == 1 ? random.integer(0, 4) : 9;
    if (tie == 0)
      problem.load = 0.;
    if (tie == 1)
      problem.A.vmult(problem.load, problem.u_prev);
    const double mu = random.uniform(0., largest);
    for (unsigned int p = 0; p < problem.bounds.size(); ++p)
      {
        const bool is_obstacle = problem.face.points[p].is_obstacle;
        problem.bounds[p] =
          is_obstacle && tie != 1 && tie != 2 ?
            std::max(0., problem.bounds[p] - 0.5) * random.integer(0, 1) :
            0.;
        result.law.given.push_back(0.);
        const unsigned int node = problem.face.points[p].node;
        result.law.of_pressure.emplace_back();
        if (!is_obstacle)
          {
            result.law.of_pressure.back().resize(
              problem.face.first_point[node + 1] -
                problem.face.first_obstacle(node),
              0.);
            result.law.of_pressure.back()[p - problem.face.first_point[node]] =
              tie == 3 ? mu * random.integer(0, 1) :
              tie == 4 ? random.uniform(0., mu) :
                         mu;
          }
      }
    return result;
  }



  Result
  solve(const CoulombProblem &coulomb,
        const bool            condensed,
        const double          tolerance,
        const unsigned int    max_iterations = 200)
  {
    const Problem &problem = coulomb.problem;
    DenseBulk      bulk(problem, condensed);
    bulk.start_at(problem.u_prev);
    bulk.scale.rounding_error = 1e-13;
    Vector<double>      increment(problem.face.n_dofs());
    ContactState        state(problem.bounds);
    const ContactReport report =
      ContactSolver(max_iterations)
        .solve(bulk, problem.face, tolerance, increment, state, &coulomb.law);
    return {bulk.u, state, report};
  }



  /// Check the laws of contact and equilibrium.
  void
  expect_laws(const CoulombProblem &coulomb,
              const Result         &result,
              const double          tolerance)
  {
    const Problem      &problem = coulomb.problem;
    const ContactState &state   = result.state;
    Vector<double>      missing = problem.residual(result.u);
    missing -= problem.force(state.multiplier);
    EXPECT_LT(missing.linfty_norm(), tolerance);
    const auto slips = problem.slips(result.u);
    for (unsigned int p = 0; p < slips.size(); ++p)
      if (problem.face.points[p].is_obstacle)
        {
          const double left  = problem.bounds[p] - slips[p][0],
                       force = state.multiplier[p][0];
          EXPECT_GE(force, 0.);
          if (!problem.face.points[p].compliance.is_rigid())
            EXPECT_NEAR(force,
                        problem.face.points[p].compliance.force(-left),
                        tolerance);
          else
            {
              EXPECT_GE(left, -1e-12);
              EXPECT_LE(force * left, tolerance);
            }
        }
      else
        {
          const double bound = coulomb.law.bound(problem.face, state, p);
          EXPECT_LE(state.multiplier[p].norm(), bound + tolerance);
          EXPECT_LE(bound * slips[p].norm() - state.multiplier[p] * slips[p],
                    tolerance);
        }
  }



  /// Iterate solves with given bounds, which follow the pressure by @p share.
  bool
  find_fixed_point(const CoulombProblem &coulomb,
                   const double          share,
                   Solution             &solution)
  {
    Problem problem(coulomb.problem);
    for (unsigned int iteration = 0; iteration < 60; ++iteration)
      {
        solution      = reference_solution(problem);
        double change = 0., sum = 0.;
        for (unsigned int p = 0; p < problem.bounds.size(); ++p)
          if (!problem.face.points[p].is_obstacle)
            {
              unsigned int o =
                problem.face.first_obstacle(problem.face.points[p].node);
              double bound = 0.;
              for (const double coefficient : coulomb.law.of_pressure[p])
                bound += coefficient * solution.multipliers[o++][0];
              change += std::abs(bound - problem.bounds[p]);
              sum += bound;
              problem.bounds[p] += share * (bound - problem.bounds[p]);
            }
        if (change <= 1e-12 * (sum + 1e-3))
          return true;
      }
    return false;
  }



  /// The number of corrections of a solve with the final bounds held fixed.
  unsigned int
  corrections_of_given_bounds(const CoulombProblem &coulomb,
                              const Result         &result,
                              const bool            condensed)
  {
    DenseBulk bulk(coulomb.problem, condensed);
    bulk.start_at(coulomb.problem.u_prev);
    bulk.scale.rounding_error = 1e-13;
    Vector<double> increment(coulomb.problem.face.n_dofs());
    ContactState   state(result.state.bound);
    return ContactSolver(200)
      .solve(bulk, coulomb.problem.face, 1e-9, increment, state)
      .iterations;
  }
} // namespace



TEST(CoulombSolver, SolvesAllRandomProblems)
{
  // With mu up to 2, where there may be several solutions, or none that a fixed
  // point of bounds finds.
  unsigned int n_corrections = 0, n_of_given_bounds = 0;
  for (unsigned int seed = 0; seed < 1000; ++seed)
    {
      const CoulombProblem coulomb =
        random_coulomb_problem(seed, 1 + seed / 2 % 2, 2., nodes_of(seed));
      const bool condensed = seed / 4 % 2 == 0;
      SCOPED_TRACE("seed " + std::to_string(seed));
      const Result result = solve(coulomb, condensed, 1e-9);
      expect_laws(coulomb, result, 1e-7);
      if (nodes_of(seed) != Nodes::plain)
        continue;
      // Compare corrections with those of a solve for the final bounds.
      n_corrections += result.report.iterations;
      n_of_given_bounds +=
        corrections_of_given_bounds(coulomb, result, condensed);
    }
  EXPECT_LT(n_corrections, 1.2 * n_of_given_bounds);
}



TEST(CoulombSolver, SolvesWherePiecesMeet)
{
  // Hard cases among 20 000 problems, for which a search over all states of
  // points finds solutions: nodes wedged between two pieces (2D), slips along
  // an edge that turn, nodes whose pieces do not settle one after the other,
  // and two that need a continuation from small mu.
  for (const unsigned int seed :
       {3144, 4416, 5044, 2403, 2999, 3290, 5267, 12660, 15030})
    {
      const CoulombProblem coulomb =
        random_coulomb_problem(seed, 1 + seed / 2 % 2, 2., Nodes::corners);
      SCOPED_TRACE("seed " + std::to_string(seed));
      expect_laws(coulomb, solve(coulomb, seed / 4 % 2 == 0, 1e-9, 40), 1e-7);
    }
}



TEST(CoulombSolver, SolvesWhereOneOfTwoPiecesGivesWay)
{
  // The rigid piece holds the direction in which the soft one sticks, and
  // friction along the soft one's normal depends on that: the linear system has
  // to contain the part of it that changes.
  unsigned int n_corrections = 0, n_of_given_bounds = 0;
  for (unsigned int seed = 0; seed < 800; ++seed)
    {
      const CoulombProblem coulomb =
        random_coulomb_problem(seed, 1 + seed / 2 % 2, 1., Nodes::soft_corners);
      const bool condensed = seed / 4 % 2 == 0;
      SCOPED_TRACE("seed " + std::to_string(seed));
      const Result result = solve(coulomb, condensed, 1e-9);
      expect_laws(coulomb, result, 1e-7);
      n_corrections += result.report.iterations;
      n_of_given_bounds +=
        corrections_of_given_bounds(coulomb, result, condensed);
    }
  EXPECT_LT(n_corrections, 1.2 * n_of_given_bounds);
}



TEST(CoulombSolver, FindsTheFixedPointOfBounds)
{
  // For small mu the solution is unique.
  for (unsigned int seed = 0; seed < 24; ++seed)
    {
      const CoulombProblem coulomb =
        random_coulomb_problem(seed, 1 + seed / 2 % 2, 0.4, nodes_of(seed));
      SCOPED_TRACE("seed " + std::to_string(seed));
      Solution reference;
      ASSERT_TRUE(find_fixed_point(coulomb, 1., reference));
      Vector<double> error = solve(coulomb, true, 1e-10).u;
      error -= reference.u;
      EXPECT_LT(coulomb.problem.energy_norm(error), 1e-8);
    }
}



TEST(CoulombSolver, TellsWherePivotsChangeTheirSign)
{
  // Those of 20 000 problems in which the system of the final active sets has a
  // negative determinant, so that there are several solutions. In half of them
  // `contraction`, a quotient of corrections, is less than 1.
  const std::vector<unsigned int> negative{58,    135,   147,   1342,  2520,
                                           3683,  3874,  4368,  5214,  5816,
                                           6121,  6412,  7134,  9081,  10432,
                                           11227, 11304, 12076, 12166, 14791,
                                           15687, 17562, 18278, 18605};
  unsigned int                    n_told = 0;
  for (const unsigned int seed : negative)
    {
      const Result result =
        solve(random_coulomb_problem(seed, 1, 4.), true, 1e-9);
      EXPECT_FALSE(result.report.doubt.empty()) << "seed " << seed;
      n_told += result.report.contraction >= 1.;
    }
  EXPECT_LT(n_told, negative.size());
  for (unsigned int seed = 0; seed < 50; ++seed)
    {
      const ContactReport report =
        solve(random_coulomb_problem(seed, 1, 0.2), true, 1e-9).report;
      EXPECT_EQ(report.doubt.empty(), report.contraction < 1.);
    }
}



TEST(CoulombSolver, ForceOfACornerIsShared)
{
  // A node is pressed onto a wall by 1 and pushed along it by 0.3, and friction
  // l of a second piece, |l| <= 0.1, acts along the normal of the wall. For any
  // l, the wall has the pressure p = 1 - l and friction up to 0.3 p. All of
  // these are solutions: the node sticks for l <= 0, and slips by 0.3 l
  // otherwise, by 1e-12 as well as by 0.03.
  constexpr double mu = 0.3;
  CoulombProblem   corner;
  Problem         &problem = corner.problem;
  Tensor<1, 3>     across, along;
  across[0] = 1.;
  along[1]  = 1.;
  problem.add_node(2, {{along}, {across}}, {across});
  problem.A              = IdentityMatrix(2);
  problem.u_prev         = Vector<double>(2);
  problem.bounds         = {0., 0., 0.};
  corner.law.given       = {0., 0.1, 0.};
  corner.law.of_pressure = {{mu}, {0.}, {}};
  const std::vector<double> load{1., 0.3};
  problem.load        = Vector<double>(load.begin(), load.end());
  const auto solution = [&](const double share) {
    Result result{Vector<double>(2), ContactState(problem.bounds), {}};
    result.u[1]                   = std::max(0., mu * share);
    result.state.multiplier[0][0] = 0.3 - result.u[1];
    result.state.multiplier[1][0] = share;
    result.state.multiplier[2][0] = 1. - share;
    return result;
  };
  for (const double share : {-0.1, -0.03, 0., 1e-12, 0.04, 0.1})
    {
      expect_laws(corner, solution(share), 1e-15);
      // A solver that begins with sticking ends with it, and so with slip.
      DenseBulk bulk(problem, true);
      bulk.start_at(problem.u_prev);
      bulk.scale.rounding_error = 1e-13;
      Vector<double> increment(2);
      Result         found = solution(share);
      increment[1]         = found.u[1];
      found.state.sticks   = {share <= 0., true, true};
      bulk.move_face(increment);
      ContactSolver(40).solve(
        bulk, problem.face, 1e-12, increment, found.state, &corner.law);
      found.u = bulk.u;
      expect_laws(corner, found, 1e-11);
      EXPECT_EQ(found.state.sticks[0], share <= 0.);
      EXPECT_NEAR(found.u[1], share <= 0. ? 0. : 0.02807, 1e-5);
    }
}



TEST(CoulombSolver, BoundsItsError)
{
  // The error bound that stops the iteration is not less than the difference to
  // a solve up to rounding, and usually not much larger.
  for (const Nodes nodes : {Nodes::plain, Nodes::corners})
    {
      double       logarithms = 0.;
      unsigned int n          = 0;
      for (unsigned int seed = 0; seed < 200; ++seed)
        {
          const CoulombProblem coulomb =
            random_coulomb_problem(seed, 1 + seed / 2 % 2, 1., nodes);
          const Result exact = solve(coulomb, false, 1e-11);
          for (const double tolerance : {1e-1, 1e-2, 1e-3})
            {
              const Result   result = solve(coulomb, false, tolerance);
              Vector<double> error(exact.u);
              error -= result.u;
              const double size = coulomb.problem.energy_norm(error);
              EXPECT_LE(size, result.report.error + 1e-9)
                << "seed " << seed << ", tolerance " << tolerance;
              if (size > 1e-9)
                {
                  logarithms += std::log10(result.report.error / size);
                  ++n;
                }
            }
        }
      // The mean ratios are 2.3 and 2.5.
      EXPECT_LT(std::pow(10., logarithms / n), 5.);
    }
}
