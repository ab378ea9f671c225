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
    /// A linear solve that shall bring the error below the tolerance aims at
    /// this part of it.
    static constexpr double safety = 0.3;
    /// After so many iterations that have not halved the error, it may be what
    /// rounding leaves of the residual.
    static constexpr unsigned int stalled_after = 15;

    /// (1) Nonlinear Gauss-Seidel over the face nodes.
    void
    relax(const unsigned int n_sweeps);

    /// The Gauss-Seidel step at one node; adds it to @p change.
    void
    relax_node(const unsigned int node, Vector<double> &change);

    /// Whether the error bound is within the tolerance; then the multipliers
    /// are those that prove it.
    bool
    is_solved();

    /// Whether the iteration has come to rest above the tolerance with an error
    /// that is rounding of the residual; then this is the rounding error of the
    /// bulk.
    bool
    is_rounding(const Certificate &certificate);

    /// The bound on the error in the energy norm that follows from @p
    /// dual_norm, that of the residual, and the complementarity defect of @p
    /// certificate.
    double
    bound(const double dual_norm, const Certificate &certificate);

    /// (2) The linear solve on the truncated space: a correction w.
    void
    correct();

    /// (3) Go along w as far as J decreases, no slip further than to rest and
    /// no node further than to its obstacle.
    /// Returns the change of J.
    double
    search();

    /// (4) Let the bulk follow the face.
    void
    follow();

    void
    give_up();

    /// What a solve without friction would have taken.
    double
    plain_seconds(const double seconds_to_finish) const;

    ContactSolve        &bulk;
    const ContactLayout &face;
    const double         tolerance;
    /// The increment of the face, and what contact does there.
    Vector<double> &x;
    ContactState   &state;
    /// Coulomb's law of the step's own pressure; null where bounds are given.
    const CoulombLaw *const law;

    const FaceMatrix         &matrix;
    std::vector<Tensor<2, 3>> diagonal, inverse_diagonal; // node by node
    std::vector<double>       rounding; // of steps of nodes, relative
    /// With a law.
    std::optional<CoulombBounds> bounds;

    /// l - A u, the forces of the multipliers that fit it, and a correction, on
    /// the face.
    Vector<double> residual, force, w;
    /// The present one, and whether the last correction was made with the same
    /// sticking points.
    FaceTruncation truncation;
    bool           same_sets = false;
    /// The sets of the start, and where there are obstacles those of the last
    /// correction.
    const std::vector<bool> first_sets;
    std::vector<bool>       last_sets;
    /// Bound on the error and size of the solution in the energy norm.
    double error = 0., size = 0.;
    /// The dual norm over its estimate when this was found too low.
    double misjudged  = 1.;
    double best_error = std::numeric_limits<double>::max();
    /// The iteration that has halved that last, and that before which rounding
    /// is not to be asked for again.
    unsigned int last_gain = 0, next_question = stalled_after;
    /// The error of the start over the tolerance.
    double first_ratio = 0.;
    /// Wall time of the corrections, and by how many powers of ten they were to
    /// reduce their residuals.
    double correction_seconds = 0., decades = 0.;

    ContactReport report;
  };
} // namespace Viscoplastic
