// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/contact_report.h>
#include <viscoplastic_contact/contact/contact_solve.h>
#include <viscoplastic_contact/contact/coulomb_bounds.h>
#include <viscoplastic_contact/contact/coulomb_law.h>

#include <limits>
#include <optional>
#include <vector>

namespace Viscoplastic
{
  /// The iteration of one call of ContactSolver::solve(): its data and the four
  /// phases of the method, which is explained there.
  class ContactIteration
  {
  public:
    ContactIteration(ContactSolve        &bulk,
                     const ContactLayout &face,
                     const double         tolerance,
                     Vector<double>      &x,
                     ContactState        &state,
                     const CoulombLaw    *law,
                     const bool           is_near = false);

    ContactReport
    solve(const unsigned int max_iterations);

    /// Iterate to the tolerance, as solve() does, but leave out
    /// ContactSolve::finish().
    void
    iterate(const unsigned int max_iterations);

  private:
    /// A linear solve meant to be the last one aims at this fraction of the
    /// tolerance.
    static constexpr double safety = 0.3;
    /// is_rounding() is called after this many iterations that have not halved
    /// the error.
    static constexpr unsigned int stalled_after = 15;

    /// (1) Nonlinear Gauss-Seidel over the face nodes.
    void
    relax(const unsigned int n_sweeps);

    /// Minimize J over the displacement of one node; adds the step to @p
    /// change.
    void
    relax_node(const unsigned int node, Vector<double> &change);

    /// Whether the error bound is within the tolerance; then the multipliers
    /// are those that prove it.
    bool
    is_solved();

    /// Whether the iteration has stalled with an error that is rounding of the
    /// residual. If so, raises `bulk.scale.rounding_error` to this error.
    bool
    is_rounding(const Certificate &certificate);

    /// Return the bound on the energy error that follows from @p dual_norm, the
    /// dual norm of the residual, and from the defect of @p certificate. Sets
    /// the duality gap and the relative error of the report.
    double
    bound(const double dual_norm, const Certificate &certificate);

    /// (2) The linear solve on the truncated space: a correction w.
    void
    correct();

    /// (3) Line search: take the step along w that minimizes J, where slips do
    /// not reverse and nodes stop at obstacles. Returns the change of J.
    double
    search();

    /// (4) Solve for the interior with the face displacement held.
    void
    follow();

    void
    give_up();

    /// The estimated wall time of the same solve without friction, in seconds.
    double
    plain_seconds(const double seconds_to_finish) const;

    ContactSolve        &bulk;
    const ContactLayout &face;
    const double         tolerance;
    /// The displacement increment, multipliers and active sets of the face.
    Vector<double> &x;
    ContactState   &state;
    /// Coulomb's law of the step's own pressure; null where bounds are given.
    const CoulombLaw *const law;

    const FaceMatrix         &matrix;
    std::vector<Tensor<2, 3>> diagonal, inverse_diagonal; // node by node
    std::vector<double>       rounding; // of nodal steps, relative
    /// The bounds of Coulomb's law; absent where bounds are given.
    std::optional<CoulombBounds> bounds;

    /// Face vectors: the residual l - A u, the forces of the multipliers
    /// nearest to it, and the correction.
    Vector<double> residual, force, w;
    /// The truncation by the present active sets, and whether the last
    /// correction had the same sticking points.
    FaceTruncation truncation;
    bool           same_sets = false;
    /// The active sets of the start and, where there are obstacles, of the last
    /// correction.
    const std::vector<bool> first_sets;
    std::vector<bool>       last_sets;
    /// In the energy norm: a bound on the error, and the norm of the solution.
    double error = 0., size = 0.;
    /// The factor by which the estimated dual norm was found too low.
    double misjudged  = 1.;
    double best_error = std::numeric_limits<double>::max();
    /// The last iteration that has halved best_error, and the first in which
    /// is_rounding() may be asked again.
    unsigned int last_gain = 0, next_question = stalled_after;
    /// The error of the start over the tolerance.
    double first_ratio = 0.;
    /// Wall time of the corrections, and the sum of the powers of ten by which
    /// they were to reduce residuals.
    double correction_seconds = 0., decades = 0.;

    ContactReport report;
  };
} // namespace Viscoplastic
