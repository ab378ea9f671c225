// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Small convex problems of friction, and their solutions by projected gradients
// on the dual.

#include <deal.II/base/tensor.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/vector.h>

#include "random.h"
#include <viscoplastic_contact/contact/contact_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace Viscoplastic::Testing
{
  using namespace dealii;

  constexpr double infinity = std::numeric_limits<double>::infinity();



  inline Tensor<1, 2>
  clip(const Tensor<1, 2> &multiplier, const double bound)
  {
    const double size = multiplier.norm();
    return size <= bound ? multiplier : multiplier * (bound / size);
  }


  /// Minimize J(u) = 1/2 u . A u - l . u + sum_c rho_c |s_c| with slips
  /// relative to the foundation of each point, and s_c <= d_c at obstacles,
  /// whose bound is d_c. The unknowns of the face are the last ones.
  struct Problem
  {
    FullMatrix<double>  A;
    Vector<double>      load, u_prev;
    ContactLayout       face;
    std::vector<double> bounds;
    /// The motion of foundations by point; empty if none moves.
    std::vector<Tensor<1, 2>> foundation_step;

    unsigned int
    size() const
    {
      return load.size();
    }

    unsigned int
    first() const
    {
      return size() - face.n_dofs();
    }

    Vector<double>
    on_face(const Vector<double> &u) const
    {
      return Vector<double>(u.begin() + first(), u.end());
    }

    std::vector<Tensor<1, 2>>
    slips(const Vector<double> &u) const
    {
      Vector<double> change(u);
      change -= u_prev;
      change = on_face(change);
      std::vector<Tensor<1, 2>> result;
      for (const auto &point : face.points)
        result.push_back(slip(point, face.node_values(change, point.node)));
      for (unsigned int p = 0; p < foundation_step.size(); ++p)
        result[p] -= foundation_step[p];
      return result;
    }

    /// B^T lambda on all unknowns.
    Vector<double>
    force(const std::vector<Tensor<1, 2>> &multipliers) const
    {
      Vector<double> result(size());
      for (unsigned int p = 0; p < face.points.size(); ++p)
        {
          const unsigned int node = face.points[p].node;
          const Tensor<1, 3> f    = node_force(face.points[p], multipliers[p]);
          for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
            result[first() + face.first_dof[node] + i] += f[i];
        }
      return result;
    }

    /// l - A u.
    Vector<double>
    residual(const Vector<double> &u) const
    {
      Vector<double> r(size());
      A.residual(r, u, load);
      return r;
    }

    double
    energy_norm(const Vector<double> &u) const
    {
      return std::sqrt(A.matrix_norm_square(u));
    }

    /// The error of rounding as StepSolver estimates it.
    double
    rounding_error(const Vector<double> &start) const
    {
      double sum = 0.;
      for (unsigned int i = 0; i < size(); ++i)
        sum += A(i, i) * (start[i] * start[i] + u_prev[i] * u_prev[i]) +
               load[i] * load[i] / A(i, i);
      return 100. * std::numeric_limits<double>::epsilon() * std::sqrt(sum);
    }

    void
    add_node(const unsigned int                            n_dofs,
             const std::vector<std::vector<Tensor<1, 3>>> &planes,
             const std::vector<Tensor<1, 3>>              &normals = {})
    {
      ContactLayout::Point point;
      point.node = face.n_nodes();
      for (const auto &rows : planes)
        {
          point.n_tangents = rows.size();
          std::copy(rows.begin(), rows.end(), point.map.begin());
          face.points.push_back(point);
        }
      point.n_tangents   = 1;
      point.is_obstacle  = true;
      face.has_obstacles = face.has_obstacles || !normals.empty();
      for (const auto &normal : normals)
        {
          point.map = {{normal, Tensor<1, 3>()}};
          face.points.push_back(point);
        }
      face.first_dof.push_back(face.first_dof.back() + n_dofs);
      face.first_point.push_back(face.points.size());
    }
  };



  /// Return the Cholesky factor L of a positive definite matrix L L^T.
  inline LAPACKFullMatrix<double>
  cholesky_factor(const FullMatrix<double> &matrix)
  {
    const unsigned int       n = matrix.m();
    LAPACKFullMatrix<double> factor(n, n), result(n, n);
    factor = matrix;
    factor.set_property(LAPACKSupport::symmetric);
    factor.compute_cholesky_factorization();
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j <= i; ++j)
        result(i, j) = factor(i, j);
    result.set_property(LAPACKSupport::lower_triangular);
    return result;
  }



  inline Vector<double>
  solve_dense(const FullMatrix<double> &matrix,
              const Vector<double>     &right_side)
  {
    const LAPACKFullMatrix<double> factor = cholesky_factor(matrix);
    Vector<double>                 result(right_side);
    factor.solve(result);
    factor.solve(result, /* transposed = */ true);
    return result;
  }



  inline FullMatrix<double>
  random_matrix(Random &random, const unsigned int n)
  {
    FullMatrix<double> G(n, n), A(n, n);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        G(i, j) = random.uniform();
    G.mTmult(A, G);
    for (unsigned int i = 0; i < n; ++i)
      A(i, i) += 0.3;
    return A;
  }



  inline Tensor<1, 3>
  vector(const double x, const double y, const double z = 0.)
  {
    Tensor<1, 3> v;
    v[0] = x;
    v[1] = y;
    v[2] = z;
    return v;
  }



  /// Orthonormal rows in the first n components.
  inline std::vector<Tensor<1, 3>>
  random_rows(Random            &random,
              const unsigned int n_tangents,
              const unsigned int n)
  {
    std::vector<Tensor<1, 3>> rows;
    while (rows.size() < n_tangents)
      {
        Tensor<1, 3> v;
        for (unsigned int d = 0; d < n; ++d)
          v[d] = random.uniform();
        for (const auto &row : rows)
          v -= (v * row) * row;
        if (v.norm() > 0.1)
          rows.push_back(v / v.norm());
      }
    return rows;
  }



  /// The rows of slips of two pieces that meet at an angle, in 3D at an edge.
  inline std::vector<std::vector<Tensor<1, 3>>>
  planes_at_an_angle(const unsigned int dim, const double degrees)
  {
    const double                           angle = degrees * numbers::PI / 180.;
    std::vector<std::vector<Tensor<1, 3>>> planes{
      {vector(1, 0)}, {vector(std::cos(angle), std::sin(angle))}};
    if (dim == 3)
      for (auto &rows : planes)
        rows.push_back(vector(0, 0, 1));
    return planes;
  }



  /// Complete a problem with given nodes by @p n_bulk unknowns besides those of
  /// the face, and by bounds in an interval.
  inline void
  fill_at_random(Problem           &problem,
                 Random            &random,
                 const unsigned int n_bulk,
                 const double       least_bound,
                 const double       largest_bound)
  {
    const unsigned int n = n_bulk + problem.face.n_dofs();
    problem.A            = random_matrix(random, n);
    problem.load.reinit(n);
    problem.u_prev.reinit(n);
    for (unsigned int i = 0; i < n; ++i)
      {
        problem.load[i]   = random.uniform();
        problem.u_prev[i] = random.uniform(-0.3, 0.3);
      }
    for (unsigned int p = 0; p < problem.face.points.size(); ++p)
      problem.bounds.push_back(random.uniform(least_bound, largest_bound));
  }



  /// Nodes with bilateral contact (as many components as tangents) and with
  /// given normal stress (one more).
  inline Problem
  random_problem(const unsigned int seed, const unsigned int n_tangents)
  {
    Random             random(seed);
    Problem            problem;
    const unsigned int n_nodes = random.integer(3, 6);
    for (unsigned int n = 0; n < n_nodes; ++n)
      {
        const unsigned int n_dofs = n_tangents + random.integer(0, 1);
        problem.add_node(n_dofs, {random_rows(random, n_tangents, n_dofs)});
      }
    fill_at_random(problem, random, random.integer(2, 6), 0., 1.5);
    return problem;
  }



  /// Nodes in unilateral contact with 0 to 2 tangents, and at corners with two
  /// obstacles. Some distances are zero.
  inline Problem
  random_unilateral_problem(const unsigned int seed,
                            const unsigned int n_tangents,
                            const bool         with_corners)
  {
    Random             random(seed);
    Problem            problem;
    const unsigned int n_nodes = random.integer(3, 6);
    for (unsigned int n = 0; n < n_nodes; ++n)
      {
        const unsigned int        n_dofs = n_tangents + 1;
        auto                      rows   = random_rows(random, n_dofs, n_dofs);
        std::vector<Tensor<1, 3>> normals{rows.back()};
        if (with_corners && n_dofs > 1)
          normals.push_back(random_rows(random, 1, n_dofs)[0]);
        rows.pop_back();
        problem.add_node(n_dofs,
                         rows.empty() ?
                           std::vector<std::vector<Tensor<1, 3>>>() :
                           std::vector<std::vector<Tensor<1, 3>>>{rows},
                         normals);
      }
    fill_at_random(problem, random, random.integer(2, 6), 0., 1.5);
    for (unsigned int p = 0; p < problem.bounds.size(); ++p)
      if (problem.face.points[p].is_obstacle)
        problem.bounds[p] =
          std::max(0., problem.bounds[p] - 0.5) * random.integer(0, 1);
    return problem;
  }



  /// A network of springs with stiffnesses up to @p decades above or below 1,
  /// held by springs or by hardly anything but contact: without obstacles, with
  /// rigid ones, or with obstacles that are as much softer or stiffer. Loads
  /// and bounds have all sizes.
  inline Problem
  spring_network(const unsigned int seed, const double decades)
  {
    Random             random(seed);
    Problem            problem;
    const unsigned int n_tangents = random.integer(0, 2),
                       kind       = random.integer(n_tangents > 0 ? 0 : 1, 2),
                       n_nodes    = random.integer(2, 8);
    const auto stiffness          = [&] {
      return random.logarithmic(std::pow(10., -decades),
                                std::pow(10., decades));
    };
    for (unsigned int n = 0; n < n_nodes; ++n)
      {
        const unsigned int n_dofs = n_tangents + (kind > 0 ? 1 : 0);
        auto               rows   = random_rows(random, n_dofs, n_dofs);
        std::vector<std::vector<Tensor<1, 3>>> planes;
        std::vector<Tensor<1, 3>>              normals;
        if (kind > 0)
          {
            normals.push_back(rows.back());
            rows.pop_back();
          }
        if (!rows.empty())
          planes.push_back(rows);
        problem.add_node(n_dofs, planes, normals);
      }

    const unsigned int  n = random.integer(2, 12) + problem.face.n_dofs();
    FullMatrix<double> &A = problem.A;
    A.reinit(n, n);
    const auto connect = [&](const unsigned int i, const unsigned int j) {
      const double k     = stiffness(),
                   ratio = random.integer(0, 2) > 0 ? 1. : random.uniform();
      A(i, i) += k;
      A(j, j) += k * ratio * ratio;
      A(i, j) -= k * ratio;
      A(j, i) -= k * ratio;
    };
    for (unsigned int i = 1; i < n; ++i)
      connect(i, random.integer(0, i - 1));
    for (unsigned int i = 0; i < n; ++i)
      for (const unsigned int j :
           {random.integer(0, n - 1), random.integer(0, n - 1)})
        if (i != j)
          connect(i, j);
    const unsigned int held_by = random.integer(0, 2);
    for (unsigned int i = 0; i < n; ++i)
      A(i, i) += held_by == 0 ? stiffness() :
                 held_by == 1 && (i == 0 || random.integer(0, 3) == 0) ?
                                1e-3 * A(i, i) :
                                1e-9 * A(i, i);

    const double size = random.logarithmic(1e-6, 1e6);
    problem.load.reinit(n);
    problem.u_prev.reinit(n);
    for (unsigned int i = 0; i < n; ++i)
      {
        problem.load[i] = size * random.uniform() *
                          (random.integer(0, 1) ? 1. : std::sqrt(A(i, i)));
        if (random.integer(0, 1) == 1)
          problem.u_prev[i] = random.uniform(-0.3, 0.3);
      }
    for (auto &point : problem.face.points)
      if (point.is_obstacle)
        {
          problem.bounds.push_back(random.integer(0, 1) *
                                   random.logarithmic(1e-9, 1.) *
                                   (random.integer(0, 3) > 0 ? 1. : -1.));
          const unsigned int first =
            problem.first() + problem.face.first_dof[point.node];
          if (kind == 2)
            point.compliance.add(A(first, first) * stiffness(),
                                 power_pressure(1. +
                                                0.5 * random.integer(0, 2)));
        }
      else
        problem.bounds.push_back(
          random.integer(0, 5) > 0 ? size * random.logarithmic(1e-6, 1e3) : 0.);
    return problem;
  }



  struct Solution
  {
    Vector<double>            u;
    std::vector<Tensor<1, 2>> multipliers;
  };



  /**
   * Projected gradients with Nesterov's extrapolation, restarted whenever it
   * points uphill, on the dual
   *
   *     min 1/2 lambda . B A^-1 B^T lambda - lambda . B (A^-1 l - u_prev),
   *     |lambda_c| <= rho_c,
   *
   * to rounding; for obstacles with lambda_c d_c more and lambda_c >= 0.
   */
  inline Solution
  reference_solution(const Problem &problem)
  {
    const unsigned int n_points = problem.face.points.size();
    FullMatrix<double> inverse(problem.A);
    inverse.gauss_jordan();
    const auto displacement = [&](const std::vector<Tensor<1, 2>> &lambda) {
      Vector<double> right_side(problem.load), u(problem.size());
      right_side -= problem.force(lambda);
      inverse.vmult(u, right_side);
      return u;
    };

    // Compute the dual matrix by entries, so that iterations are cheap.
    const unsigned int        m = 2 * n_points;
    std::vector<Tensor<1, 2>> lambda(n_points);
    const auto                free_slips = problem.slips(displacement(lambda));
    std::vector<double>       C(m * m), q(m);
    for (unsigned int j = 0; j < m; ++j)
      {
        q[j] = free_slips[j / 2][j % 2] -
               (problem.face.points[j / 2].is_obstacle && j % 2 == 0 ?
                  problem.bounds[j / 2] :
                  0.);
        lambda[j / 2][j % 2] = 1.;
        const auto slips     = problem.slips(displacement(lambda));
        for (unsigned int i = 0; i < m; ++i)
          C[i * m + j] = free_slips[i / 2][i % 2] - slips[i / 2][i % 2];
        lambda[j / 2][j % 2] = 0.;
      }
    double largest = 0.; // row sum norm
    for (unsigned int i = 0; i < m; ++i)
      {
        double sum = 0.;
        for (unsigned int j = 0; j < m; ++j)
          sum += std::abs(C[i * m + j]);
        largest = std::max(largest, sum);
      }

    std::vector<Tensor<1, 2>> extrapolated(lambda), old(lambda);
    double                    momentum = 1.;
    for (unsigned int iteration = 0; iteration < 200000; ++iteration)
      {
        old           = lambda;
        double change = 0., size = 0., uphill = 0.;
        for (unsigned int c = 0; c < n_points; ++c)
          {
            Tensor<1, 2> gradient;
            for (unsigned int a = 0; a < 2; ++a)
              {
                gradient[a] = -q[2 * c + a];
                for (unsigned int j = 0; j < m; ++j)
                  gradient[a] +=
                    C[(2 * c + a) * m + j] * extrapolated[j / 2][j % 2];
              }
            lambda[c] = extrapolated[c] - gradient / largest;
            if (problem.face.points[c].is_obstacle)
              lambda[c][0] = std::max(0., lambda[c][0]);
            else
              lambda[c] = clip(lambda[c], problem.bounds[c]);
            uphill += (extrapolated[c] - lambda[c]) * (lambda[c] - old[c]);
            change = std::max(change, (lambda[c] - extrapolated[c]).norm());
            size   = std::max(size, lambda[c].norm());
          }
        if (change <= 1e-15 * size)
          break;
        const double next =
          uphill > 0. ? 1. :
                        0.5 * (1. + std::sqrt(1. + 4. * momentum * momentum));
        const double beta = uphill > 0. ? 0. : (momentum - 1.) / next;
        momentum          = next;
        for (unsigned int c = 0; c < n_points; ++c)
          extrapolated[c] = lambda[c] + beta * (lambda[c] - old[c]);
      }
    return {displacement(lambda), lambda};
  }
} // namespace Viscoplastic::Testing
