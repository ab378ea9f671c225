// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/contact/face_matrix.h>

#include <algorithm>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /**
   * What an iterative solver has learnt from earlier solves with a matrix and
   * uses in later ones: how its preconditioner was built, and how it is doing.
   */
  struct PreconditionerState
  {
    /// The truncation for which it was built.
    FaceTruncation built_for;
    /// Iterations a decade right after a set-up, the best so far; iterations
    /// lost against that since the last set-up.
    double best_rate = 0., lost_iterations = 0.;
    /// Whether it has not been used since.
    bool is_fresh = false;
  };


  /**
   * The constant elastic operator as solvers of contact see it: the energy
   * 1/2 a(u,u) - l(u) with everything but contact. It is set up once a mesh;
   * only the truncation of the face changes from solve to solve.
   *
   * The displacement stays inside. A contact solver moves it by the calls below
   * and sees only its values on the face, so it needs neither a mesh nor
   * distributed vectors, and another method for linear systems (a multigrid
   * with masks on all levels) is a new derived class and nothing else.
   *
   * All calls are collective. Face vectors are of the nodes of this rank, all
   * other results the same on all ranks.
   */
  class BulkSolver
  {
  public:
    virtual ~BulkSolver() = default;

    /// The state to go on from later; nothing if all solves are alike.
    virtual std::optional<PreconditionerState>
    preconditioner_state() const
    {
      return {};
    }

    /// Go on like the solver that was in this state, on the same mesh; without
    /// one like a new solver.
    virtual void
    restore(const std::optional<PreconditionerState> &)
    {}

    /**
     * The matrix has other values in the same pattern: adapt. Returns false if
     * @p matrix is another object or a new solver is as good; then this one is
     * of no use any more.
     */
    virtual bool
    renew(const DistributedMatrix & /*matrix*/)
    {
      return false;
    }

    /// Whether solve() leaves nothing but rounding, whatever its tolerance.
    virtual bool
    is_exact() const = 0;

    /// What the solver is called in messages, e.g. "direct (CHOLMOD)".
    virtual std::string
    name() const = 0;

    /**
     * Solve a(u,v) = l(v) without contact. @p u brings the prescribed values
     * and a start, and takes the solution up; @p load and @p u are in frames.
     * Stops at the relative energy error @p tolerance. Returns the number of
     * linear iterations (1 for a direct solver). Throws ExcMessage.
     */
    virtual unsigned int
    solve(const DistributedVector &load,
          DistributedVector       &u,
          const double             tolerance) = 0;

    /**
     * Begin a solve with contact at @p u; both vectors stay in use until
     * finish().
     */
    virtual void
    begin(const DistributedVector &load, DistributedVector &u) = 0;

    /// The matrix for Gauss-Seidel sweeps whose effect move_face() has.
    virtual const FaceMatrix &
    face_matrix() const = 0;

    /// l - A u on the face.
    virtual void
    face_residual(Vector<double> &r) = 0;

    /// Change the displacement of the face.
    virtual void
    move_face(const Vector<double> &change) = 0;

    /// How the calls below treat the face. A truncation that is only tried
    /// must not be what a solver adapts its set-up to.
    virtual void
    set_truncation(const FaceTruncation &truncation,
                   const bool            may_rebuild = true) = 0;

    /**
     * The norm of l - A u - force in the dual of the energy norm; @p force is a
     * face vector. This bounds the algebraic error. Exact for direct solvers,
     * an estimate by the preconditioner otherwise.
     */
    virtual double
    dual_norm(const Vector<double> &force) = 0;

    /// dual_norm() without the quality of a preconditioner in it, for the
    /// final word; adds its iterations to @p iterations. Of a norm above @p
    /// limit something between both may be all that is found out.
    virtual double
    confirmed_dual_norm(const Vector<double> &force,
                        const double          limit,
                        unsigned int         &iterations) = 0;

    /**
     * What dual_norm() makes of l - A u if each of its rows is off by a unit of
     * rounding of its terms, this way or that by chance. Flat cells, stiffness
     * that differs and bodies next to incompressible make much of it. No solver
     * can do better, nor are the entries of A any better known. As dear as some
     * solves.
     */
    virtual double
    rounding_of_residual() = 0;

    /// The energy norm of the present displacement. Zero for rigid
    /// translations, hence the next ones.
    virtual double
    energy_norm() const = 0;

    /// What errors are compared with.
    double
    size() const
    {
      return std::max(energy_norm(), scale.former_size);
    }

    /// What the right-hand side and its start say of sizes in the energy norm.
    struct Scale
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

    /// Belongs to the right-hand side that is solved for next.
    void
    set_scale(const Scale &scale_)
    {
      scale = scale_;
    }

    const Scale &
    get_scale() const
    {
      return scale;
    }

    /// Rounding has turned out to make more.
    void
    set_rounding_error(const double error)
    {
      scale.rounding_error = error;
    }

    double
    rounding_error() const
    {
      return scale.rounding_error;
    }

    /**
     * Solve (tilt A + springs) w = tilt (l - A u - force) on the truncated
     * space to the relative accuracy @p tolerance; returns the face part in @p
     * w and the number of linear iterations. Of a transposed truncation, w =
     * tilt^T v with (A tilt^T + springs) v = l - A u - force.
     */
    virtual unsigned int
    correct(const Vector<double> &force,
            const double          tolerance,
            Vector<double>       &w) = 0;

    /// (l - A u) . w and w . A w of a correction.
    struct SearchTerms
    {
      double slope, curvature;
    };

    /// Replace the face part of the correction by @p w and prepare its use.
    virtual SearchTerms
    search_terms(const Vector<double> &w) = 0;

    /// A w on the face, with w as search_terms() has prepared it.
    virtual void
    face_response(Vector<double> &response) = 0;

    /// u := u + step w.
    virtual void
    take_step(const double step) = 0;

    /// Complete the displacement given to begin(). Returns the linear
    /// iterations this took.
    virtual unsigned int
    finish() = 0;

  private:
    Scale scale;
  };
} // namespace Viscoplastic
