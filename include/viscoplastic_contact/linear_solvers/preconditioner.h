// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/bulk_solver.h>

#include <optional>
#include <string>

namespace Viscoplastic
{
  /// An approximate inverse of K + springs on the truncated space for conjugate
  /// gradients: symmetric and positive definite. Vectors are in nodal frames,
  /// on owned entries. All calls are collective.
  class Preconditioner
  {
  public:
    virtual ~Preconditioner() = default;

    /// Return the name in messages, e.g. "algebraic multigrid (ML)".
    virtual std::string
    name() const = 0;

    /// Adapt to new values of the matrix in the same pattern. Returns false if
    /// constructing a new preconditioner is as good.
    virtual bool
    renew()
    {
      return false;
    }

    /// Set the truncated space and the springs of vmult(). Without @p
    /// may_rebuild the truncation is temporary, and nothing is set up anew.
    virtual void
    set_truncation(const FaceTruncation &truncation,
                   const bool            may_rebuild) = 0;

    /// y := M^{-1} x. Components of y outside of the truncated space are
    /// undefined.
    virtual void
    vmult(DistributedVector &y, const DistributedVector &x) const = 0;

    /// y := M^{-1} x for the matrix without truncation and springs; y is
    /// undefined on excluded components.
    virtual void
    vmult_untruncated(DistributedVector       &y,
                      const DistributedVector &x) const = 0;

    /// Like vmult_untruncated(), with a preconditioner set up for the whole
    /// matrix, at the first call; that costs as much as iterations_for_whole()
    /// iterations with the truncated one.
    virtual void
    vmult_whole(DistributedVector &y, const DistributedVector &x) const
    {
      vmult_untruncated(y, x);
    }

    virtual unsigned int
    iterations_for_whole() const
    {
      return numbers::invalid_unsigned_int;
    }

    /// A solve took @p iterations to reduce the residual by @p decades.
    virtual void
    learn(const unsigned int /*iterations*/, const double /*decades*/)
    {}

    /// See BulkSolver::preconditioner_state().
    virtual std::optional<PreconditionerState>
    state() const
    {
      return {};
    }

    virtual void
    restore(const std::optional<PreconditionerState> &)
    {}
  };
} // namespace Viscoplastic
