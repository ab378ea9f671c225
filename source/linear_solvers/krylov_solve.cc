// SPDX-License-Identifier: LGPL-2.1-or-later
#include "krylov_solve.h"

#include <deal.II/lac/solver_gmres.h>

#include <viscoplastic_contact/base/messages.h>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int max_cg_iterations = 5000;
  }



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
} // namespace Viscoplastic
