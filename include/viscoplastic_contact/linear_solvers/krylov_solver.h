// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/contact/sparse_face_matrix.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>
#include <viscoplastic_contact/linear_solvers/preconditioner.h>

#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// Preconditioned conjugate gradients on the truncated space, on any number
  /// of ranks; GMRES if equations of slipping points are tilted.
  class KrylovSolver : public BulkSolver
  {
  public:
    KrylovSolver(const DistributedMatrix        &matrix,
                 const std::vector<bool>        &excluded,
                 const FaceRestriction          &restriction,
                 std::unique_ptr<Preconditioner> preconditioner);

    bool
    is_exact() const override
    {
      return false;
    }

    std::string
    name() const override
    {
      return "conjugate gradients with " + preconditioner->name();
    }

    Report
    solve(const DistributedVector &load,
          DistributedVector       &u,
          const double             tolerance,
          const SolutionScale     &scale) override;

    std::unique_ptr<ContactSolve>
    begin(const DistributedVector &load,
          DistributedVector       &u,
          const SolutionScale     &scale) override;

    const FaceMatrix &
    face_matrix() const override
    {
      return *sparse_face_matrix;
    }

    bool
    renew(const DistributedMatrix &matrix) override;

    std::optional<PreconditionerState>
    preconditioner_state() const override
    {
      return preconditioner->state();
    }

    void
    restore(const std::optional<PreconditionerState> &state) override
    {
      preconditioner->restore(state);
    }

  private:
    class Solve;

    void
    make_face_matrix();

    const DistributedMatrix          &matrix;
    const std::vector<bool>          &excluded;
    std::vector<std::size_t>          excluded_entries;
    const FaceRestriction            &restriction;
    const ContactLayout              &face;
    std::unique_ptr<SparseFaceMatrix> sparse_face_matrix;
    /// The blocks of the matrix with a row or a column on the face.
    std::vector<DistributedMatrix::Place> face_blocks;

    std::unique_ptr<Preconditioner> preconditioner;
  };
} // namespace Viscoplastic
