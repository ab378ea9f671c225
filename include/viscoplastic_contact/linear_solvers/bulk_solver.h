// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_solve.h>

#include <memory>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /// What an iterative solver keeps from earlier solves with a matrix for later
  /// ones: how its preconditioner was built, and the iterations it has taken.
  struct PreconditionerState
  {
    FaceTruncation built_for;
    /// Iterations a decade right after a set-up, the best so far; iterations
    /// lost against that since the last set-up.
    double best_rate = 0., lost_iterations = 0.;
    /// Whether no solve has used it yet.
    bool is_fresh = false;
  };


  /// Solves with the elastic matrix A, or a tangent, of one mesh, for any load,
  /// start, and truncation of the face. Keeps a factorization or a
  /// preconditioner, and nothing of the solves themselves. All calls are
  /// collective; vectors are in frames.
  class BulkSolver
  {
  public:
    virtual ~BulkSolver() = default;

    /// Whether solves leave nothing but rounding, whatever their tolerance.
    virtual bool
    is_exact() const = 0;

    /// The name of the solver in messages, e.g. "direct (CHOLMOD)".
    virtual std::string
    name() const = 0;

    /// The linear iterations (1 for a direct solver) and the error in the
    /// energy norm that is left at most.
    struct Report
    {
      unsigned int iterations;
      double       error;
    };

    /// Solve a(u,v) = l(v) without contact. @p u brings the prescribed values
    /// and a start, and takes the solution up. Stops at the relative energy
    /// error @p tolerance. Throws ExcMessage.
    virtual Report
    solve(const DistributedVector &load,
          DistributedVector       &u,
          const double             tolerance,
          const SolutionScale     &scale = {}) = 0;

    /// Begin a solve with contact at @p u, which takes the solution up when it
    /// is finished. The vectors and this solver have to outlive it.
    virtual std::unique_ptr<ContactSolve>
    begin(const DistributedVector &load,
          DistributedVector       &u,
          const SolutionScale     &scale = {}) = 0;

    /// The face matrix that all solves share; there must be contact points.
    virtual const FaceMatrix &
    face_matrix() const = 0;

    /// The matrix has other values in the same pattern: adapt. Returns false if
    /// @p matrix is another object or a new solver is as good; then this one is
    /// of no use any more.
    virtual bool
    renew(const DistributedMatrix &matrix) = 0;

    /// For restore(); nothing if solves do not depend on earlier ones.
    virtual std::optional<PreconditionerState>
    preconditioner_state() const
    {
      return {};
    }

    /// Go on like the solver that was in this state, on the same mesh; without
    /// one like a new solver.
    virtual void
    restore(const std::optional<PreconditionerState> &)
    {}
  };
} // namespace Viscoplastic
