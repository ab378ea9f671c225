// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/coulomb_law.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/discretization/force_balance.h>
#include <viscoplastic_contact/discretization/point_probe.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver.h>

#include <map>
#include <optional>

namespace Viscoplastic
{
  /// The solution w of a dual problem.
  template <int dim>
  struct DualSolution
  {
    /// The dual displacement w, in nodal frames (owned entries), and in
    /// Cartesian components with ghosts.
    DistributedVector w, cartesian;
    /// The constraint forces of w on Gamma_3: nodal forces, empty without
    /// contact points; and, Cartesian with ghosts, the nodal density of these
    /// and of the forces between glued bodies.
    Vector<double>    force;
    DistributedVector density;
    /// The traction, equivalent for u_h up to h^2, that replaces the point
    /// force loading w at the boundary; null without such a load.
    const DistributedVector *load = nullptr;
    /// a(w, w)^{1/2}.
    double norm = 0.;
    /// The constraints of w at sticking points and the springs at slipping
    /// ones; empty without a face.
    FaceTruncation truncation;
  };


  /// The dual problem of a quantity J, which gives the change of J due to a
  /// residual R of the equations of a step,
  ///
  ///     a(u, v) + (z, eps(v)) + sum_c lambda_c . v_c = L(v) + R(v),
  ///
  /// with the friction law linearized at a state: sticking points stay stuck,
  /// and the multiplier of a slipping point changes with the direction of its
  /// slip only, d(lambda) = K d(s) with K = rho/|s| across the slip (zero in
  /// the plane). The change of J is then
  ///
  ///     J' = sign R(w),   a(w, v) + sum_slipping K w_c . v_c = l(v)
  ///
  /// for all v in V_h that are zero where points stick, where
  ///
  /// - of the displacement of a point, l is its component: sign = 1;
  /// - of a reaction, l = 0, and w is the unit direction on the boundary
  ///   instead of zero: sign = -1;
  /// - of the friction force, l = 0, w is the unit direction at sticking
  ///   points, and w_c minus this direction takes the place of w_c at slipping
  ///   ones: sign = 1;
  /// - of the contact force likewise, along the normals where contact is
  ///   closed, with K the slope of the pressure of a compliant foundation: sign
  ///   = 1; for friction or contact of one boundary, times the share of a
  ///   point's area on that boundary;
  /// - of the work of friction in all steps, while slip keeps its direction,
  ///   l(v) = sum_slipping lambda_c . v_c; if bounds follow the pressure of the
  ///   step itself, w along the normals is that of a contact force with each
  ///   pressure weighted by mu times the slip up to now: sign = 1.
  ///
  /// With Coulomb's law for the pressure of the step itself, lambda_c of a
  /// slipping point also changes with its pressure, and its equations are those
  /// of CoulombLaw::tilt(). The dual system is the transposed one: v is still
  /// zero normal to the foundation there, but w has a normal component of mu
  /// times its component along the slip.
  template <int dim>
  class DualProblem
  {
  public:
    /// Keeps references to both. Collective.
    DualProblem(const Discretization<dim> &discretization,
                const QuantityOfInterest  &quantity);

    /// Return J of a state; for the work of friction, that of its step alone.
    /// Collective.
    double
    value(const State<dim> &state, const Forces<dim> &forces) const;

    /// Return the sum of absolute nodal forces of a force J, of which a small J
    /// is rounding; zero for other quantities. Collective.
    double
    size_of_parts(const State<dim> &state, const Forces<dim> &forces) const;

    /// Solve with a solver for the matrix of a(.,.). @p law: if bounds follow
    /// the pressure of the step itself. Zero for the work of friction if
    /// nothing slips. Collective. Throws ExcMessage.
    DualSolution<dim>
    solve(BulkSolver         &solver,
          const ContactState &contact,
          const CoulombLaw   *law = nullptr) const
    {
      DualSolution<dim> dual;
      renew(solver, discretization.matrix, contact, law, 1., dual);
      return dual;
    }

