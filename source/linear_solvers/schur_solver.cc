// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/linear_solvers/schur_solver.h>

#include <cholmod.h>

namespace Viscoplastic
{
  struct SchurSolver::Factor
  {
    cholmod_common  common;
    cholmod_factor *L        = nullptr;
    cholmod_dense  *solution = nullptr;

    Factor()
    {
      cholmod_l_start(&common);
      common.supernodal                 = CHOLMOD_SUPERNODAL;
      common.final_ll                   = 1;
      common.nmethods                   = 1;
      common.print                      = 0;
      common.try_catch                  = 1; // we report errors
      common.quick_return_if_not_posdef = 1;
    }

    Factor(const Factor &) = delete;

    ~Factor()
    {
      cholmod_l_free_factor(&L, &common);
      cholmod_l_free_dense(&solution, &common);
      cholmod_l_finish(&common);
    }

    void
    check(const std::string &doing) const
    {
      if (common.status == CHOLMOD_NOT_POSDEF)
        refuse("The elastic matrix is not positive definite in the direct "
               "solver; the elastic data or the mesh are degenerate.");
      if (common.status < CHOLMOD_OK)
        refuse(
          "The direct solver failed " + doing +
          (common.status == CHOLMOD_OUT_OF_MEMORY ? ": memory is short" : "") +
          "; use the multigrid solver.");
    }

    /// Return the upper triangle by columns (= the lower one by rows) of the
    /// matrix of the first @p n of @p unknowns.
    cholmod_sparse *
    to_cholmod(const DistributedMatrix         &matrix,
               const std::vector<unsigned int> &unknowns,
               const unsigned int               n,
               const bool                       with_values)
    {
      constexpr unsigned int    none = numbers::invalid_unsigned_int;
      const unsigned int        dim  = matrix.block_size();
      std::vector<unsigned int> position(matrix.m(), none);
      for (unsigned int i = 0; i < n; ++i)
        position[unknowns[i]] = i;
      std::vector<SuiteSparse_long> begin(n + 1, 0);
      const auto                    for_each = [&](const auto &visit) {
        matrix.for_each_block(
          [&](const unsigned int i, const unsigned int j, const double *block) {
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = i == j ? c : 0; d < dim; ++d)
                {
                  const unsigned int a = position[i * dim + c],
                                     b = position[j * dim + d];
                  if (a != none && b != none)
                    visit(std::max(a, b), std::min(a, b), block[c * dim + d]);
                }
          });
      };
      for_each([&](const unsigned int column,
                   const unsigned int,
                   const double) { ++begin[column + 1]; });
      for (unsigned int i = 0; i < n; ++i)
        begin[i + 1] += begin[i];
      cholmod_sparse *A =
        cholmod_l_allocate_sparse(n,
                                  n,
                                  begin[n],
                                  /* sorted = */ 0,
                                  /* packed = */ 1,
                                  /* stype: upper = */ 1,
                                  with_values ? CHOLMOD_REAL : CHOLMOD_PATTERN,
                                  &common);
      check("for want of memory");
      std::copy(begin.begin(),
                begin.end(),
                static_cast<SuiteSparse_long *>(A->p));
      for_each([&](const unsigned int column,
                   const unsigned int row,
                   const double       value) {
        const auto at                             = begin[column]++;
        static_cast<SuiteSparse_long *>(A->i)[at] = row;
        if (with_values)
          static_cast<double *>(A->x)[at] = value;
      });
      return A;
    }

