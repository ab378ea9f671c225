// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/contact/bulk_solver.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>

#include <memory>
#include <vector>

namespace dealii::TrilinosWrappers
{
  class PreconditionAMG;
}

namespace Viscoplastic
{
  /**
   * Conjugate gradients with algebraic multigrid (ML, smoothed aggregation with
   * the rigid body modes), on any number of ranks.
   *
   * The preconditioner is built for the stick set of the first solve: its
   * matrix has the rows and columns of prescribed and sticking components cut
   * off. While the set moves on, it is kept and filtered by the present
   * truncation, which costs iterations; it is rebuilt when the iterations lost
   * since the last set-up would have paid for a new one. The count, not the
   * clock, decides, so runs are reproducible.
   */
  class KrylovSolver : public BulkSolver
  {
  public:
    /**
     * @p rigid_body_modes: on owned entries, zero where @p excluded;
     * @p dim degrees of freedom a node.
     */
    KrylovSolver(const DistributedMatrix       &matrix,
                 const std::vector<bool>       &excluded,
                 std::vector<DistributedVector> rigid_body_modes,
                 const FaceRestriction         &restriction,
                 const unsigned int             dim);
    ~KrylovSolver() override;

    bool
    is_exact() const override
    {
      return false;
    }

    std::string
    name() const override;

    std::optional<PreconditionerState>
    preconditioner_state() const override;

    void
    restore(const std::optional<PreconditionerState> &state) override;

    unsigned int
    solve(const DistributedVector &load,
          DistributedVector       &u,
          const double             tolerance) override;

    void
    begin(const DistributedVector &load, DistributedVector &u) override;

    const FaceMatrix &
    face_matrix() const override;

    void
    face_residual(Vector<double> &r) override;

    void
    move_face(const Vector<double> &change) override;

    void
    set_truncation(const FaceTruncation &truncation,
                   const bool            may_rebuild = true) override;

    double
    dual_norm(const Vector<double> &force) override;

    double
    confirmed_dual_norm(const Vector<double> &force,
                        unsigned int         &iterations) override;

    double
    energy_norm() const override;

    unsigned int
    correct(const Vector<double> &force,
            const double          tolerance,
            Vector<double>       &w) override;

    SearchTerms
    search_terms(const Vector<double> &w) override;

    void
    take_step(const double step) override;

    unsigned int
    finish() override;

  private:
    struct TruncatedOperator;
    struct FilteredPreconditioner;

    /// Set entries of excluded components to zero.
    void
    restrict_to_unknowns(DistributedVector &v) const;

    /// Build the preconditioner for the present truncation.
    void
    build_preconditioner();

    /// One cycle for x.
    void
    precondition(DistributedVector &y, const DistributedVector &x) const;

    void
    make_face_matrix();

    const DistributedMatrix          &matrix;
    const std::vector<bool>          &excluded;
    std::vector<std::size_t>          excluded_entries;
    std::vector<DistributedVector>    rigid_body_modes;
    const FaceRestriction            &restriction;
    const FrictionFace               &face;
    const unsigned int                dim;
    const MPI_Comm                    communicator;
    std::unique_ptr<SparseFaceMatrix> sparse_face_matrix;

    // The preconditioner, and how it is doing.
    std::unique_ptr<TrilinosWrappers::PreconditionAMG> amg;
    /// Its matrix is in this unit; see build_preconditioner().
    double              amg_unit = 1.;
    std::vector<double> near_null_space;
    /// The preconditioner's matrix, which ML refers to.
    DistributedMatrix masked_matrix;
    /// The truncation for which it was built.
    FaceTruncation built_for;
    /// Iterations a decade right after a set-up, the best so far; iterations
    /// lost against that since the last set-up.
    double best_rate = 0., lost_iterations = 0.;
    bool   is_fresh = false;

    // The solve under way.
    const DistributedVector *load = nullptr;
    DistributedVector       *u    = nullptr;
    DistributedVector        residual, w, product;
    FaceTruncation           truncation;
    bool                     has_springs  = false;
    double                   squared_norm = 0.;
  };
} // namespace Viscoplastic
