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
    /// What holds w on Gamma_3: nodal forces on the face, empty without contact
    /// points, and their density with that of what holds bodies to each other,
    /// Cartesian with ghosts.
    Vector<double>    force;
    DistributedVector density;
    /// The traction that loads w in the place of a force at a point of the
    /// boundary: equal for u_h but for h^2; empty if it has no such load.
    const DistributedVector *load = nullptr;
    /// a(w, w)^{1/2}.
    double norm = 0.;
    /// What holds w where the face sticks, and turns with its slip; empty
    /// without a face.
    FaceTruncation truncation;
  };


  /// The dual problem of a quantity J: how J feels a residual R of the
  /// equations of a step,
  ///
  ///     a(u, v) + (z, eps(v)) + sum_c lambda_c . v_c = L(v) + R(v),
  ///
  /// with the law of friction linearized at a state: points that stick do so,
  /// and the multiplier of a point that slips changes with the direction of its
  /// slip only, d(lambda) = K d(s) with K = rho/|s| across the slip (none in
  /// the plane). The change of J is then
  ///
  ///     J' = sign R(w),   a(w, v) + sum_slipping K w_c . v_c = l(v)
  ///
  /// for all v in V_h that are zero where points stick, where
  ///
  /// - of the displacement of a point, l is its component: sign = 1;
  /// - of a reaction, l = 0, and w is the unit direction on the boundary
  ///   instead of zero: sign = -1;
  /// - of the friction force, l = 0, w is the unit direction at points that
  ///   stick, and w_c less this direction takes the place of w_c at those that
  ///   slip: sign = 1;
  /// - of the contact force likewise, along the normals where contact is
  ///   closed, with K the slope of the pressure where a foundation gives way:
  ///   sign = 1; of both on one boundary, times the part of a point's area that
  ///   is there;
  /// - of the work of friction in all steps, as long as what slips goes on in
  ///   the same direction, l(v) = sum_slipping lambda_c . v_c; where the
  ///   pressure of the step itself makes bounds, w is along the normals what it
  ///   is of a contact force, but with mu times the slip up to now as the
  ///   factor of each pressure: sign = 1.
  ///
  /// With Coulomb's law of the step's own pressure, lambda_c of a slipping
  /// point changes with its pressure, too, and the equations of such a point
  /// are those of its tilt (CoulombLaw::tilt()). The dual system is the
  /// transposed one: v still is zero across the foundation there, but w moves
  /// into it by mu times its part along the slip.
  template <int dim>
  class DualProblem
  {
  public:
    /// Both stay in use. Collective.
    DualProblem(const Discretization<dim> &discretization,
                const QuantityOfInterest  &quantity);

    /// J of a state; the work of friction is that of its step alone.
    /// Collective.
    double
    value(const State<dim> &state, const Forces<dim> &forces) const;

    /// The size of the forces that a force J adds up, of which rounding leaves
    /// something where they cancel; zero of other quantities. Collective.
    double
    size_of_parts(const State<dim> &state, const Forces<dim> &forces) const;

    /// Solve with a solver for the matrix of a(.,.), with the law of bounds
    /// that follow the pressure of the step itself, if they do. Zero for the
    /// work of friction where nothing slips. Collective. Throws ExcMessage.
    DualSolution<dim>
    solve(BulkSolver         &solver,
          const ContactState &contact,
          const CoulombLaw   *law = nullptr) const
    {
      DualSolution<dim> dual;
      renew(solver, discretization.matrix, contact, law, 1., dual);
      return dual;
    }

    /// Make @p dual the solution of a state, with any @p matrix in the place of
    /// that of a(.,.), unless it is one with this matrix already for which all
    /// points stick, or slip in the same directions and with the same springs.
    /// (What loads the work of friction is never the same: what slips has done
    /// so for @p slip_steps steps like this one.) Returns whether it is another
    /// one now. Collective. Throws ExcMessage.
    bool
    renew(BulkSolver              &solver,
          const DistributedMatrix &matrix,
          const ContactState      &contact,
          const CoulombLaw        *law,
          double                   slip_steps,
          DualSolution<dim>       &dual) const;

    /// The solution that renew() has made, of its w, here with ghosts, and its
    /// truncation. Collective.
    DualSolution<dim>
    restore(const DistributedVector &ghosted_w,
            const FaceTruncation    &truncation,
            const DistributedMatrix &matrix) const;

    /// The problem whose dual this is, a(u, v) = load . v at a state: of errors
    /// of z, those of u. @p u, in frames, brings where points stick that do.
    /// Collective. Throws ExcMessage.
    void
    solve_linearized(BulkSolver              &solver,
                     const ContactState      &contact,
                     const CoulombLaw        *law,
                     const DistributedVector &load,
                     DistributedVector       &u) const;

    double
    sign() const
    {
      return quantity.is_reaction() ? -1. : 1.;
    }

    /// Whether a piece that J is the force of meets another one that holds the
    /// same direction.
    bool
    pieces_meet() const
    {
      return n_meetings > 0;
    }

    /// Add to the parts of an error sign J(u) - sign J(u_h), by active cell,
    /// what pieces that meet hold of each other. The force at a node where two
    /// of them hold the same direction goes to one, which has the other's
    /// traction there, too: int sigma_h nu . w on the pieces that hold w, and
    /// what is missing of w on its own.
    void
    add_at_meetings(const State<dim> &state, Vector<double> &parts) const;

  private:
    /// Spread the force at a point, by relevant entries, over the faces of the
    /// boundary around its nodes. Collective.
    void
    make_load_density(const std::vector<double> &force);

    void
    find_meetings();

    /// l, in frames.
    DistributedVector
    right_side(const ContactState &contact) const;

    /// The prescribed values of w, in frames.
    DistributedVector
    prescribed() const;

    /// Those of the work of friction: what a pressure has been worth in so many
    /// steps.
    void
    prescribe_work_of_pressure(const ContactState &contact,
                               const CoulombLaw   &law,
                               double              slip_steps,
                               DistributedVector  &w) const;

    /// What holds w at a state; or u, if not @p transposed.
    FaceTruncation
    truncation(const BulkSolver   &solver,
               const ContactState &contact,
               const CoulombLaw   *law,
               const bool          transposed) const;

    /// Set what follows from w, which @p load has loaded.
    void
    complete(const DistributedMatrix &matrix,
             const DistributedVector &load,
             DualSolution<dim>       &dual) const;

    /// The nodal density of -a(w, .) on the face.
    DistributedVector
    density(const Vector<double> &force) const;

    const Discretization<dim>     &discretization;
    const QuantityOfInterest      &quantity;
    std::optional<PointProbe<dim>> probe;
    DistributedVector              point_load; // l of a displacement
    /// Its nodal density on the boundary, Cartesian with ghosts.
    DistributedVector load_density;
    /// int sym(w nu) of what pieces hold of each other's w, by owned cell.
    std::map<std::size_t, SymmetricTensor<2, 3>> meetings;
    std::size_t                                  n_meetings = 0; // on all ranks
  };
} // namespace Viscoplastic