    /// Set @p dual to the solution at a state, with @p matrix in place of that
    /// of a(.,.), and return true; return false and keep it if it is one for
    /// this matrix with the same sticking points, slip directions and springs.
    /// For the work of friction, whose load always changes, slip has lasted for
    /// @p slip_steps steps like this one. Collective. Throws ExcMessage.
    bool
    renew(BulkSolver              &solver,
          const DistributedMatrix &matrix,
          const ContactState      &contact,
          const CoulombLaw        *law,
          double                   slip_steps,
          DualSolution<dim>       &dual) const;

    /// Rebuild the solution of renew() from its w, here with ghosts, and its
    /// truncation. Collective.
    DualSolution<dim>
    restore(const DistributedVector &ghosted_w,
            const FaceTruncation    &truncation,
            const DistributedMatrix &matrix) const;

    /// Solve the linearized primal problem at a state, a(u, v) = load . v: with
    /// the load of errors of z, u is their effect on the displacement. On input
    /// @p u, in frames, holds the values at sticking points, which stay.
    /// Collective. Throws ExcMessage.
    void
    solve_linearized(BulkSolver              &solver,
                     const ContactState      &contact,
                     const CoulombLaw        *law,
                     const DistributedVector &load,
                     DistributedVector       &u) const;

    /// Return the change of sign J per unit of the friction bound of each
    /// point, with the direction t of its slip (zero without slip):
    ///
    ///     -t . w_c,   of a friction force -t . (w_c - e) with its direction e,
    ///
    /// of the work of friction the slip in @p slip_steps steps like this one
    /// more.
    std::vector<double>
    change_by_bounds(const ContactState      &contact,
                     const DualSolution<dim> &dual,
                     const double             slip_steps) const;

    double
    sign() const
    {
      return quantity.is_reaction() ? -1. : 1.;
    }

    /// Whether another boundary holds nodes of that of J in the same direction.
    bool
    pieces_meet() const
    {
      return n_meetings > 0;
    }

    /// Add to the parts, by active cell, of an error sign J(u) - sign J(u_h)
    /// the contribution of nodes where two boundaries hold the same direction.
    /// The force at such a node is assigned to one of them, although the other
    /// one's traction is part of it: add int sigma_h nu . w on other boundaries
    /// that hold w, and what w lacks on its own.
    void
    add_at_meetings(const State<dim> &state, Vector<double> &parts) const;

  private:
    /// Set load_density to the point force @p force, by relevant dofs, spread
    /// over the boundary faces around its nodes. Collective.
    void
    make_load_density(const std::vector<double> &force);

    void
    find_meetings();

    /// Return l, in frames.
    DistributedVector
    right_side(const ContactState &contact) const;

    /// Return the prescribed values of w, in frames.
    DistributedVector
    prescribed() const;

    /// Set the prescribed values of w for the work of friction: the work per
    /// unit of each pressure in @p slip_steps steps.
    void
    prescribe_work_of_pressure(const ContactState &contact,
                               const CoulombLaw   &law,
                               double              slip_steps,
                               DistributedVector  &w) const;

    /// Return the constraints and springs of w, or of u if not @p transposed.
    FaceTruncation
    truncation(const BulkSolver   &solver,
               const ContactState &contact,
               const CoulombLaw   *law,
               const bool          transposed) const;

    /// Set the other members of @p dual from its w, the solution for @p load.
    void
    complete(const DistributedMatrix &matrix,
             const DistributedVector &load,
             DualSolution<dim>       &dual) const;

    /// Return the nodal density of a nodal force on the face.
    DistributedVector
    density(const Vector<double> &force) const;

    const Discretization<dim>     &discretization;
    const QuantityOfInterest      &quantity;
    std::optional<PointProbe<dim>> probe;
    DistributedVector              point_load; // l of a displacement
    /// Its nodal density on the boundary, Cartesian with ghosts.
    DistributedVector load_density;
    /// int sym(w nu) of what add_at_meetings() adds, by owned cell.
    std::map<std::size_t, SymmetricTensor<2, 3>> meetings;
    std::size_t                                  n_meetings = 0; // on all ranks
  };
} // namespace Viscoplastic
