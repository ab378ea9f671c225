// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/residual_rounding.h>
#include <viscoplastic_contact/linear_solvers/schur_solver.h>

#include <algorithm>
#include <cmath>

// Solve contact problems on the face with the Schur complement of the bulk.

extern "C" void
dsymv_(const char   *triangle,
       const int    *n,
       const double *alpha,
       const double *matrix,
       const int    *leading_dimension,
       const double *x,
       const int    *increment_of_x,
       const double *beta,
       double       *y,
       const int    *increment_of_y);

namespace Viscoplastic
{
  namespace
  {
    /// The number of face unknowns up to which solves cost next to nothing.
    constexpr unsigned int small_face = 600;



    /// y := S x by BLAS, which reads one triangle of S. deal.II's product reads
    /// all of S and adds up sequentially.
    void
    multiply(const FullMatrix<double> &S,
             const Vector<double>     &x,
             Vector<double>           &y)
    {
      const int    n = x.size(), increment = 1;
      const double one = 1., zero = 0.;
      if (n > 0)
        dsymv_("L",
               &n,
               &one,
               &S(0, 0),
               &n,
               x.begin(),
               &increment,
               &zero,
               y.begin(),
               &increment);
    }



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
        multiply(S, motion(x), y);
        complete(x, y);
      }

      /// The motion that S acts on: @p x, tilted if the truncation says so.
      Vector<double>
      motion(const Vector<double> &x) const
      {
        Vector<double> result(x);
        if (truncation.transposed)
          truncation.tilt_motions(face, result);
        return result;
      }

      /// Complete y = S motion(x) to the product of this matrix with @p x.
      void
      complete(const Vector<double> &x, Vector<double> &y) const
      {
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



    /// LU factors of TruncatedFace as a dense matrix, with the diagonal of S
    /// scaled to 1, and the identity where motions are blocked.
    struct DenseFactors
    {
      const TruncatedFace      system;
      Vector<double>           scale;
      LAPACKFullMatrix<double> matrix;

      explicit DenseFactors(const TruncatedFace &system)
        : system(system)
        , scale(system.S.m())
        , matrix(scale.size())
      {
        Vector<double> unit(scale.size()), column(unit);
        for (unsigned int i = 0; i < scale.size(); ++i)
          scale[i] = 1. / std::sqrt(system.S(i, i));
        for (unsigned int j = 0; j < scale.size(); ++j)
          {
            unit    = 0.;
            unit[j] = 1.;
            system.truncation.project(system.face, unit);
            // The motion is that of one node, so a few columns of S suffice.
            const Vector<double> motion = system.motion(unit);
            column                      = 0.;
            for (unsigned int k = 0; k < motion.size(); ++k)
              if (motion[k] != 0.)
                for (unsigned int i = 0; i < column.size(); ++i)
                  column[i] += system.S(i, k) * motion[k];
            system.complete(unit, column);
            for (unsigned int i = 0; i < scale.size(); ++i)
              matrix(i, j) = scale[i] * column[i] * scale[j] -
                             scale[j] / scale[i] * unit[i] + (i == j ? 1. : 0.);
          }
        matrix.compute_lu_factorization();
      }

      void
      solve(Vector<double> &x) const
      {
        x.scale(scale);
        matrix.solve(x);
        x.scale(scale);
        system.truncation.project(system.face, x);
      }
    };



    /// A preconditioner of TruncatedFace by inverse blocks of nodes.
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



  /// A contact solve after the forward substitution, in which the bulk is
  /// always in equilibrium with the face.
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
      , residual(face_load)
    {
      DistributedVector of_start(load);
      solver.matrix.vmult(of_start, u);
      squared_norm = u * of_start;
      of_start.sadd(-1., 1., load);
      y = solver.forward(of_start);
      if (face.n_dofs() == 0)
        return;
      // y = (y_i, y_c); the face's load after condensation is L_cc y_c.
      std::copy(y.end() - face.n_dofs(), y.end(), product.begin());
      solver.face_factor.vmult(face_load, product);
    }

    Vector<double>
    face_residual() const override
    {
      if (!residual_is_known)
        {
          multiply(solver.schur_complement->matrix(), face_change, residual);
          residual.sadd(-1., 1., face_load);
          residual_is_known = true;
        }
      return residual;
    }

    void
    move_face(const Vector<double> &change) override
    {
      face_change += change;
      residual_is_known = false;
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

    bool
    has_negative_determinant() const override
    {
      if (face.n_dofs() > small_face)
        return false;
      try
        {
          return DenseFactors(
                   {solver.schur_complement->matrix(), face, truncation})
                   .matrix.determinant() < 0.;
        }
      catch (const LACExceptions::ExcSingular &)
        {
          return false;
        }
    }

    SearchTerms
    search_terms(const Vector<double> &w) override
    {
      correction = w;
      multiply(solver.schur_complement->matrix(), correction, product);
      return {face_residual() * correction, product * correction, product};
    }

    void
    take_step(const double step) override
    {
      face_change.add(step, correction);
      residual_is_known = false;
    }

    unsigned int
    finish() override
    {
      solver.backward(change(), u);
      return 1;
    }

  private:
    /// L^T times the change of the displacement since the solve began: (y_i,
    /// L_cc^T face_change).
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
    /// The residual at face_change, cached for three uses an iteration.
    mutable Vector<double> residual;
    mutable bool           residual_is_known = false;
    /// L^{-1} load; empty until it is needed.
    mutable Vector<double> forward_load;
  };



  double
  SchurSolver::Solve::energy_norm() const
  {
    // The solve began at g, so that u = g + L^{-T} v.
    const Vector<double> v   = change();
    double               sum = squared_norm + v.norm_sqr();
    // The mixed term takes another solve and is left out where g or v is small,
    // which changes the norm by some 10 % at most. Both are large where
    // prescribed values jump: cells beside them begin with a large energy.
    constexpr double apart = 1e-2;
    if (std::min(squared_norm, v.norm_sqr()) >
        apart * std::max(squared_norm, v.norm_sqr()))
      {
        // A g = load - r, and L y = r.
        if (forward_load.size() == 0)
          forward_load = solver.forward(load);
        sum += 2. * (v * forward_load - v * y);
      }
    // The energy of a translation is rounding, of either sign.
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
        // Blocked directions get a multiple of the identity of the size of the
        // stiffness, which keeps the block regular.
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
    // Solve a small face problem to rounding, so that the active set iteration
    // is finite in 2D, and a large one to the tolerance of the caller.
    const bool   is_small = face.n_dofs() <= small_face;
    const double reduction =
      is_small ? 1e-13 : std::max(1e-13, 0.01 * tolerance);
    SolverControl control(std::max(100u, (is_small ? 1 : 4) * face.n_dofs()),
                          reduction * size);
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
        // Rounding stopped the iteration. A small system is factorized; the
        // line search and the error bound judge the result.
        if (is_small)
          DenseFactors(system).solve(w = product);
      }
    truncation.tilt_motions(face, w);
    return 0;
  }



  std::unique_ptr<ContactSolve>
  SchurSolver::begin(const DistributedVector &load,
                     DistributedVector       &u,
                     const SolutionScale     &scale)
  {
    return std::make_unique<Solve>(*this, load, u, scale);
  }
} // namespace Viscoplastic
