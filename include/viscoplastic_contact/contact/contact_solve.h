// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/contact/face_matrix.h>

#include <algorithm>

namespace Viscoplastic
{
  /// Scales in the energy norm that are known before a solve.
  struct SolutionScale
  {
    /// An error that rounding leaves in any case, and that counts as zero. It
    /// is all that remains if a body moves without strain or its loads cancel.
    double rounding_error = 0.;
    /// The norm of the solution of the step before: errors are relative to it
    /// where a body is relieved of all loads, so that its solution vanishes.
    double former_size = 0.;
  };


  /// A solve for a displacement u in progress, as contact solvers see it: the
  /// energy 1/2 a(u,u) - l(u) of everything but contact. It holds the data that
  /// it needs of l and u; BulkSolver::begin() creates it.
  ///
  /// A contact solver moves the displacement by the calls below and sees only
  /// its values on the face, so it needs neither a mesh nor distributed
  /// vectors.
  ///
  /// All calls are collective. Face vectors have the nodes of this rank, all
  /// other results are the same on all ranks.
  class ContactSolve
  {
  public:
    /// @p face_matrix: null without contact points. @p is_exact: whether
    /// corrections leave nothing but rounding, whatever their tolerance.
    ContactSolve(const FaceMatrix    *face_matrix,
                 const bool           is_exact,
                 const SolutionScale &scale = {})
      : is_exact(is_exact)
      , scale(scale)
      , matrix(face_matrix)
    {}

    virtual ~ContactSolve() = default;

    const bool is_exact;
    /// The contact solver may raise `scale.rounding_error`.
    SolutionScale scale;

    /// The matrix F of the face for Gauss-Seidel sweeps: move_face(w) changes
    /// face_residual() by -F w.
    const FaceMatrix &
    face_matrix() const
    {
      return *matrix;
    }

    /// The residual l - A u on the face, a face vector of forces.
    virtual Vector<double>
    face_residual() const = 0;

    /// Add @p change, a face vector, to the displacement of the face.
    virtual void
    move_face(const Vector<double> &change) = 0;

    /// Set the truncated space and springs for the calls below. Without @p
    /// may_rebuild the truncation is temporary, and preconditioners are kept.
    virtual void
    set_truncation(const FaceTruncation &truncation,
                   const bool            may_rebuild = true) = 0;

    /// The norm of l - A u - force in the dual of the energy norm; @p force is
    /// a face vector. This bounds the algebraic error. Exact for direct
    /// solvers, an estimate by the preconditioner otherwise.
    virtual double
    dual_norm(const Vector<double> &force) = 0;

    /// dual_norm() independent of the quality of a preconditioner, for the
    /// final decision; adds its iterations to @p iterations. If the norm is
    /// above @p limit, any value between the two may be returned.
    virtual double
    confirmed_dual_norm(const Vector<double> &force,
                        const double /*limit*/,
                        unsigned int & /*iterations*/)
    {
      return dual_norm(force);
    }

    /// The dual_norm() of an error of l - A u that is one unit of rounding of
    /// the terms of each row, with random signs: a limit for the accuracy of
    /// any solver. It is large for flat cells, strongly varying stiffness and
    /// nearly incompressible bodies. Costs as much as a few solves.
    virtual double
    rounding_of_residual() = 0;

    /// The energy norm of the displacement; zero for rigid translations.
    virtual double
    energy_norm() const = 0;

    /// The norm to which relative errors refer.
    double
    size() const
    {
      return std::max(energy_norm(), scale.former_size);
    }

    /// Solve (tilt A + springs) w = tilt (l - A u - force) on the truncated
    /// space to the relative accuracy @p tolerance; returns the face part in @p
    /// w and the number of linear iterations. For a transposed truncation, w =
    /// tilt^T v with (A tilt^T + springs) v = l - A u - force.
    virtual unsigned int
    correct(const Vector<double> &force,
            const double          tolerance,
            Vector<double>       &w) = 0;

    /// The terms of a line search along a correction w: slope (l - A u) . w,
    /// curvature w . A w, and the response A w on the face.
    struct SearchTerms
    {
      double         slope, curvature;
      Vector<double> response = {};
    };

    /// Replace the face part of the last correction by @p w, and return the
    /// terms of the line search along it.
    virtual SearchTerms
    search_terms(const Vector<double> &w) = 0;

    /// u := u + step w, with w as search_terms() has prepared it.
    virtual void
    take_step(const double step) = 0;

    /// Complete the displacement passed to BulkSolver::begin(), and end the
    /// solve. Returns the number of linear iterations that this took.
    virtual unsigned int
    finish()
    {
      return 0;
    }

    /// Whether the system of correct(), which tilts make nonsymmetric, has a
    /// negative determinant, as far as that is known.
    virtual bool
    has_negative_determinant() const
    {
      return false;
    }

    /// The norm of dual_norm() on the truncated space alone, which is no
    /// larger. It costs nothing if correct() follows with the same force.
    virtual double
    truncated_dual_norm(const Vector<double> &force)
    {
      return dual_norm(force);
    }

  private:
    const FaceMatrix *const matrix;
  };


  /// Solve (A + springs) u = l - force with the active sets of a @p truncation,
  /// starting from the displacement of @p solve, and finish that solve. Each
  /// correction is solved to the relative accuracy @p reduction; as long as it
  /// is larger in the energy norm than @p enough times the solution, another
  /// one follows, a few at most. The remaining error is not measured: use this
  /// in preconditioners, or where one solves again or counts the residual as an
  /// error. Preconditioners are kept unless @p is_kept (see
  /// ContactSolve::set_truncation()). Returns the linear iterations.
  unsigned int
  solve_truncated(ContactSolve         &solve,
                  const ContactLayout  &face,
                  const FaceTruncation &truncation,
                  const bool            is_kept,
                  Vector<double>        force,
                  const double          reduction,
                  const double          enough);
} // namespace Viscoplastic
