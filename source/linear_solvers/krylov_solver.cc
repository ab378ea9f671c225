// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/solver_gmres.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>
#include <viscoplastic_contact/linear_solvers/residual_rounding.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int max_cg_iterations = 5000;

    /// y := y + factor x, also on ranks without a face, where vectors are
    /// empty.
    void
    add(const double factor, const Vector<double> &x, Vector<double> &y)
    {
      if (y.size() > 0)
        y.add(factor, x);
    }
  } // namespace



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



  double
  KrylovSolver::Solve::norm_by_preconditioner(const bool is_truncated)
  {
    first_is_truncated.reset();
    Inverse{*this, is_truncated}.vmult(first, product);
    first_is_truncated = is_truncated;
    return std::sqrt(std::max(0., first * product));
  }



  KrylovSolver::Solve::End
  KrylovSolver::Solve::iterate(const Operator    &system,
                               const Inverse     &inverse,
                               DistributedVector &r,
                               const double       tolerance,
                               const unsigned int max_iterations,
                               const double       limit,
                               Vector<double>    *response)
  {
    End                end;
    const double       size = r.l2_norm();
    double             r_z  = 0.;
    DistributedVector &z    = first;
    // Written so that NaN ends it.
    while (end.reduction > tolerance && end.iterations < max_iterations &&
           !(end.square > limit))
      {
        if (std::exchange(first_is_truncated, {}) != inverse.is_truncated)
          inverse.vmult(z, r);
        const double old_r_z = std::exchange(r_z, r * z);
        if (end.iterations == 0)
          direction = z;
        else
          direction.sadd(r_z / old_r_z, 1., z);
        system.vmult(image, direction);
        const double alpha = r_z / (direction * image);
        if (response != nullptr)
          {
            w.add(alpha, direction);
            add(alpha, system.on_face, *response);
          }
        r.add(-alpha, image);
        ++end.iterations;
        end.reduction = r.l2_norm() / size;
        end.square += alpha * r_z;
      }
    return end;
  }



  unsigned int
  KrylovSolver::Solve::correct(const Vector<double> &force,
                               const double          tolerance,
                               Vector<double>       &face_part)
  {
    if (first_is_truncated !=
        true) // otherwise truncated_dual_norm() has set it
      set_right_side(force);
    w                 = 0.;
    face_part         = 0.;
    const double size = product.l2_norm();
    if (size == 0.)
      return 0;

    const Operator system{*this, true};
    const Inverse  inverse{*this, true};
    End            end;
    if (solver.face.any(!truncation.tilt.empty()))
      {
        ReductionControl control(max_cg_iterations, 0., tolerance);
        try
          {
            SolverGMRES<DistributedVector>(
              control,
              SolverGMRES<DistributedVector>::AdditionalData(
                /* max_n_tmp_vectors = */ 50,
                /* right_preconditioning = */ true))
              .solve(system, w, product, inverse);
          }
        catch (const SolverControl::NoConvergence &)
          {} // see below
        end = {control.last_step(), control.last_value() / size, 0.};
        solver.restriction.tilt_motions(truncation, w);
        solver.matrix.vmult(product, w);
      }
    else
      {
        Vector<double> response(face_part);
        end = iterate(system,
                      inverse,
                      product,
                      tolerance,
                      max_cg_iterations,
                      std::numeric_limits<double>::infinity(),
                      &response);
        // K w, off the face what it has taken of the residual.
        product.sadd(-1., 1., residual);
        solver.restriction.set(response, product);
      }
    if (!std::isfinite(end.reduction))
      refuse("The conjugate gradient method met a value that is not finite.");
    // A result short of the tolerance reduces the error, too: the next
    // correction starts from it.
    if (end.reduction > tolerance && !(end.reduction < 0.5))
      refuse("The conjugate gradient method does not converge; for nearly "
             "incompressible bodies and flat cells use the direct linear "
             "solver, on one rank.");
    face_part = solver.restriction.gather(w);
    solver.preconditioner->learn(end.iterations,
                                 -std::log10(std::max(end.reduction, 1e-16)));
    return end.iterations;
  }



  double
  KrylovSolver::Solve::dual_norm_of_product(const double  limit,
                                            unsigned int &iterations)
  {
    // A preconditioner for another stick set misjudges residuals on the face,
    // so solve K x = R on all unknowns: x . R is the squared norm minus the
    // squared error, and grows in each iteration. If this takes long, a
    // preconditioner set up for all unknowns pays; restarting with it makes the
    // result independent of restarts of the run.
    if (!(product.l2_norm() > 0.))
      return 0.;
    constexpr double   tolerance = 0.1;
    const unsigned int patience =
      std::min(solver.preconditioner->iterations_for_whole(),
               max_cg_iterations);
    for (const bool is_whole : {false, true})
      {
        w             = product;
        const End end = iterate(Operator{*this, false},
                                Inverse{*this, false, is_whole},
                                w,
                                tolerance,
                                is_whole ? max_cg_iterations : patience,
                                limit * limit);
        iterations += end.iterations;
        if (end.reduction <= tolerance || end.square > limit * limit)
          return std::sqrt(std::max(0., end.square));
        if (patience == max_cg_iterations)
          break;
      }
    return std::numeric_limits<double>::infinity();
  }



  KrylovSolver::KrylovSolver(const DistributedMatrix        &matrix,
                             const std::vector<bool>        &excluded,
                             const FaceRestriction          &restriction,
                             std::unique_ptr<Preconditioner> preconditioner_)
    : matrix(matrix)
    , excluded(excluded)
    , restriction(restriction)
    , face(restriction.face())
    , preconditioner(std::move(preconditioner_))
  {
    for (std::size_t i = 0; i < excluded.size(); ++i)
      if (excluded[i])
        excluded_entries.push_back(i);
    if (restriction.n_global_dofs() > 0)
      make_face_matrix();
  }



  bool
  KrylovSolver::renew(const DistributedMatrix &of)
  {
    if (&of != &matrix || !preconditioner->renew())
      return false;
    if (restriction.n_global_dofs() > 0)
      make_face_matrix();
    return true;
  }



  std::unique_ptr<ContactSolve>
  KrylovSolver::begin(const DistributedVector &load,
                      DistributedVector       &u,
                      const SolutionScale     &scale)
  {
    return std::make_unique<Solve>(*this, load, u, scale);
  }



  BulkSolver::Report
  KrylovSolver::solve(const DistributedVector &load,
                      DistributedVector       &u,
                      const double             tolerance,
                      const SolutionScale     &scale)
  {
    Solve          solve(*this, load, u, scale);
    FaceTruncation free_face;
    Tensor<2, 3>   identity;
    for (unsigned int d = 0; d < 3; ++d)
      identity[d][d] = 1.;
    free_face.projector.assign(face.n_nodes(), identity);
    free_face.spring.assign(face.n_nodes(), Tensor<2, 3>());
    solve.set_truncation(free_face, /* may_rebuild = */ true);

    const Vector<double> no_force(face.n_dofs());
    unsigned int         iterations = 0;
    Vector<double>       face_part(face.n_dofs());
    for (unsigned int pass = 0; pass < 20; ++pass)
      {
        const double error = pass == 0 ? solve.truncated_dual_norm(no_force) :
                                         solve.dual_norm(no_force);
        // From zero, the first solution sets the scale.
        const double size = solve.size();
        const double left = std::max(tolerance * size, scale.rounding_error);
        if (error <= left)
          return {iterations, left};
        iterations +=
          solve.correct(no_force,
                        size > 0. ?
                          std::min(0.3, 0.3 * tolerance * size / error) :
                          0.3 * tolerance,
                        face_part);
        solve.search_terms(face_part);
        solve.take_step(1.);
      }
    refuse("The linear solver stagnates above the relative error " +
           as_text(tolerance) + ".");
    return {};
  }
} // namespace Viscoplastic
