// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/solver_cg.h>
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
  }



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
      if (!solver.face.any(change.size() > 0 && change.linfty_norm() > 0.))
        return;
      w = 0.;
      solver.restriction.set(change, w);
      solver.matrix.vmult(product, w, solver.face_blocks);
      take_step(1.);
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
      product = residual;
      solver.restriction.add(-1., force, product);
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
      product = residual;
      solver.restriction.add(-1., force, product);
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
      solver.restriction.set(face_part, w);
      solver.matrix.vmult(product, w);
      return {residual * w, product * w, solver.restriction.gather(product)};
    }

    void
    take_step(const double step) override
    {
      first_is_truncated.reset();
      // K w = product and K u = load - residual, except for excluded
      // components, where w is zero.
      squared_norm +=
        step * (2. * (w * load - w * residual) + step * (w * product));
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

    /// Set product to the right-hand side of correct().
    void
    set_right_side(const Vector<double> &force)
    {
      product = residual;
      solver.restriction.add(-1., force, product);
      solver.restriction.tilt_equations(truncation, product);
      solver.restriction.project(truncation, product);
    }

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
    DistributedVector        residual, w, product;
    /// The result of the preconditioner for product, with or without
    /// truncation, with which conjugate gradients begin.
    DistributedVector   first;
    std::optional<bool> first_is_truncated;
    FaceTruncation      truncation;
    bool                has_springs  = false;
    double              squared_norm = 0.;
  };



  /// P (K + springs) P on the truncated space, or K on all unknowns.
  struct KrylovSolver::Solve::Operator
  {
    const Solve &solve;
    const bool   is_truncated;

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
      if (is_truncated)
        solve.solver.restriction.tilt_equations(solve.truncation, y);
      if (is_truncated && solve.has_springs)
        solve.solver.restriction.add_springs(solve.truncation, x, y);
      solve.restrict_to_unknowns(y);
      if (is_truncated)
        solve.solver.restriction.project(solve.truncation, y);
    }
  };



  /// P M^{-1} P on the truncated space, or M^{-1} on all unknowns.
  struct KrylovSolver::Solve::Inverse
  {
    Solve     &solve;
    const bool is_truncated;
    const bool is_whole = false;

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      if (std::exchange(solve.first_is_truncated, {}) == is_truncated)
        {
          // By linearity, since x is a multiple of product.
          y.equ((x * solve.product) / solve.product.norm_sqr(), solve.first);
          return;
        }
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



  unsigned int
  KrylovSolver::Solve::correct(const Vector<double> &force,
                               const double          tolerance,
                               Vector<double>       &face_part)
  {
    set_right_side(force);
    w                 = 0.;
    const double size = product.l2_norm();
    face_part         = 0.;
    if (size == 0.)
      return 0;

    ReductionControl control(max_cg_iterations, 0., tolerance);
    const Operator   system{*this, true};
    const Inverse    inverse{*this, true};
    try
      {
        if (solver.face.any(!truncation.tilt.empty()))
          SolverGMRES<DistributedVector>(
            control,
            SolverGMRES<DistributedVector>::AdditionalData(
              /* max_n_tmp_vectors = */ 50, /* right_preconditioning = */ true))
            .solve(system, w, product, inverse);
        else
          SolverCG<DistributedVector>(control).solve(system,
                                                     w,
                                                     product,
                                                     inverse);
      }
    catch (const SolverControl::NoConvergence &failure)
      {
        if (!std::isfinite(failure.last_residual))
          refuse(
            "The conjugate gradient method met a value that is not finite.");
        if (!(failure.last_residual < 0.5 * size))
          refuse("The conjugate gradient method does not converge; for nearly "
                 "incompressible bodies and flat cells use the direct linear "
                 "solver, on one rank.");
        // The result reduces the error: the next correction starts from it.
      }
    solver.restriction.tilt_motions(truncation, w);
    face_part = solver.restriction.gather(w);

    solver.preconditioner->learn(
      control.last_step(),
      std::log10(size / std::max(control.last_value(), 1e-16 * size)));
    return control.last_step();
  }



  double
  KrylovSolver::Solve::dual_norm_of_product(const double  limit,
                                            unsigned int &iterations)
  {
    // A preconditioner for another stick set misjudges residuals on the face,
    // so solve A w = R on all unknowns: w . R is the squared norm minus the
    // squared error, and grows in each iteration. If this takes long, a
    // preconditioner set up for all unknowns pays; restarting with it makes the
    // result independent of restarts of the run.
    if (!(product.l2_norm() > 0.))
      return 0.;
    const auto square = [&](const DistributedVector &x) {
      return std::max(0., x * product);
    };
    const unsigned int patience =
      std::min(solver.preconditioner->iterations_for_whole(),
               max_cg_iterations);
    for (const bool is_whole : {false, true})
      {
        w                         = 0.;
        bool             is_above = false;
        ReductionControl control(is_whole ? max_cg_iterations : patience,
                                 0.,
                                 0.1);
        SolverCG<DistributedVector> cg(control);
        if (std::isfinite(limit))
          cg.connect([&](const unsigned int, const double, const auto &x) {
            is_above = square(x) > Utilities::fixed_power<2>(limit);
            return is_above ? SolverControl::failure : SolverControl::success;
          });
        bool has_ended = true;
        try
          {
            cg.solve(Operator{*this, false},
                     w,
                     product,
                     Inverse{*this, false, is_whole});
          }
        catch (const SolverControl::NoConvergence &)
          {
            has_ended = is_above;
          }
        iterations += control.last_step();
        if (has_ended)
          return std::sqrt(square(w));
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
