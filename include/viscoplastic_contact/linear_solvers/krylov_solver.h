// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/contact/bulk_solver.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>
#include <viscoplastic_contact/linear_solvers/preconditioner.h>

#include <memory>
#include <vector>

namespace Viscoplastic
{
  class SparseFaceMatrix;

  /// Preconditioned conjugate gradients on the truncated space, on any number
  /// of ranks.
  class KrylovSolver : public BulkSolver
  {
  public:
    KrylovSolver(const DistributedMatrix        &matrix,
                 const std::vector<bool>        &excluded,
                 const FaceRestriction          &restriction,
                 std::unique_ptr<Preconditioner> preconditioner);
    ~KrylovSolver() override;

    bool
    renew(const DistributedMatrix &matrix) override;

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
                        const double          limit,
                        unsigned int         &iterations) override;

    double
    rounding_of_residual() override;

    double
    energy_norm() const override;

    unsigned int
    correct(const Vector<double> &force,
            const double          tolerance,
            Vector<double>       &w) override;

    SearchTerms
    search_terms(const Vector<double> &w) override;

    void
    face_response(Vector<double> &response) override;

    void
    take_step(const double step) override;

    unsigned int
    finish() override;

  private:
    struct TruncatedOperator;
    struct TruncatedPreconditioner;

    /// Set entries of excluded components to zero.
    void
    restrict_to_unknowns(DistributedVector &v) const;

    void
    make_face_matrix();

    /// The dual norm of the vector in product, without the quality of the
    /// preconditioner in it, or some lower bound above @p limit.
    double
    dual_norm_of_product(const double limit, unsigned int &iterations);

    const DistributedMatrix          &matrix;
    const std::vector<bool>          &excluded;
    std::vector<std::size_t>          excluded_entries;
    const FaceRestriction            &restriction;
    const ContactLayout              &face;
    const MPI_Comm                    communicator;
    std::unique_ptr<SparseFaceMatrix> sparse_face_matrix;

    std::unique_ptr<Preconditioner> preconditioner;

    // The solve under way.
    const DistributedVector *load = nullptr;
    DistributedVector       *u    = nullptr;
    DistributedVector        residual, w, product;
    FaceTruncation           truncation;
    bool                     has_springs  = false;
    double                   squared_norm = 0.;
  };
} // namespace Viscoplastic
