// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/krylov_solver.h>
#include <viscoplastic_contact/linear_solvers/residual_rounding.h>

#include <cmath>
#include <optional>
#include <utility>

namespace Viscoplastic
{
  /// A solve in progress, with its vectors.
  class KrylovSolver::Solve : public ContactSolve
  {
  public:
    Solve(const KrylovSolver      &solver,
          const DistributedVector &load,
          DistributedVector       &u,
          const SolutionScale     &scale)
      : ContactSolve(solver.sparse_face_matrix.get(), false, scale)
      , solver(solver)
      , load(load)
      , u(u)
      , residual(solver.matrix.locally_owned_range_indices(),
                 solver.matrix.get_mpi_communicator())
      , w(residual)
      , product(residual)
      , first(residual)
      , direction(residual)
      , image(residual)
    {
      compute_residual();
    }

    Vector<double>
    face_residual() const override
    {
      return solver.restriction.gather(residual);
    }

    void
    move_face(const Vector<double> &change) override
    {
      if (!any_moves(change))
        return;
      first_is_truncated.reset();
      const FaceRestriction &restriction = solver.restriction;
      // As in take_step(), with K w from the change of the residual.
      Vector<double> terms = restriction.gather(load);
      add(1., restriction.gather(load), terms);
      add(-1., restriction.gather(residual), terms);
      subtract_face_product(change, residual);
      add(-1., restriction.gather(residual), terms);
      restrict_to_unknowns(residual);
      squared_norm += solver.face.dot(change, terms);
      restriction.add(1., change, u);
    }

    void
    set_truncation(const FaceTruncation &truncation_,
                   const bool            may_rebuild) override
    {
      first_is_truncated.reset();
      truncation  = truncation_;
      has_springs = truncation.has_springs(solver.face);
      solver.preconditioner->set_truncation(truncation, may_rebuild);
    }

    double
    dual_norm(const Vector<double> &force) override
    {
      // Without truncation: residuals on sticking components are errors, too.
      set_product(force);
      return norm_by_preconditioner(false);
    }

    double
    truncated_dual_norm(const Vector<double> &force) override
    {
      set_right_side(force);
      return norm_by_preconditioner(true);
    }

    double
    confirmed_dual_norm(const Vector<double> &force,
                        const double          limit,
                        unsigned int         &iterations) override
    {
      if (first_is_truncated != false) // otherwise dual_norm() has set it
        set_product(force);
      return dual_norm_of_product(limit, iterations);
    }

    double
    rounding_of_residual() override
    {
      return Viscoplastic::rounding_of_residual(
        solver.matrix, load, u, [&](const DistributedVector &error) {
          product = error;
          restrict_to_unknowns(product);
          first_is_truncated.reset();
          unsigned int iterations = 0;
          return Utilities::fixed_power<2>(
            dual_norm_of_product(std::numeric_limits<double>::infinity(),
                                 iterations));
        });
    }

    double
    energy_norm() const override
    {
      // For a translation, this is rounding of either sign.
      return std::sqrt(std::max(0., squared_norm));
    }

    unsigned int
    correct(const Vector<double> &force,
            const double          tolerance,
            Vector<double>       &face_part) override;

    SearchTerms
    search_terms(const Vector<double> &face_part) override
    {
      Vector<double> less = solver.restriction.gather(w);
      add(-1., face_part, less);
      if (any_moves(less))
        {
          solver.restriction.set(face_part, w);
          subtract_face_product(less, product);
        }
      slope     = residual * w;
      curvature = product * w;
      return {slope, curvature, solver.restriction.gather(product)};
    }

    void
    take_step(const double step) override
    {
      first_is_truncated.reset();
      // K w = product and K u = load - residual, except for excluded
      // components, where w is zero.
      squared_norm += step * (2. * (w * load - slope) + step * curvature);
      u.add(step, w);
      restrict_to_unknowns(product);
      residual.add(-step, product);
    }

  private:
    struct Operator;
    struct Inverse;

    /// Set entries of excluded components to zero.
    void
    restrict_to_unknowns(DistributedVector &v) const
    {
      double *entry = v.begin();
      for (const std::size_t i : solver.excluded_entries)
        entry[i] = 0.;
    }

    /// Compute the residual and the norm of u with the matrix.
    void
    compute_residual()
    {
      solver.matrix.vmult(residual, u);
      squared_norm = u * residual;
      residual.sadd(-1., 1., load);
      restrict_to_unknowns(residual);
      first_is_truncated.reset();
    }

