// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/contact/face_matrix.h>

#include <algorithm>

namespace Viscoplastic
{
  /// What is known before a solve, in the energy norm: its rounding error and
  /// the norm of the last solution.
  struct SolutionScale
  {
    /// An error that rounding leaves in any case, and that counts as none: of
    /// a body that moves without strain, or whose loads balance, nothing else
    /// remains.
    double rounding_error = 0.;
    /// The norm of the solution of the step before. A body that is relieved
    /// of all loads has none in the end, and its error is relative to what it
    /// had.
    double former_size = 0.;
  };


  /// One solve for a displacement u under way, as solvers of contact see it:
  /// the energy 1/2 a(u,u) - l(u) with everything but contact. It owns what it
  /// needs of l and u; BulkSolver::begin() makes it.
  ///
  /// A contact solver moves the displacement by the calls below and sees only
  /// its values on the face, so it needs neither a mesh nor distributed
  /// vectors.
  ///
  /// All calls are collective. Face vectors are of the nodes of this rank, all
  /// other results the same on all ranks.
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
    /// Solves may raise its rounding error.
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

    /// Set which points stick or slip in the calls below. Without @p
    /// may_rebuild the truncation is only tried, and a solver keeps its
    /// preconditioner.
    virtual void
    set_truncation(const FaceTruncation &truncation,
                   const bool            may_rebuild = true) = 0;

    /// The norm of l - A u - force in the dual of the energy norm; @p force is
    /// a face vector. This bounds the algebraic error. Exact for direct
    /// solvers, an estimate by the preconditioner otherwise.
    virtual double
    dual_norm(const Vector<double> &force) = 0;

    /// dual_norm() without the quality of a preconditioner in it, for the
    /// final word; adds its iterations to @p iterations. Of a norm above @p
    /// limit something between both may be all that is found out.
    virtual double
    confirmed_dual_norm(const Vector<double> &force,
                        const double /*limit*/,
                        unsigned int & /*iterations*/)
    {
      return dual_norm(force);
    }

    /// What dual_norm() makes of l - A u if each of its rows is off by a unit
    /// of rounding of its terms, this way or that by chance. Flat cells,
    /// stiffness that differs and bodies next to incompressible make much of
    /// it. No solver can do better, nor are the entries of A any better known.
    /// As dear as some solves.
    virtual double
    rounding_of_residual() = 0;

    /// The energy norm of the present displacement. Zero for rigid
    /// translations.
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
    /// w and the number of linear iterations. Of a transposed truncation, w =
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

    /// Replace the face part of the correction by @p w and prepare its use.
    virtual SearchTerms
    search_terms(const Vector<double> &w) = 0;

    /// u := u + step w, with w as search_terms() has prepared it.
    virtual void
    take_step(const double step) = 0;

    /// Complete the displacement given at the beginning, and end. Returns the
    /// linear iterations this took.
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
    /// larger. It costs nothing where correct() follows with the same force.
    virtual double
    truncated_dual_norm(const Vector<double> &force)
    {
      return dual_norm(force);
    }

  private:
    const FaceMatrix *const matrix;
  };


  /// Solve (A + springs) u = l - force with the sets of a @p truncation, from
  /// where @p solve is, and finish it. Corrections are solved to the relative
  /// accuracy @p reduction, which is one of the start: where that is larger in
  /// the energy norm than @p enough solutions, a correction is corrected in its
  /// turn, a few times at most, and nobody has measured what is left then: for
  /// preconditioners, and for what is solved for again or whose residual counts
  /// as an error. A truncation that is not to be kept leaves
  /// preconditioners as they are (see ContactSolve::set_truncation()). Returns
  /// the linear iterations of the corrections.
  unsigned int
  solve_truncated(ContactSolve         &solve,
                  const ContactLayout  &face,
                  const FaceTruncation &truncation,
                  const bool            is_kept,
                  Vector<double>        force,
                  const double          reduction,
                  const double          enough);
} // namespace Viscoplastic
