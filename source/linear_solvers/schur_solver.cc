// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/residual_rounding.h>
#include <viscoplastic_contact/linear_solvers/schur_solver.h>

#include <cholmod.h>

#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// The Schur complement on the truncated space, with springs.
    struct TruncatedFace
    {
      const FullMatrix<double> &S;
      const ContactLayout      &face;
      const FaceTruncation     &truncation;

      void
      vmult(Vector<double> &y, const Vector<double> &x) const
      {
        // x lies in the truncated space, where the iteration keeps it.
        if (truncation.transposed)
          {
            Vector<double> motion(x);
            truncation.tilt_motions(face, motion);
            S.vmult(y, motion);
          }
        else
          S.vmult(y, x);
        truncation.tilt_equations(face, y);
        for (unsigned int n = 0; n < face.n_nodes(); ++n)
          face.set_node_values(truncation.projector[n] *
                                 (face.node_values(y, n) +
                                  truncation.spring[n] *
                                    face.node_values(x, n)),
                               n,
                               y);
      }
    };



    /// Inverse diagonal blocks of that, as a preconditioner.
    struct NodalBlocks
    {
      const ContactLayout      &face;
      std::vector<Tensor<2, 3>> inverse;

      void
      vmult(Vector<double> &y, const Vector<double> &x) const
      {
        for (unsigned int n = 0; n < face.n_nodes(); ++n)
          face.set_node_values(inverse[n] * face.node_values(x, n), n, y);
      }
    };
  } // namespace



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
      AssertThrow(common.status != CHOLMOD_NOT_POSDEF,
                  ExcMessage("The elastic matrix is not positive definite in "
                             "the direct solver; the elastic data or the mesh "
                             "are degenerate."));
      AssertThrow(common.status >= CHOLMOD_OK,
                  ExcMessage("The direct solver failed " + doing +
                             (common.status == CHOLMOD_OUT_OF_MEMORY ?
                                ": memory is short" :
                                "") +
                             "; use 'Solver/Linear solver' = multigrid."));
    }

    /// The upper triangle by columns (= the lower one by rows) of the leading n
    /// unknowns in their present order.
    cholmod_sparse *
    to_cholmod(const DistributedMatrix         &matrix,
               const std::vector<unsigned int> &unknowns,
               const unsigned int               n,
               const bool                       with_values)
    {
      constexpr unsigned int    none = numbers::invalid_unsigned_int;
      const Epetra_CrsMatrix   &crs  = matrix.trilinos_matrix();
      std::vector<unsigned int> position(crs.NumMyRows(), none);
      for (unsigned int i = 0; i < n; ++i)
        position[unknowns[i]] = i;
      std::vector<SuiteSparse_long> begin(n + 1, 0);
      const auto                    for_each = [&](const auto &visit) {
        for (unsigned int column = 0; column < n; ++column)
          {
            int     length, *indices;
            double *values;
            crs.ExtractMyRowView(unknowns[column], length, values, indices);
            for (int e = 0; e < length; ++e)
              {
                const unsigned int row = position[crs.GCID(indices[e])];
                if (row != none && row <= column)
                  visit(column, row, values[e]);
              }
          }
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



  /// A solve under way, after the forward substitution: the bulk follows the
  /// face.
  class SchurSolver::Solve : public ContactSolve
  {
  public:
    Solve(const SchurSolver       &solver,
          const DistributedVector &load,
          DistributedVector       &u,
          const SolutionScale     &scale)
      : ContactSolve(solver.schur_complement.get(), true, scale)
      , solver(solver)
      , face(solver.face)
      , load(load)
      , u(u)
      , face_load(face.n_dofs())
      , face_change(face_load)
      , correction(face_load)
      , product(face_load)
    {
      DistributedVector residual(load);
      solver.matrix.vmult(residual, u);
      squared_norm = u * residual;
      residual.sadd(-1., 1., load);
      y = solver.forward(residual);
      if (face.n_dofs() == 0)
        return;
      // y = (y_i, y_c); the face's load after condensation is L_cc y_c.
      std::copy(y.end() - face.n_dofs(), y.end(), product.begin());
      solver.face_factor.vmult(face_load, product);
    }

    Vector<double>
    face_residual() const override
    {
      Vector<double> r(face.n_dofs());
      solver.schur_complement->matrix().vmult(r, face_change);
      r.sadd(-1., 1., face_load);
      return r;
    }

    void
    move_face(const Vector<double> &change) override
    {
      face_change += change;
    }

    void
    set_truncation(const FaceTruncation &truncation_,
                   const bool /*may_rebuild*/) override
    {
      truncation = truncation_;
    }

    double
    dual_norm(const Vector<double> &force) override
    {
      // The bulk is in equilibrium, so the residual lives on the face, and its
      // dual norm is that of the Schur complement.
      product = face_residual();
      product -= force;
      solver.face_factor.solve(product);
      return product.l2_norm();
    }

    double
    rounding_of_residual() override
    {
      DistributedVector end(u);
      solver.backward(change(), end);
      return Viscoplastic::rounding_of_residual(
        solver.matrix, load, end, [&](const DistributedVector &error) {
          return solver.forward(error).norm_sqr();
        });
    }

    double
    energy_norm() const override;

    unsigned int
    correct(const Vector<double> &force,
            const double          tolerance,
            Vector<double>       &w) override;

    SearchTerms
    search_terms(const Vector<double> &w) override
    {
      correction = w;
      solver.schur_complement->matrix().vmult(product, correction);
      return {face_residual() * correction, product * correction, product};
    }

    void
    take_step(const double step) override
    {
      face_change.add(step, correction);
    }

    unsigned int
    finish() override
    {
      solver.backward(change(), u);
      return 1;
    }

  private:
    /// What this has added to the displacement from which it began, times L^T:
    /// (y_i, L_cc^T face_change).
    Vector<double>
    change() const
    {
      Vector<double> c(face_change.size()), v(y);
      solver.face_factor.Tvmult(c, face_change);
      std::copy(c.begin(), c.end(), v.end() - c.size());
      return v;
    }

    const SchurSolver       &solver;
    const ContactLayout     &face;
    const DistributedVector &load;
    DistributedVector       &u;
    Vector<double>           y, face_load, face_change, correction, product;
    FaceTruncation           truncation;
    double                   squared_norm; // of the start
    /// L^{-1} load, once it has been asked for.
    mutable Vector<double> forward_load;
  };



  double
  SchurSolver::Solve::energy_norm() const
  {
    // Begun at g, u = g + L^{-T} v.
    const Vector<double> v   = change();
    double               sum = squared_norm + v.norm_sqr();
    // Prescribed values that jump begin with a large energy in the cells beside
    // them, which v takes back. Otherwise one of the two is much smaller, and
    // the product of both, which takes another solve, does not count.
    constexpr double apart = 1e-2;
    if (std::min(squared_norm, v.norm_sqr()) >
        apart * std::max(squared_norm, v.norm_sqr()))
      {
        // A g = load - r, and L y = r.
        if (forward_load.size() == 0)
          forward_load = solver.forward(load);
        sum += 2. * (v * forward_load - v * y);
      }
    // Of a translation it is rounding, of either sign.
    return std::sqrt(std::max(0., sum));
  }



  unsigned int
  SchurSolver::Solve::correct(const Vector<double> &force,
                              const double          tolerance,
                              Vector<double>       &w)
  {
    product = face_residual();
    product -= force;
    truncation.tilt_equations(face, product);
    truncation.project(face, product);
    w                 = 0.;
    const double size = product.l2_norm();
    if (size == 0.)
      return 0;

    NodalBlocks blocks{face, std::vector<Tensor<2, 3>>(face.n_nodes())};
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      {
        // Blocked directions get a multiple of the identity, which keeps the
        // block regular, of the size of the others.
        const Tensor<2, 3> &P = truncation.projector[n];
        const Tensor<2, 3>  stiffness =
          solver.schur_complement->diagonal_block(n);
        const double one   = stiffness.norm();
        Tensor<2, 3> block = P * (stiffness + truncation.spring[n]) * P;
        for (unsigned int d = 0; d < 3; ++d)
          for (unsigned int e = 0; e < 3; ++e)
            block[d][e] += one * ((d == e ? 1. : 0.) - P[d][e]);
        blocks.inverse[n] = P * invert(block) * P;
      }
    // A small face problem costs nothing: solve it to the end, and the active
    // set iteration is finite in 2D. In a large one, follow the caller.
    const double reduction =
      face.n_dofs() <= 600 ? 1e-13 : std::max(1e-13, 0.01 * tolerance);
    SolverControl control(std::max(100u, 4 * face.n_dofs()), reduction * size);
    const TruncatedFace system{solver.schur_complement->matrix(),
                               face,
                               truncation};
    try
      {
        if (truncation.tilt.empty())
          SolverCG<Vector<double>>(control).solve(system, w, product, blocks);
        else
          SolverGMRES<Vector<double>>(
            control,
            SolverGMRES<Vector<double>>::AdditionalData(
              /* max_n_tmp_vectors = */ 200,
              /* right_preconditioning = */ true))
            .solve(system, w, product, blocks);
      }
    catch (const SolverControl::NoConvergence &)
      {
        // Rounding stopped it; the line search and the error bound judge what
        // came out.
      }
    truncation.tilt_motions(face, w);
    return 0;
  }



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



  std::unique_ptr<ContactSolve>
  SchurSolver::begin(const DistributedVector &load,
                     DistributedVector       &u,
                     const SolutionScale     &scale)
  {
    return std::make_unique<Solve>(*this, load, u, scale);
  }
} // namespace Viscoplastic
