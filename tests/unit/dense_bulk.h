// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The contact solver with a dense substitute for the bulk solver.

#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>

#include "convex_problem.h"
#include <viscoplastic_contact/contact/contact_solver.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace Viscoplastic::Testing
{
  using namespace dealii;

  /**
   * A dense stand-in for the bulk. Condensed, it behaves like a direct solver:
   * the bulk follows the face at once. Frozen, it behaves like an iterative
   * one: the face matrix is that of a bulk at rest, and corrections are only as
   * accurate as asked for.
   */
  class DenseBulk : public ContactSolve
  {
  public:
    DenseBulk(const Problem &problem, const bool condensed)
      : DenseBulk(problem, condensed, make_face_matrix(problem, condensed))
    {}

    Vector<double> u;

    /// Start from a displacement other than u_prev.
    void
    start_at(const Vector<double> &start)
    {
      u = start;
      relax_bulk();
    }

    Vector<double>
    face_residual() const override
    {
      return problem.on_face(problem.residual(u));
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
      Vector<double> r = unbalanced(force);
      factor.solve(r);
      return r.l2_norm();
    }

    double
    rounding_of_residual() override
    {
      // Take the root mean square over random signs of rounding errors.
      double sum = 0.;
      for (unsigned int i = 0; i < u.size(); ++i)
        {
          Vector<double> error(u.size());
          error[i] = std::abs(problem.load[i]);
          for (unsigned int j = 0; j < u.size(); ++j)
            error[i] += std::abs(problem.A(i, j) * u[j]);
          factor.solve(error);
          sum += error.norm_sqr();
        }
      return std::numeric_limits<double>::epsilon() * std::sqrt(sum);
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
      tilt(r);
      project(r);
      w         = 0.;
      face_part = 0.;
      if (r.l2_norm() == 0.)
        return 0;
      const FullMatrix<double> matrix     = truncated_matrix();
      unsigned int             iterations = 0;
      if (!truncation.tilt.empty())
        {
          // The matrix is not symmetric.
          LAPACKFullMatrix<double> factor(problem.size());
          factor = matrix;
          factor.compute_lu_factorization();
          factor.solve(r);
          w = r;
        }
      else if (condensed)
        w = solve_dense(matrix, r);
      else
        {
          ReductionControl                       control(1000, 0., tolerance);
          SolverCG<Vector<double>>               cg(control);
          PreconditionJacobi<FullMatrix<double>> diagonal;
          diagonal.initialize(matrix);
          try
            {
              cg.solve(matrix, w, r, diagonal);
            }
          catch (const SolverControl::NoConvergence &)
            {
              // The result is as accurate as rounding allows.
            }
          iterations = control.last_step();
        }
      project(w);
      face_part = problem.on_face(w);
      return iterations;
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
      Vector<double> Aw(problem.size());
      problem.A.vmult(Aw, w);
      return {problem.residual(u) * w,
              problem.A.matrix_norm_square(w),
              problem.on_face(Aw)};
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

    bool
    has_negative_determinant() const override
    {
      LAPACKFullMatrix<double> system(problem.size());
      system = truncated_matrix();
      system.compute_lu_factorization();
      return system.determinant() < 0.;
    }

  private:
    DenseBulk(const Problem                   &problem,
              const bool                       condensed,
              std::unique_ptr<DenseFaceMatrix> face_matrix)
      : ContactSolve(face_matrix.get(), /* is_exact = */ true)
      , u(problem.u_prev)
      , problem(problem)
      , condensed(condensed)
      , factor(cholesky_factor(problem.A))
      , matrix(std::move(face_matrix))
      , w(problem.size())
    {
      relax_bulk();
    }

    static std::unique_ptr<DenseFaceMatrix>
    make_face_matrix(const Problem &problem, const bool condensed)
    {
      const unsigned int first = problem.first(), n = problem.face.n_dofs();
      FullMatrix<double> K(n, n);
      const auto         factor = cholesky_factor(problem.A);
      // The last block of the factor is that of the Schur complement.
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          if (condensed)
            for (unsigned int k = 0; k <= std::min(i, j); ++k)
              K(i, j) +=
                factor(first + i, first + k) * factor(first + j, first + k);
          else
            K(i, j) = problem.A(first + i, first + j);
      return std::make_unique<DenseFaceMatrix>(problem.face, std::move(K));
    }

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

    void
    tilt(Vector<double> &v) const
    {
      Vector<double> c = problem.on_face(v);
      truncation.tilt_equations(problem.face, c);
      for (unsigned int i = 0; i < c.size(); ++i)
        v[problem.first() + i] = c[i];
    }

    /// P (tilt A + springs) P + c (I - P), with c of the size of the matrix.
    FullMatrix<double>
    truncated_matrix() const
    {
      const ContactLayout &face = problem.face;
      FullMatrix<double>   result(problem.A);
      Vector<double>       row(problem.size());
      if (!truncation.tilt.empty())
        for (unsigned int j = 0; j < problem.size(); ++j)
          {
            for (unsigned int i = 0; i < problem.size(); ++i)
              row[i] = result(i, j);
            tilt(row);
            for (unsigned int i = 0; i < problem.size(); ++i)
              result(i, j) = row[i];
          }
      for (unsigned int n = 0; n < face.n_nodes(); ++n)
        {
          const unsigned int at = problem.first() + face.first_dof[n];
          for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
            for (unsigned int j = 0; j < face.n_node_dofs(n); ++j)
              result(at + i, at + j) += truncation.spring[n][i][j];
        }
      for (const bool columns : {true, false})
        for (unsigned int i = 0; i < problem.size(); ++i)
          {
            for (unsigned int j = 0; j < problem.size(); ++j)
              row[j] = columns ? result(i, j) : result(j, i);
            project(row);
            for (unsigned int j = 0; j < problem.size(); ++j)
              (columns ? result(i, j) : result(j, i)) = row[j];
          }
      for (unsigned int n = 0; n < face.n_nodes(); ++n)
        {
          const unsigned int at = problem.first() + face.first_dof[n];
          for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
            for (unsigned int j = 0; j < face.n_node_dofs(n); ++j)
              result(at + i, at + j) +=
                problem.A(at, at) *
                ((i == j ? 1. : 0.) - truncation.projector[n][i][j]);
        }
      return result;
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

    const Problem                         &problem;
    const bool                             condensed;
    const LAPACKFullMatrix<double>         factor;
    const std::unique_ptr<DenseFaceMatrix> matrix;
    FaceTruncation                         truncation;
    Vector<double>                         w;
  };



  struct Result
  {
    Vector<double> u;
    ContactState   state;
    ContactReport  report;
  };



  inline Result
  solve(const Problem        &problem,
        const bool            condensed,
        const double          tolerance,
        ContactState          state,
        const Vector<double> &start,
        const unsigned int    max_iterations = 60,
        const double          rounding_error = 0.)
  {
    DenseBulk bulk(problem, condensed);
    bulk.scale.rounding_error = rounding_error;
    bulk.start_at(start);
    Vector<double> increment(start);
    increment -= problem.u_prev;
    increment   = problem.on_face(increment);
    state.bound = problem.bounds;
    if (problem.foundation_step.size() > 0)
      state.foundation_step = problem.foundation_step;
    const ContactReport report =
      ContactSolver(max_iterations)
        .solve(bulk, problem.face, tolerance, increment, state);
    EXPECT_TRUE(bulk.is_finished);
    // The returned increment is that of the displacement on the face.
    Vector<double> change(bulk.u);
    change -= problem.u_prev;
    change = problem.on_face(change);
    change -= increment;
    EXPECT_LT(change.l2_norm(), 1e-12 * (1. + increment.l2_norm()));
    return {bulk.u, state, report};
  }



  inline Result
  solve(const Problem &problem, const bool condensed, const double tolerance)
  {
    return solve(problem,
                 condensed,
                 tolerance,
                 ContactState(problem.bounds),
                 problem.u_prev);
  }



  /// J(u) minus the dual energy of the multipliers, which is at least half of
  /// the squared energy error.
  inline double
  duality_gap(const Problem &problem, const Result &result)
  {
    Vector<double> unbalanced = problem.residual(result.u);
    unbalanced -= problem.force(result.state.multiplier);
    double     gap   = 0.5 * (unbalanced * solve_dense(problem.A, unbalanced));
    const auto slips = problem.slips(result.u);
    for (unsigned int c = 0; c < slips.size(); ++c)
      if (problem.face.points[c].is_obstacle)
        gap +=
          result.state.multiplier[c][0] * (problem.bounds[c] - slips[c][0]);
      else if (slips[c].norm() > 1e-14) // infinite bounds
        gap += problem.bounds[c] * slips[c].norm() -
               result.state.multiplier[c] * slips[c];
    return gap;
  }



  /// Check the friction law, point by point, and the error.
  inline void
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
        if (problem.face.points[c].is_obstacle)
          {
            const double left = bound - slips[c][0];
            EXPECT_GE(left, -1e-13 * slip_scale);
            EXPECT_GE(lambda[0], 0.);
            if (result.state.sticks[c])
              {
                EXPECT_LE(left, 1e-13 * slip_scale);
              }
            else
              {
                EXPECT_EQ(lambda[0], 0.);
              }
            continue;
          }
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
    // Multipliers may not be unique, but their forces are unique.
    Vector<double> force = problem.force(result.state.multiplier);
    force -= problem.force(reference.multipliers);
    EXPECT_LT(force.l2_norm(),
              20. * tolerance * (problem.load.l2_norm() + 1.) + 1e-10);
  }



  inline void
  count_sets(const Result &result, unsigned int &n_stick, unsigned int &n_slip)
  {
    for (const bool sticks : result.state.sticks)
      ++(sticks ? n_stick : n_slip);
  }
} // namespace Viscoplastic::Testing
