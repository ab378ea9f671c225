// SPDX-License-Identifier: LGPL-2.1-or-later

// The solver of frictional contact against slow, sure methods: a grid search
// for one point; projected gradients on the dual for small convex problems.

#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>

#include "body.h"
#include <viscoplastic_contact/contact_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using Testing::expect_refusal;

  constexpr double infinity = std::numeric_limits<double>::infinity();

  /// Reproducible on every platform, unlike the standard's distributions.
  class Random
  {
  public:
    explicit Random(const unsigned int seed)
      : generator(seed)
    {}

    double
    uniform(const double from = -1., const double to = 1.)
    {
      return from + (to - from) * (generator() / 4294967296.);
    }

    unsigned int
    integer(const unsigned int from, const unsigned int to)
    {
      return from + generator() % (to - from + 1);
    }

    /// Spread over orders of magnitude.
    double
    logarithmic(const double from, const double to)
    {
      return from * std::pow(to / from, uniform(0., 1.));
    }

  private:
    std::mt19937 generator;
  };



  Tensor<1, 2>
  clip(const Tensor<1, 2> &multiplier, const double bound)
  {
    const double size = multiplier.norm();
    return size <= bound ? multiplier : multiplier * (bound / size);
  }



  // ---------------------------------------------------------- single points

  /// 1/2 lambda . C lambda - q . lambda.
  double
  dual_energy(const Tensor<2, 2> &C,
              const Tensor<1, 2> &q,
              const Tensor<1, 2> &multiplier)
  {
    return 0.5 * (multiplier * (C * multiplier)) - q * multiplier;
  }



  /// The minimiser on the circle of radius bound, by a grid that zooms in.
  Tensor<1, 2>
  best_on_circle(const Tensor<2, 2> &C,
                 const Tensor<1, 2> &q,
                 const double        bound)
  {
    const auto at = [bound](const double angle) {
      Tensor<1, 2> result;
      result[0] = bound * std::cos(angle);
      result[1] = bound * std::sin(angle);
      return result;
    };
    double best = 0., width = numbers::PI;
    for (unsigned int zoom = 0; zoom < 12; ++zoom)
      {
        const double centre = best;
        double       lowest = std::numeric_limits<double>::max();
        const int    n      = zoom == 0 ? 2000 : 20;
        for (int i = -n; i <= n; ++i)
          {
            const double angle  = centre + width * i / n;
            const double energy = dual_energy(C, q, at(angle));
            if (energy < lowest)
              {
                lowest = energy;
                best   = angle;
              }
          }
        width *= zoom == 0 ? 2. / n : 0.2;
      }
    return at(best);
  }



  TEST(FrictionPoint, TwoTangentsAgainstAGridSearch)
  {
    Random       random(1);
    unsigned int n_slipping = 0;
    for (unsigned int trial = 0; trial < 300; ++trial)
      {
        // Flexibilities with condition numbers up to 1e6.
        const double a     = random.logarithmic(1e-3, 1e3);
        const double b     = random.logarithmic(1e-3, 1e3);
        const double angle = random.uniform(0., 3.);
        const double c = std::cos(angle), s = std::sin(angle);
        Tensor<2, 2> C;
        C[0][0] = a * c * c + b * s * s;
        C[1][1] = a * s * s + b * c * c;
        C[0][1] = C[1][0] = (a - b) * c * s;
        Tensor<1, 2> q;
        q[0] = random.uniform();
        q[1] = random.uniform();

        const Tensor<1, 2>  stick = invert(C) * q;
        const double        bound = stick.norm() * random.logarithmic(1e-8, 3.);
        const PointSolution solution = solve_friction_point(C, q, 2, bound);
        ASSERT_EQ(solution.sticks, stick.norm() <= bound);
        if (solution.sticks)
          {
            EXPECT_LT((solution.multiplier - stick).norm(),
                      1e-9 * stick.norm());
            continue;
          }
        ++n_slipping;
        const Tensor<1, 2> slip = q - C * solution.multiplier;
        EXPECT_NEAR(solution.multiplier.norm() / bound, 1., 1e-14);
        EXPECT_GT(slip * solution.multiplier, 0.);
        // The slip may be as small as rounding in q - C lambda.
        const double rounding = 1e-15 * (q.norm() + C.norm() * bound);
        EXPECT_LT((slip - slip.norm() * solution.multiplier / bound).norm(),
                  1e-8 * slip.norm() + 100. * rounding)
          << "trial " << trial;
        const Tensor<1, 2> grid   = best_on_circle(C, q, bound);
        const double       energy = dual_energy(C, q, solution.multiplier);
        EXPECT_LE(energy,
                  dual_energy(C, q, grid) + 1e-12 * std::abs(energy) +
                    rounding * bound)
          << "trial " << trial;
      }
    EXPECT_GT(n_slipping, 100u);
  }



  TEST(FrictionPoint, OneTangent)
  {
    Random random(2);
    for (unsigned int trial = 0; trial < 100; ++trial)
      {
        Tensor<2, 2> C;
        C[0][0] = random.logarithmic(1e-6, 1e6);
        Tensor<1, 2> q;
        q[0]                         = random.uniform();
        const double        stick    = q[0] / C[0][0];
        const double        bound    = random.uniform(0., 2.) * std::abs(stick);
        const PointSolution solution = solve_friction_point(C, q, 1, bound);
        EXPECT_EQ(solution.sticks, std::abs(stick) <= bound);
        EXPECT_DOUBLE_EQ(solution.multiplier[0],
                         std::max(-bound, std::min(bound, stick)));
        EXPECT_EQ(solution.multiplier[1], 0.);
      }
  }



  TEST(FrictionPoint, ZeroAndInfiniteBounds)
  {
    Tensor<2, 2> C;
    C[0][0] = 2.;
    C[1][1] = 3.;
    C[0][1] = C[1][0] = 1.;
    Tensor<1, 2> q;
    q[0] = 1.;
    q[1] = -4.;
    for (const unsigned int n_tangents : {1, 2})
      {
        const PointSolution free = solve_friction_point(C, q, n_tangents, 0.);
        EXPECT_EQ(free.multiplier.norm(), 0.);
        EXPECT_FALSE(free.sticks);
        const PointSolution glued =
          solve_friction_point(C, q, n_tangents, infinity);
        EXPECT_TRUE(glued.sticks);
        EXPECT_NEAR((C * glued.multiplier)[0], q[0], 1e-14);
        const PointSolution unloaded =
          solve_friction_point(C, Tensor<1, 2>(), n_tangents, 1.);
        EXPECT_TRUE(unloaded.sticks);
        EXPECT_EQ(unloaded.multiplier.norm(), 0.);
      }
  }



  // ------------------------------------------------- small convex problems

  /// J(u) = 1/2 u . A u - l . u + sum_c rho_c |s_c|. The unknowns of the face
  /// are the last ones.
  struct Problem
  {
    FullMatrix<double>  A;
    Vector<double>      load, u_prev;
    FrictionFace        face;
    std::vector<double> bounds;

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

    void
    add_node(const unsigned int                            n_dofs,
             const std::vector<std::vector<Tensor<1, 3>>> &planes)
    {
      for (const auto &rows : planes)
        {
          FrictionFace::Point point;
          point.node       = face.n_nodes();
          point.n_tangents = rows.size();
          std::copy(rows.begin(), rows.end(), point.map.begin());
          face.points.push_back(point);
        }
      face.first_dof.push_back(face.first_dof.back() + n_dofs);
      face.first_point.push_back(face.points.size());
    }
  };



  Vector<double>
  solve_dense(FullMatrix<double> matrix, const Vector<double> &right_side)
  {
    matrix.gauss_jordan();
    Vector<double> result(right_side.size());
    matrix.vmult(result, right_side);
    return result;
  }



  FullMatrix<double>
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



  Tensor<1, 3>
  vector(const double x, const double y, const double z = 0.)
  {
    Tensor<1, 3> v;
    v[0] = x;
    v[1] = y;
    v[2] = z;
    return v;
  }



  /// Orthonormal rows in the first n components.
  std::vector<Tensor<1, 3>>
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



  /// Nodes with bilateral contact (as many components as tangents) and with
  /// given normal stress (one more).
  Problem
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
    const unsigned int n = random.integer(2, 6) + problem.face.n_dofs();
    problem.A            = random_matrix(random, n);
    problem.load.reinit(n);
    problem.u_prev.reinit(n);
    for (unsigned int i = 0; i < n; ++i)
      {
        problem.load[i]   = random.uniform();
        problem.u_prev[i] = random.uniform(-0.3, 0.3);
      }
    for (unsigned int c = 0; c < problem.face.points.size(); ++c)
      problem.bounds.push_back(random.uniform(0., 1.5));
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
   * to rounding.
   */
  Solution
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

    // The dual matrix, entry by entry, for cheap iterations.
    const unsigned int        m = 2 * n_points;
    std::vector<Tensor<1, 2>> lambda(n_points);
    const auto                free_slips = problem.slips(displacement(lambda));
    std::vector<double>       C(m * m), q(m);
    for (unsigned int j = 0; j < m; ++j)
      {
        q[j]                 = free_slips[j / 2][j % 2];
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
            lambda[c] =
              clip(extrapolated[c] - gradient / largest, problem.bounds[c]);
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



  /**
   * A dense stand-in for the bulk. Condensed, it behaves like a direct solver:
   * the bulk follows the face at once. Frozen, it behaves like an iterative
   * one: the face matrix is that of a bulk at rest, and corrections are only as
   * accurate as asked for.
   */
  class DenseBulk : public BulkSolver
  {
  public:
    DenseBulk(const Problem &problem, const bool condensed)
      : u(problem.u_prev)
      , problem(problem)
      , condensed(condensed)
      , inverse(problem.A)
      , w(problem.size())
    {
      inverse.gauss_jordan();
      const unsigned int first = problem.first(), n = problem.face.n_dofs();
      FullMatrix<double> K(n, n);
      if (condensed)
        {
          // The Schur complement is the inverse of the inverse's block.
          for (unsigned int i = 0; i < n; ++i)
            for (unsigned int j = 0; j < n; ++j)
              K(i, j) = inverse(first + i, first + j);
          K.gauss_jordan();
        }
      else
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            K(i, j) = problem.A(first + i, first + j);
      matrix = std::make_unique<DenseFaceMatrix>(problem.face, std::move(K));
      relax_bulk();
    }

    Vector<double> u;

    /// Start from a displacement other than u_prev.
    void
    start_at(const Vector<double> &start)
    {
      u = start;
      relax_bulk();
    }

    bool
    is_exact() const override
    {
      return true;
    }

    std::string
    name() const override
    {
      return "dense";
    }

    unsigned int
    solve(const DistributedVector &, DistributedVector &, const double) override
    {
      ADD_FAILURE() << "The contact solver has no business here.";
      return 0;
    }

    void
    begin(const DistributedVector &, DistributedVector &) override
    {
      ADD_FAILURE() << "The contact solver has no business here.";
    }

    const FaceMatrix &
    face_matrix() const override
    {
      return *matrix;
    }

    void
    face_residual(Vector<double> &r) override
    {
      r = problem.on_face(problem.residual(u));
    }

    void
    move_face(const Vector<double> &change) override
    {
      for (unsigned int i = 0; i < change.size(); ++i)
        u[problem.first() + i] += change[i];
      relax_bulk();
    }

    void
    set_truncation(const FaceTruncation &truncation_,
                   const bool /*may_rebuild*/) override
    {
      truncation = truncation_;
    }

    double
    dual_norm(const Vector<double> &force) override
    {
      return std::sqrt(inverse.matrix_norm_square(unbalanced(force)));
    }

    double
    confirmed_dual_norm(const Vector<double> &force,
                        unsigned int & /*iterations*/) override
    {
      return dual_norm(force);
    }

    double
    energy_norm() const override
    {
      return problem.energy_norm(u);
    }

    unsigned int
    correct(const Vector<double> &force,
            const double          tolerance,
            Vector<double>       &face_part) override
    {
      Vector<double> r = unbalanced(force);
      project(r);
      w         = 0.;
      face_part = 0.;
      if (r.l2_norm() == 0.)
        return 0;
      struct Truncated
      {
        const DenseBulk &bulk;
        void
        vmult(Vector<double> &y, const Vector<double> &x) const
        {
          bulk.problem.A.vmult(y, x);
          const FrictionFace &face = bulk.problem.face;
          for (unsigned int n = 0; n < face.n_nodes(); ++n)
            for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
              for (unsigned int j = 0; j < face.n_node_dofs(n); ++j)
                y[bulk.problem.first() + face.first_dof[n] + i] +=
                  bulk.truncation.spring[n][i][j] *
                  x[bulk.problem.first() + face.first_dof[n] + j];
          bulk.project(y);
        }
      };
      // Springs tend to infinity where a point comes to rest.
      struct Diagonal
      {
        const DenseBulk &bulk;
        void
        vmult(Vector<double> &y, const Vector<double> &x) const
        {
          y                        = x;
          const FrictionFace &face = bulk.problem.face;
          for (unsigned int n = 0; n < face.n_nodes(); ++n)
            {
              Tensor<2, 3> block = Tensor<2, 3>(unit_symmetric_tensor<3>()) +
                                   bulk.truncation.spring[n];
              block = invert(block);
              for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
                {
                  const unsigned int at =
                    bulk.problem.first() + face.first_dof[n];
                  y[at + i] = 0.;
                  for (unsigned int j = 0; j < face.n_node_dofs(n); ++j)
                    y[at + i] += block[i][j] * x[at + j];
                }
            }
          bulk.project(y);
        }
      };
      ReductionControl         control(1000, 0., condensed ? 1e-13 : tolerance);
      SolverCG<Vector<double>> cg(control);
      try
        {
          cg.solve(Truncated{*this}, w, r, Diagonal{*this});
        }
      catch (const SolverControl::NoConvergence &)
        {
          // As good as rounding lets it be.
        }
      face_part = problem.on_face(w);
      return control.last_step();
    }

    SearchTerms
    search_terms(const Vector<double> &face_part) override
    {
      for (unsigned int i = 0; i < face_part.size(); ++i)
        w[problem.first() + i] = face_part[i];
      if (condensed)
        {
          const Vector<double> start(u);
          u += w;
          relax_bulk();
          w = u;
          w -= start;
          u = start;
        }
      return {problem.residual(u) * w, problem.A.matrix_norm_square(w)};
    }

    void
    take_step(const double step) override
    {
      u.add(step, w);
    }

    unsigned int
    finish() override
    {
      is_finished = true;
      return 0;
    }

    bool is_finished = false;

  private:
    Vector<double>
    unbalanced(const Vector<double> &force) const
    {
      Vector<double> r = problem.residual(u);
      for (unsigned int i = 0; i < force.size(); ++i)
        r[problem.first() + i] -= force[i];
      return r;
    }

    void
    project(Vector<double> &v) const
    {
      Vector<double> c = problem.on_face(v);
      truncation.project(problem.face, c);
      for (unsigned int i = 0; i < c.size(); ++i)
        v[problem.first() + i] = c[i];
    }

    /// Solve for the unknowns off the face.
    void
    relax_bulk()
    {
      const unsigned int n = problem.first();
      if (!condensed || n == 0)
        return;
      FullMatrix<double> K(n, n);
      Vector<double>     r(n);
      const auto         residual = problem.residual(u);
      for (unsigned int i = 0; i < n; ++i)
        {
          r[i] = residual[i];
          for (unsigned int j = 0; j < n; ++j)
            K(i, j) = problem.A(i, j);
        }
      const Vector<double> change = solve_dense(K, r);
      for (unsigned int i = 0; i < n; ++i)
        u[i] += change[i];
    }

    const Problem                   &problem;
    const bool                       condensed;
    FullMatrix<double>               inverse;
    std::unique_ptr<DenseFaceMatrix> matrix;
    FaceTruncation                   truncation;
    Vector<double>                   w;
  };



  struct Result
  {
    Vector<double> u;
    FrictionState  state;
    ContactReport  report;
  };



  Result
  solve(const Problem        &problem,
        const bool            condensed,
        const double          tolerance,
        FrictionState         state,
        const Vector<double> &start,
        const unsigned int    max_iterations = 60)
  {
    DenseBulk bulk(problem, condensed);
    bulk.start_at(start);
    Vector<double> increment(start);
    increment -= problem.u_prev;
    increment = problem.on_face(increment);
    const ContactReport report =
      ContactSolver(max_iterations)
        .solve(bulk, problem.face, problem.bounds, tolerance, increment, state);
    EXPECT_TRUE(bulk.is_finished);
    // The increment returned is that of the displacement.
    Vector<double> change(bulk.u);
    change -= problem.u_prev;
    change = problem.on_face(change);
    change -= increment;
    EXPECT_LT(change.l2_norm(), 1e-12 * (1. + increment.l2_norm()));
    return {bulk.u, state, report};
  }



  Result
  solve(const Problem &problem, const bool condensed, const double tolerance)
  {
    return solve(problem,
                 condensed,
                 tolerance,
                 FrictionState(problem.face.points.size()),
                 problem.u_prev);
  }



  /// J(u) minus the dual energy of the multipliers: no less than half the
  /// squared energy error.
  double
  duality_gap(const Problem &problem, const Result &result)
  {
    Vector<double> unbalanced = problem.residual(result.u);
    unbalanced -= problem.force(result.state.multiplier);
    double     gap   = 0.5 * (unbalanced * solve_dense(problem.A, unbalanced));
    const auto slips = problem.slips(result.u);
    for (unsigned int c = 0; c < slips.size(); ++c)
      if (slips[c].norm() > 1e-14) // infinite bounds
        gap += problem.bounds[c] * slips[c].norm() -
               result.state.multiplier[c] * slips[c];
    return gap;
  }



  /// The friction law, point by point, and the bound of the error.
  void
  expect_solution(const Problem  &problem,
                  const Result   &result,
                  const Solution &reference,
                  const double    tolerance)
  {
    Vector<double> error(result.u);
    error -= reference.u;
    const double size = problem.energy_norm(reference.u);
    EXPECT_LE(result.report.relative_error, tolerance);
    EXPECT_LE(problem.energy_norm(error), tolerance * size * 1.01 + 1e-12);
    EXPECT_LE(problem.energy_norm(error),
              std::sqrt(2. * result.report.duality_gap) * 1.01 + 1e-12);

    const auto   slips      = problem.slips(result.u);
    const double slip_scale = problem.on_face(result.u).linfty_norm() +
                              problem.on_face(problem.u_prev).linfty_norm();
    for (unsigned int c = 0; c < slips.size(); ++c)
      {
        const double       bound  = problem.bounds[c];
        const Tensor<1, 2> lambda = result.state.multiplier[c];
        EXPECT_LE(lambda.norm(), bound * (1. + 1e-14));
        EXPECT_LT((slips[c] - result.state.slip[c]).norm(), 1e-13 * slip_scale);
        if (result.state.sticks[c])
          {
            EXPECT_EQ(result.state.slip[c].norm(), 0.);
          }
        else if (bound > 0.)
          {
            const Tensor<1, 2> s = result.state.slip[c];
            EXPECT_GT(s.norm(), 0.);
            // Rounding blurs the direction of a slip that has hardly begun;
            // the solver then certifies with the residual instead.
            const bool is_blurred = s.norm() < 1e-9 * result.u.linfty_norm();
            EXPECT_LE((lambda - bound * s / s.norm()).norm(),
                      (is_blurred ? 1e-5 : 1e-13) * bound);
          }
        else
          {
            EXPECT_EQ(lambda.norm(), 0.);
          }
      }
    // Multipliers may not be unique, but their forces are.
    Vector<double> force = problem.force(result.state.multiplier);
    force -= problem.force(reference.multipliers);
    EXPECT_LT(force.l2_norm(),
              20. * tolerance * (problem.load.l2_norm() + 1.) + 1e-10);
  }



  void
  count_sets(const Result &result, unsigned int &n_stick, unsigned int &n_slip)
  {
    for (const bool sticks : result.state.sticks)
      ++(sticks ? n_stick : n_slip);
  }



  TEST(ContactSolver, RandomProblems)
  {
    constexpr double tolerance = 1e-9;
    for (const unsigned int n_tangents : {1, 2})
      {
        unsigned int n_stick = 0, n_slip = 0, n_iterations = 0;
        for (unsigned int seed = 0; seed < 40; ++seed)
          {
            const Problem  problem   = random_problem(seed, n_tangents);
            const Solution reference = reference_solution(problem);
            for (const bool condensed : {true, false})
              {
                SCOPED_TRACE("seed " + std::to_string(seed) + ", tangents " +
                             std::to_string(n_tangents) +
                             (condensed ? ", condensed" : ", frozen bulk"));
                const Result result = solve(problem, condensed, tolerance);
                expect_solution(problem, result, reference, tolerance);
                count_sets(result, n_stick, n_slip);
                n_iterations += result.report.iterations;
              }
          }
        // Both kinds of points occur, and the iteration is a Newton method.
        EXPECT_GT(n_stick, 50u);
        EXPECT_GT(n_slip, 50u);
        EXPECT_LT(n_iterations / 80., n_tangents == 1 ? 3. : 6.);
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



  /// A ring of nodes that are all alike.
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
            // The stick force is the load, up to rounding below.
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

              // The load turns round; start as if the slip went on.
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
    const double       c         = std::cos(degrees * numbers::PI / 180.);
    const double       s         = std::sin(degrees * numbers::PI / 180.);
    for (unsigned int n = 0; n < n_corners; ++n)
      {
        if (dim == 2)
          problem.add_node(2, {{vector(1, 0)}, {vector(c, s)}});
        else
          problem.add_node(3,
                           {{vector(1, 0, 0), vector(0, 0, 1)},
                            {vector(c, s, 0), vector(0, 0, 1)}});
      }
    for (unsigned int n = 0; n < 3; ++n)
      problem.add_node(dim, {random_rows(random, dim - 1, dim)});
    const unsigned int n = 3 + problem.face.n_dofs();
    problem.A            = random_matrix(random, n);
    problem.load.reinit(n);
    problem.u_prev.reinit(n);
    for (unsigned int i = 0; i < n; ++i)
      {
        problem.load[i]   = random.uniform();
        problem.u_prev[i] = random.uniform(-0.3, 0.3);
      }
    for (unsigned int p = 0; p < problem.face.points.size(); ++p)
      problem.bounds.push_back(random.uniform(0.05, 1.));
    return problem;
  }



  TEST(ContactSolver, TwoPlanesAtANode)
  {
    constexpr double tolerance = 1e-9;
    for (const unsigned int dim : {2, 3})
      {
        unsigned int n_stick = 0, n_slip = 0;
        for (const double degrees : {90., 60., 30., 150., 120.})
          for (unsigned int seed = 500; seed < 512; ++seed)
            {
              const Problem  problem   = corner_problem(seed, dim, degrees);
              const Solution reference = reference_solution(problem);
              for (const bool condensed : {true, false})
                {
                  SCOPED_TRACE("dim " + std::to_string(dim) + ", seed " +
                               std::to_string(seed) + ", degrees " +
                               std::to_string(degrees) +
                               (condensed ? ", condensed" : ", frozen bulk"));
                  const Result result = solve(problem, condensed, tolerance);
                  expect_solution(problem, result, reference, tolerance);
                  count_sets(result, n_stick, n_slip);
                }
            }
        EXPECT_GT(n_stick, 50u);
        EXPECT_GT(n_slip, 50u);
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
              // Two planes hold all components of a node.
              const auto slips = problem.slips(result.u);
              for (unsigned int p = 0; p < slips.size(); ++p)
                {
                  EXPECT_TRUE(result.state.sticks[p]);
                  EXPECT_LT(slips[p].norm(), 1e-12);
                }
              // Equilibrium.
              Vector<double> unbalanced = problem.residual(result.u);
              unbalanced -= problem.force(result.state.multiplier);
              EXPECT_LT(unbalanced.l2_norm(), 1e-7);
            }
  }



  TEST(ContactSolver, MultipliersOfLeastNormWhereTheyAreNotUnique)
  {
    // At a node with two planes in 3D, four multiplier components make three
    // forces: along the edge, shares are free.
    Random random(700);
    for (const double degrees : {90., 30., 150.})
      for (unsigned int trial = 0; trial < 40; ++trial)
        {
          SCOPED_TRACE("degrees " + std::to_string(degrees) + ", trial " +
                       std::to_string(trial));
          Problem      problem;
          const double c = std::cos(degrees * numbers::PI / 180.);
          const double s = std::sin(degrees * numbers::PI / 180.);
          problem.add_node(3,
                           {{vector(1, 0, 0), vector(0, 0, 1)},
                            {vector(c, s, 0), vector(0, 0, 1)}});
          // A residual that bounds allow: the force of known multipliers.
          // Half of the trials without clipping.
          problem.bounds = {1., 1.};
          if (trial % 2 == 1)
            problem.bounds = {random.uniform(0.3, 1.), random.uniform(0.3, 1.)};
          std::vector<Tensor<1, 2>> known(2);
          for (unsigned int p = 0; p < 2; ++p)
            {
              for (unsigned int i = 0; i < 2; ++i)
                known[p][i] = random.uniform();
              const double share =
                trial % 2 == 1 ? random.uniform(0.5, 1.) : 0.2;
              known[p] *= share * problem.bounds[p] / known[p].norm();
            }
          Vector<double> residual(3), force(3);
          for (unsigned int p = 0; p < 2; ++p)
            {
              const Tensor<1, 3> f =
                node_force(problem.face.points[p], known[p]);
              for (unsigned int i = 0; i < 3; ++i)
                residual[i] += f[i];
            }
          FrictionState state(2);
          fit_multipliers(problem.face, problem.bounds, residual, state, force);
          force -= residual;
          EXPECT_LT(force.l2_norm(), 1e-9);

          // Move along the null space of the map from multipliers to forces:
          // (0, t) at one plane, (0, -t) at the other.
          double best = std::numeric_limits<double>::max();
          for (int i = -20000; i <= 20000; ++i)
            {
              auto moved = known;
              moved[0][1] += 1e-4 * i;
              moved[1][1] -= 1e-4 * i;
              if (moved[0].norm() <= problem.bounds[0] * (1. + 1e-9) &&
                  moved[1].norm() <= problem.bounds[1] * (1. + 1e-9))
                best =
                  std::min(best,
                           moved[0].norm_square() + moved[1].norm_square());
            }
          const double fitted = state.multiplier[0].norm_square() +
                                state.multiplier[1].norm_square();
          EXPECT_LE(state.multiplier[0].norm(),
                    problem.bounds[0] * (1 + 1e-14));
          EXPECT_LE(state.multiplier[1].norm(),
                    problem.bounds[1] * (1 + 1e-14));
          EXPECT_NEAR(fitted, best, 1e-3);
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
              solve(
                start, condensed, 1e-8, FrictionState(start.bounds.size()), u);
            },
            "not finite");
        }
  }



  TEST(ContactSolver, RefusesToReturnWhatDidNotConverge)
  {
    for (const unsigned int n_tangents : {1, 2})
      for (const unsigned int max_iterations : {0, 1})
        {
          // Loose linear solves: never done after one correction.
          const Problem problem = random_problem(810, n_tangents);
          expect_refusal(
            [&] {
              solve(problem,
                    false,
                    1e-12,
                    FrictionState(problem.bounds.size()),
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
