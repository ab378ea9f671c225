// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/contact/bulk_solver.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>

#include <memory>
#include <vector>

namespace Viscoplastic
{
  /**
   * Direct solver on one rank: a sparse Cholesky factorization (CHOLMOD) with
   * the face ordered last, K = L L^T. The last block of L then factorizes the
   * Schur complement S = L_cc L_cc^T of the bulk on the face, so that a step is
   *
   *     one forward substitution, a dense problem on the face, one backward
   *     substitution,
   *
   * that is one plain solve, whatever the active set does.
   */
  class SchurSolver : public BulkSolver
  {
  public:
    /**
     * @p excluded: see AdmissibleSpace::excluded(); @p dim decides the fill
     * reducing ordering. Throws ExcMessage if the matrix is not positive
     * definite or memory is short.
     */
    SchurSolver(const DistributedMatrix &matrix,
                const std::vector<bool> &excluded,
                const FaceRestriction   &face,
                const unsigned int       dim);
    ~SchurSolver() override;

    /// Keeps the ordering of the unknowns.
    bool
    renew(const DistributedMatrix &matrix) override;

    bool
    is_exact() const override
    {
      return true;
    }

    std::string
    name() const override;

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
    /// CHOLMOD's data, hidden from those who include this file.
    struct Factor;

    /// Order the unknowns, interior first, and analyze the pattern.
    void
    analyze(const std::vector<bool>                    &excluded,
            const std::vector<types::global_dof_index> &face_dofs,
            const unsigned int                          dim);

    void
    factorize();

    void
    extract_schur_complement();

    /// y := L^{-1} (load - K u) on the unknowns.
    void
    forward(const DistributedVector &load, const DistributedVector &u);

    /// L^{-1} r.
    Vector<double>
    forward(const DistributedVector &r) const;

    /// What the solve under way has added to the displacement from which it
    /// began, times L^T: (y_i, L_cc^T face_change).
    Vector<double>
    change() const;

    /// u += L^{-T} v.
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

    // The solve under way.
    const DistributedVector *load = nullptr;
    DistributedVector       *u    = nullptr;
    Vector<double>           y, face_load, face_change, correction, product;
    FaceTruncation           truncation;
    double                   squared_norm = 0.; // of the start
    /// L^{-1} load, once it has been asked for.
    mutable Vector<double> forward_load;
  };
} // namespace Viscoplastic
