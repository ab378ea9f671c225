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
  /// Smoothed aggregation with the rigid body modes (ML): for any matrix, on
  /// any mesh.
  ///
  /// It is built for the stick set of the first solve: its matrix has the rows
  /// and columns of prescribed and blocked components cut off. While the set
  /// moves on, it is kept and filtered by the present truncation, which costs
  /// iterations; it is rebuilt when the iterations lost since the last set-up
  /// would have paid for a new one. The count, not the clock, decides, so runs
  /// are reproducible.
  class AlgebraicMultigrid : public Preconditioner
  {
  public:
    /// @p excluded: owned degrees of freedom that are no unknowns;
    /// @p rigid_body_modes: on owned entries, zero where excluded;
    /// @p dim degrees of freedom a node.
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

    /// Set `damping' from the matrix.
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
    /// D of owned face entries, empty without springs: D^2 = diag(K + springs
    /// known to M)/diag(K + springs), at most 1, tends to 0 for a point that
    /// comes to rest, so that stiff new springs do not spoil a preconditioner
    /// D M^{-1} D that does not know them.
    Vector<double>            damping;
    mutable DistributedVector damped;

    std::unique_ptr<SmoothedAggregation> amg;
    /// Of the matrix without truncation and springs, for vmult_whole().
    mutable std::unique_ptr<SmoothedAggregation> whole;
    FaceTruncation                               built_for;
    /// Iterations a decade right after a set-up, the best so far; iterations
    /// lost against that since the last set-up.
    double best_rate = 0., lost_iterations = 0.;
    bool   is_fresh = false;
  };
} // namespace Viscoplastic
