// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>
#include <viscoplastic_contact/linear_solvers/preconditioner.h>
#include <viscoplastic_contact/linear_solvers/smoothed_aggregation.h>

#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// Preconditioner by smoothed aggregation with rigid body modes (Trilinos'
  /// ML), for any matrix on any mesh.
  ///
  /// The hierarchy is built for the stick set of the first solve, from the
  /// matrix without the rows and columns of prescribed and blocked components.
  /// While the set changes, it is kept and the caller projects its results,
  /// which costs iterations. It is rebuilt when the iterations lost since the
  /// last set-up exceed the price of a new one. Iterations are counted instead
  /// of seconds, so that runs are reproducible.
  class AlgebraicMultigrid : public Preconditioner
  {
  public:
    /// @p excluded: owned degrees of freedom that are not unknowns;
    /// @p rigid_body_modes: on owned entries, zero where excluded; @p dim
    /// degrees of freedom a node.
    AlgebraicMultigrid(const DistributedMatrix       &matrix,
                       std::vector<bool>              excluded,
                       std::vector<DistributedVector> rigid_body_modes,
                       const FaceRestriction         &restriction,
                       const unsigned int             dim);
    ~AlgebraicMultigrid() override;

    std::string
    name() const override;

    void
    set_truncation(const FaceTruncation &truncation,
                   const bool            may_rebuild) override;

    void
    vmult(DistributedVector &y, const DistributedVector &x) const override;

    void
    vmult_untruncated(DistributedVector       &y,
                      const DistributedVector &x) const override;

    void
    vmult_whole(DistributedVector       &y,
                const DistributedVector &x) const override;

    unsigned int
    iterations_for_whole() const override;

    void
    learn(const unsigned int iterations, const double decades) override;

    std::optional<PreconditionerState>
    state() const override;

    void
    restore(const std::optional<PreconditionerState> &state) override;

  private:
    std::unique_ptr<SmoothedAggregation>
    make(const FaceTruncation &truncation) const;

    void
    build();

    /// The cost of a set-up of ML, in iterations of conjugate gradients.
    unsigned int
    price() const;

    /// Set `damping` from the diagonals of matrix and springs.
    void
    make_damping();

    const DistributedMatrix       &matrix;
    const std::vector<bool>        excluded;
    std::vector<DistributedVector> rigid_body_modes;
    const FaceRestriction         &restriction;
    const ContactLayout           &face;
    const unsigned int             dim;

    FaceTruncation truncation;
    bool           has_springs = false;
    /// The diagonal D on owned face entries of the preconditioner D M^{-1} D;
    /// empty without springs. D^2 = diag(K + springs known to M)/diag(K +
    /// springs), at most 1, tends to 0 for a point that comes to rest, so that
    /// stiff springs that M does not know do no harm.
    Vector<double>            damping;
    mutable DistributedVector damped;

    std::unique_ptr<SmoothedAggregation> amg;
    /// For vmult_whole(): made without truncation and springs.
    mutable std::unique_ptr<SmoothedAggregation> whole;
    FaceTruncation                               built_for;
    /// The least number of iterations per decade of the residual right after a
    /// set-up; iterations lost against that rate since the last set-up.
    double best_rate = 0., lost_iterations = 0.;
    bool   is_fresh = false;
  };
} // namespace Viscoplastic