    /// Set product to the residual without a face's force.
    void
    set_product(const Vector<double> &force)
    {
      product = residual;
      solver.restriction.add(-1., force, product);
    }

    /// Set product to the right-hand side of correct().
    void
    set_right_side(const Vector<double> &force)
    {
      set_product(force);
      solver.restriction.tilt_equations(truncation, product);
      solver.restriction.project(truncation, product);
    }

    /// y := y + factor x, also on ranks without a face, where vectors are
    /// empty.
    static void
    add(const double factor, const Vector<double> &x, Vector<double> &y)
    {
      if (y.size() > 0)
        y.add(factor, x);
    }

    /// Whether a face vector is not zero. Collective.
    bool
    any_moves(const Vector<double> &x) const
    {
      return solver.face.any(x.size() > 0 && x.linfty_norm() > 0.);
    }

    /// v := v - K R^T x for a face vector x; changes `direction`. Collective.
    void
    subtract_face_product(const Vector<double> &x, DistributedVector &v)
    {
      // Nodes of the face may have unknowns that are none of the face.
      const unsigned int dim = solver.matrix.block_size();
      for (const unsigned int i : solver.restriction.positions())
        std::fill_n(direction.begin() + i / dim * dim, dim, 0.);
      solver.restriction.add(-1., x, direction);
      solver.matrix.vmult_add(v, direction, solver.face_blocks);
    }

    /// Iterations, last over first residual, and x . K x of a solution x.
    struct End
    {
      unsigned int iterations = 0;
      double       reduction = 1., square = 0.;
    };

    /// Conjugate gradients from x = 0 for the residual @p r, which is `product`
    /// if `first` is its preconditioned residual, until x . K x is above @p
    /// limit. If @p response is not null, x is added to w, and K x on the face
    /// to it.
    End
    iterate(const Operator    &system,
            const Inverse     &inverse,
            DistributedVector &r,
            const double       tolerance,
            const unsigned int max_iterations,
            const double       limit,
            Vector<double>    *response = nullptr);

    /// Return (product . M^-1 product)^{1/2}.
    double
    norm_by_preconditioner(const bool is_truncated);

    /// Return the dual norm of product, independently of the quality of the
    /// preconditioner, or a lower bound above @p limit.
    double
    dual_norm_of_product(const double limit, unsigned int &iterations);

    const KrylovSolver      &solver;
    const DistributedVector &load;
    DistributedVector       &u;
    /// The residual of u, a correction and K times it.
    DistributedVector residual, w, product;
    /// The result of the preconditioner for product, with or without
    /// truncation, with which conjugate gradients begin.
    DistributedVector first;
    /// The search direction of conjugate gradients, and the system times it.
    DistributedVector   direction, image;
    std::optional<bool> first_is_truncated;
    FaceTruncation      truncation;
    bool                has_springs  = false;
    double              squared_norm = 0.;
    /// The terms of the line search along w.
    double slope = 0., curvature = 0.;
  };



  /// P (K + springs) P on the truncated space, or K on all unknowns.
  struct KrylovSolver::Solve::Operator
  {
    const Solve &solve;
    const bool   is_truncated;
    /// K x on the face, of the last product.
    mutable Vector<double> on_face = {};

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      if (is_truncated && solve.truncation.transposed)
        {
          DistributedVector motion(x);
          solve.solver.restriction.tilt_motions(solve.truncation, motion);
          solve.solver.matrix.vmult(y, motion);
        }
      else
        solve.solver.matrix.vmult(y, x);
      const FaceRestriction &restriction = solve.solver.restriction;
      if (is_truncated)
        {
          on_face = restriction.gather(y);
          restriction.tilt_equations(solve.truncation, y);
          if (solve.has_springs)
            restriction.add_springs(solve.truncation, x, y);
        }
      solve.restrict_to_unknowns(y);
      if (is_truncated)
        restriction.project(solve.truncation, y);
    }
  };



  /// P M^{-1} P on the truncated space, or M^{-1} on all unknowns.
  struct KrylovSolver::Solve::Inverse
  {
    const Solve &solve;
    const bool   is_truncated;
    const bool   is_whole = false;

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      if (is_whole)
        solve.solver.preconditioner->vmult_whole(y, x);
      else if (is_truncated)
        solve.solver.preconditioner->vmult(y, x);
      else
        solve.solver.preconditioner->vmult_untruncated(y, x);
      solve.restrict_to_unknowns(y);
      if (is_truncated)
        solve.solver.restriction.project(solve.truncation, y);
    }
  };
} // namespace Viscoplastic