    /// Solve in place: x := L^{-1} x or L^{-T} x.
    void
    solve(const int system, Vector<double> &x)
    {
      if (x.size() == 0)
        return;
      cholmod_dense b;
      b.nrow = b.d = b.nzmax = x.size();
      b.ncol                 = 1;
      b.x                    = &x[0];
      b.z                    = nullptr;
      b.xtype                = CHOLMOD_REAL;
      b.dtype                = CHOLMOD_DOUBLE;
      cholmod_l_free_dense(&solution, &common);
      solution = cholmod_l_solve(system, L, &b, &common);
      check("in a solve");
      const double *values = static_cast<const double *>(solution->x);
      std::copy(values, values + x.size(), x.begin());
    }
  };



  SchurSolver::SchurSolver(const DistributedMatrix &matrix,
                           const std::vector<bool> &excluded,
                           const FaceRestriction   &restriction,
                           const unsigned int       dim)
    : matrix(matrix)
    , face(restriction.face())
    , factor(std::make_unique<Factor>())
  {
    AssertDimension(matrix.m(), excluded.size());
    analyze(excluded, restriction.dofs(), dim);
    factorize();
  }



  void
  SchurSolver::analyze(const std::vector<bool>                    &excluded,
                       const std::vector<types::global_dof_index> &face_dofs,
                       const unsigned int                          dim)
  {
    // Unknowns off the face first.
    std::vector<bool> on_face(excluded.size(), false);
    for (const auto dof : face_dofs)
      on_face[dof] = true;
    for (unsigned int i = 0; i < excluded.size(); ++i)
      if (!excluded[i] && !on_face[i])
        unknowns.push_back(i);
    const unsigned int n_interior = unknowns.size();
    unknowns.insert(unknowns.end(), face_dofs.begin(), face_dofs.end());
    if (unknowns.empty())
      return; // every displacement is prescribed

    // A fill reducing ordering of the interior; the face stays last. AMD is
    // better in 2D, nested dissection in 3D.
    cholmod_common &common = factor->common;
    if (n_interior > 0)
      {
        common.method[0].ordering = dim == 2 ? CHOLMOD_AMD : CHOLMOD_METIS;
        cholmod_sparse *A =
          factor->to_cholmod(matrix, unknowns, n_interior, false);
        cholmod_factor *symbolic = cholmod_l_analyze(A, &common);
        factor->check("to order the unknowns");
        const auto *permutation =
          static_cast<const SuiteSparse_long *>(symbolic->Perm);
        const std::vector<unsigned int> old(unknowns);
        for (unsigned int i = 0; i < n_interior; ++i)
          unknowns[i] = old[permutation[i]];
        cholmod_l_free_factor(&symbolic, &common);
        cholmod_l_free_sparse(&A, &common);
      }

    common.method[0].ordering = CHOLMOD_NATURAL;
    common.postorder          = 0;
    cholmod_sparse *A =
      factor->to_cholmod(matrix, unknowns, unknowns.size(), false);
    factor->L = cholmod_l_analyze(A, &common);
    factor->check("to analyse the matrix");
    cholmod_l_free_sparse(&A, &common);
  }



  void
  SchurSolver::factorize()
  {
    if (unknowns.empty())
      return;
    cholmod_sparse *A =
      factor->to_cholmod(matrix, unknowns, unknowns.size(), true);
    cholmod_l_factorize(A, factor->L, &factor->common);
    factor->check("to factorize the matrix");
    cholmod_l_free_sparse(&A, &factor->common);
    if (face.n_dofs() > 0)
      extract_schur_complement();
  }



  bool
  SchurSolver::renew(const DistributedMatrix &of)
  {
    if (&of != &matrix)
      return false;
    factorize();
    return true;
  }



  SchurSolver::~SchurSolver() = default;



  void
  SchurSolver::extract_schur_complement()
  {
    // L is stored in supernodes: dense blocks of columns with the same rows.
    const cholmod_factor &L = *factor->L;
    const auto *super       = static_cast<const SuiteSparse_long *>(L.super);
    const auto *pi          = static_cast<const SuiteSparse_long *>(L.pi);
    const auto *px          = static_cast<const SuiteSparse_long *>(L.px);
    const auto *rows        = static_cast<const SuiteSparse_long *>(L.s);
    const auto *x           = static_cast<const double *>(L.x);

    const int              n     = face.n_dofs();
    const SuiteSparse_long first = unknowns.size() - n;
    face_factor.reinit(n, n);
    for (std::size_t s = 0; s < L.nsuper; ++s)
      for (SuiteSparse_long j = std::max(super[s], first); j < super[s + 1];
           ++j)
        {
          const SuiteSparse_long n_rows = pi[s + 1] - pi[s];
          const SuiteSparse_long local  = j - super[s];
          for (SuiteSparse_long i = local; i < n_rows; ++i)
            face_factor(rows[pi[s] + i] - first, j - first) =
              x[px[s] + local * n_rows + i];
        }

    face_factor.set_property(LAPACKSupport::lower_triangular);
    LAPACKFullMatrix<double> product_matrix(n, n);
    face_factor.mTmult(product_matrix, face_factor);
    FullMatrix<double> S(n, n);
    S                = product_matrix;
    schur_complement = std::make_unique<DenseFaceMatrix>(face, std::move(S));
  }



  Vector<double>
  SchurSolver::forward(const DistributedVector &r) const
  {
    Vector<double> result(unknowns.size());
    for (unsigned int i = 0; i < unknowns.size(); ++i)
      result[i] = r.begin()[unknowns[i]];
    factor->solve(CHOLMOD_L, result);
    return result;
  }



  void
  SchurSolver::backward(Vector<double> v, DistributedVector &target) const
  {
    factor->solve(CHOLMOD_Lt, v);
    for (unsigned int i = 0; i < unknowns.size(); ++i)
      target.begin()[unknowns[i]] += v[i];
  }



  BulkSolver::Report
  SchurSolver::solve(const DistributedVector &load,
                     DistributedVector       &u,
                     const double /*tolerance*/,
                     const SolutionScale &scale)
  {
    DistributedVector residual(load);
    matrix.vmult(residual, u);
    residual.sadd(-1., 1., load);
    backward(forward(residual), u);
    return {1, scale.rounding_error};
  }
} // namespace Viscoplastic
