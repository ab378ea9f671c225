// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_solve.h>

#include <memory>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /// The state of an iterative solver on which later solves with the same
  /// matrix depend: how its preconditioner was built, and its iteration counts.
  struct PreconditionerState
  {
    FaceTruncation built_for;
    /// The least number of iterations per decade of the residual right after a
    /// set-up; iterations lost against that rate since the last set-up.
    double best_rate = 0., lost_iterations = 0.;
    /// Whether no solve has used the preconditioner since its set-up.
    bool is_fresh = false;
  };


  /// Interface of solvers with the elastic matrix A, or a tangent, of one mesh,
  /// for any load, initial guess, and truncation of the face. A solver keeps a
  /// factorization or a preconditioner, but no solutions. All calls are
  /// collective; vectors are in nodal frames.
  class BulkSolver
  {
  public:
    virtual ~BulkSolver() = default;

    /// Whether solves are exact up to rounding, whatever their tolerance.
    virtual bool
    is_exact() const = 0;

    /// The name of the solver in messages, e.g. "direct (CHOLMOD)".
    virtual std::string
    name() const = 0;

    /// The number of linear iterations (1 for a direct solver) and a bound of
    /// the remaining error in the energy norm.
    struct Report
    {
      unsigned int iterations;
      double       error;
    };

    /// Solve a(u,v) = l(v) without contact. On entry, @p u has the prescribed
    /// values and an initial guess; on return, the solution. Iterations stop at
    /// the relative energy error @p tolerance. Throws ExcMessage.
    virtual Report
    solve(const DistributedVector &load,
          DistributedVector       &u,
          const double             tolerance,
          const SolutionScale     &scale = {}) = 0;

    /// Begin a solve with contact from @p u, which gets the solution when it
    /// finishes. The vectors and this solver have to outlive the solve.
    virtual std::unique_ptr<ContactSolve>
    begin(const DistributedVector &load,
          DistributedVector       &u,
          const SolutionScale     &scale = {}) = 0;

    /// Return the face matrix that all solves share. Requires contact points.
    virtual const FaceMatrix &
    face_matrix() const = 0;

    /// Adapt to new values of the matrix in the same sparsity pattern. Returns
    /// false if @p matrix is another object or a new solver is as good; then
    /// this solver must not be used any more.
    virtual bool
    renew(const DistributedMatrix &matrix) = 0;

    /// Return the state for restore(); nothing if solves are independent.
    virtual std::optional<PreconditionerState>
    preconditioner_state() const
    {
      return {};
    }

    /// Continue like a solver in the given state on the same mesh, or like a
    /// new solver if there is none.
    virtual void
    restore(const std::optional<PreconditionerState> &)
    {}
  };
} // namespace Viscoplastic
