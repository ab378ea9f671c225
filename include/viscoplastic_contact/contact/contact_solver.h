// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/contact_report.h>
#include <viscoplastic_contact/contact/contact_solve.h>
#include <viscoplastic_contact/contact/coulomb_law.h>

namespace Viscoplastic
{
  /// Minimizes the energy of one step,
  ///
  ///     J(u) = 1/2 a(u,u) - l(u) + sum_c rho_c |s_c|,
  ///     s_c = B_c (u - u_prev) - w_c,
  ///
  /// where s_c <= d_c at obstacles (unilateral contact, Signorini's
  /// conditions), by a primal-dual active set iteration that cannot cycle: (1)
  /// nonlinear Gauss-Seidel over the face nodes, which minimizes J node by
  /// node, decides which points stick and in which direction the others slip;
  /// (2) a linear solve on the truncated space with the tangent stiffness of
  /// turning slip is a semismooth Newton step; (3) increments that would
  /// reverse a slip stop at stick, those that would enter an obstacle stop
  /// there, and a line search minimizes J along the rest. Where that gains
  /// little, the reversing points are brought to rest first, or the correction
  /// is taken unmodified, which is always a descent direction. J never
  /// increases, so no set comes twice (compare Kornhuber's monotone multigrid
  /// and TNNMG by Graeser and Sander, where (1) covers all unknowns; here the
  /// linear solve covers the bulk).
  ///
  /// The iteration stops when the duality gap bounds the error: with
  /// multipliers in their balls, pressures p >= 0, the remaining residual R and
  /// the defect eps = sum rho |s| - lambda . s + sum p (d - s) of
  /// complementarity, gap = 1/2 |R|^2 + eps in the dual energy norm and |error|
  /// <= (|R| + sqrt(|R|^2 + 4 eps))/2. The multipliers satisfy the laws of
  /// contact exactly (eps = 0), except at points that have hardly begun to
  /// slip.
  ///
  /// With Coulomb's law for the pressure of the step itself there is no J, but
  /// the phases stay: (1) nodes obey the law itself, (2) the linear system
  /// contains the change of bounds with pressures (CoulombLaw), and (3) J is
  /// that of the bounds predicted by (2), for which the correction is a Newton
  /// step. Convergence is as fast as with given bounds, but not guaranteed:
  /// where the error does not fall, bounds are held for a while and then
  /// relaxed toward the pressures (CoulombBounds).
  /// CoulombBounds::error_with_bounds() has the stopping criterion.
  class ContactSolver
  {
  public:
    explicit ContactSolver(const unsigned int max_iterations);

    /// @p increment: face part of u - u_prev at the start given to
    /// BulkSolver::begin(), and of the solution on return; @p state: the
    /// bounds, and the sets and multipliers to start from, which become those
    /// of the solution; @p tolerance: the relative error at which to stop.
    ///
    /// The report estimates the time of a solve without contact: for an exact
    /// solver, that of completing the displacement, to which the caller adds
    /// that of its beginning; for an iterative one, the seconds per decade of
    /// corrections times the decades from the first error to the tolerance.
    ///
    /// With a @p law, the friction bounds are those of the computed pressures.
    ///
    /// Collective. Throws ExcMessage when the iteration is exhausted or a value
    /// is not finite: there is no unconverged result.
    ContactReport
    solve(ContactSolve        &bulk,
          const ContactLayout &face,
          const double         tolerance,
          Vector<double>      &increment,
          ContactState        &state,
          const CoulombLaw    *law = nullptr) const;

  private:
    const unsigned int max_iterations;
  };
} // namespace Viscoplastic
