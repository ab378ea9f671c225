// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/linear_solvers/bulk_solver.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>

#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// Direct solver on one rank: a sparse Cholesky factorization (CHOLMOD) with
  /// the face ordered last, K = L L^T. The last block of L then factorizes the
  /// Schur complement S = L_cc L_cc^T of the bulk on the face, so that a step
  /// is
  ///
  ///     one forward substitution, a dense problem on the face, one backward
  ///     substitution,
  ///
  /// that is one plain solve, whatever the active set does.
  class SchurSolver : public BulkSolver
  {
  public:
    /// @p excluded: see AdmissibleSpace::excluded(); @p dim decides the fill
    /// reducing ordering. Throws ExcMessage if the matrix is not positive
    /// definite or memory is short.
    SchurSolver(const DistributedMatrix &matrix,
                const std::vector<bool> &excluded,
                const FaceRestriction   &face,
                const unsigned int       dim);
    ~SchurSolver() override;

    bool
    is_exact() const override
    {
      return true;
    }

    std::string
    name() const override
    {
      return "direct (CHOLMOD)";
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
      return *schur_complement;
    }

    /// Factorize anew with the same fill reducing ordering.
    bool
    renew(const DistributedMatrix &matrix) override;

  private:
    /// CHOLMOD's data, hidden from those who include this file.
    struct Factor;
    class Solve;

    /// Order the unknowns, interior first, and analyze the pattern.
    void
    analyze(const std::vector<bool>                    &excluded,
            const std::vector<types::global_dof_index> &face_dofs,
            const unsigned int                          dim);

    void
    factorize();

    void
    extract_schur_complement();

    /// Forward substitution L^{-1} r, in the order of the factorization.
    Vector<double>
    forward(const DistributedVector &r) const;

    /// Backward substitution, u += L^{-T} v.
    void
    backward(Vector<double> v, DistributedVector &u) const;

    const DistributedMatrix &matrix;
    const ContactLayout     &face;
    std::unique_ptr<Factor>  factor;
    /// Position in u of each unknown in the order of the factorization.
    std::vector<unsigned int> unknowns;
    /// Factor of the Schur complement, lower triangular.
    LAPACKFullMatrix<double>         face_factor;
    std::unique_ptr<DenseFaceMatrix> schur_complement;
  };
} // namespace Viscoplastic
