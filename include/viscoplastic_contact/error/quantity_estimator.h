// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_event.h>
#include <viscoplastic_contact/discretization/tangent_matrix.h>
#include <viscoplastic_contact/error/boundary_defects.h>
#include <viscoplastic_contact/error/dual_problem.h>
#include <viscoplastic_contact/error/evaluated_state.h>

#include <functional>
#include <memory>

namespace Viscoplastic
{
  /// Estimates the error of a quantity J of interest at the end of each step,
  /// on one mesh. With the residual R of the state and the solution w of the
  /// dual problem (DualProblem),
  ///
  ///     J(u) - J(u_h) = sign R(w - w_h) + sign R_z(w),
  ///
  /// where R_z is the residual that errors of z make:
  ///
  /// - mesh: R(w - w_h) is a(e_u, e_w), with e the errors of both problems, of
  ///   which ResidualEstimator::multiply() tells the part of each cell. Their
  ///   sum is the estimate, safety times that is what counts as error, and
  ///   their sizes are the indicators by which meshes are refined.
  /// - mesh, in what has crept: rates that have been wrong for long have moved
  ///   the body, which the residual of its present stress does not know. What
  ///   has crept is T G with the present G and its path T |G|
  ///   (ErrorEstimate::creep_time): one step T of backward Euler, whose stress
  ///   S(eps(u)) has the tangents C. A force is the work of its stress on any
  ///   displacement that is 1 where it acts and 0 where others do, also on the
  ///   solution w_h of the dual problem of C, so that
  ///
  ///       |J(u) - J(u_h)| = |int (S(eps(u)) - S(eps(u_h))) : eps(w_h)|
  ///                       = |int (e_u : C e_w - r(-e_u) : C eps(w_h))|
  ///
  ///   with the remainder r of RecoveryEstimator::multiply(); points likewise.
  ///   The larger of this and of a(e_u, e_w) counts. T is t under steady loads,
  ///   less while they grow, and has no bound where stress relaxes: C and what
  ///   forces remember fade as it does.
  /// - the boundary: BoundaryDefects, which R does not know. What straight
  ///   sides miss has a sign, like the mesh.
  /// - time steps: R_z(w) = -(e_z, eps(w)) + sum_c f_c . e_c with the errors of
  ///   z and of where points stick as carry_time_error() has them, and the
  ///   forces f_c that hold w there. Of sums over steps -(D, eps(w)) with the
  ///   sum D of the defects of all steps (see ErrorEstimator).
  /// - slip that turns or comes to rest within a step is wrong by defects d_c
  ///   (SlipDefects), and the quantity by sum_c f_c . d_c with the force f_c
  ///   that holds w at the point. Steps add up without signs, and so do points
  ///   that come to rest. Of turns, which full slip forgets, no more counts
  ///   than their energy norm times a(w, w)^{1/2}.
  /// - everything else is known by its norm: bounds that lag and the iterations
  ///   by a(w, w)^{1/2}; initial data, changes of the mesh and the history,
  ///   which are orthogonal to what is constant in cells, by the error of w.
  ///
  /// The work of friction, int rho |s'|, is sum rho_c |s_c| with s_c the slip
  /// since point c has begun to slip: its error is that of J(u) at the end of a
  /// step, and what it was, for points that have come to rest since, when they
  /// did. That share of it is settled (settled_space, settled_time), and so is
  /// -d(rho)/rho of it where bounds change, by parts. The bounds
  /// at the ends of steps, in place of those in between, make a quadrature
  /// error -1/2 (rho_n - rho_{n-1}) |s| of known sign, settled at once. Where
  /// the pressure makes bounds its errors count for the slip up to now, taken
  /// as that of so many steps like the last one (slip_steps).
  ///
  /// Points that stick keep the error e_c of where they have come to rest, and
  /// any other quantity feels it by sum_c f_c . e_c with the force f_c that
  /// holds w there. When they come to rest nothing jumps: with w of the points
  /// that stuck before, and w' of these and the new ones,
  ///
  ///     sum_c f'_c . e_c = R(w) - R(w'),
  ///
  /// of the state that the step starts from. That is settled, too, and ends
  /// with the bounds of what sticks. Of a force what is settled relaxes as
  /// stress does, and regains what the law holds of strains that D has made.
  template <int dim>
  class QuantityEstimator
  {
  public:
    /// The estimate is exact to leading order for the mesh of one step, and
    /// knows nothing of what the meshes before have done to z, or of fronts of
    /// slip between nodes. How large that may be: doc/error_bar.md.
    static constexpr double safety = 2.;

    /// What counts of an error of the mesh with its sign. What straight sides
    /// have of it is exact and counts once, unless it hides that of the cells.
    static double
    with_safety(const double error, const double of_sides)
    {
      return std::abs(error) +
             (safety - 1.) *
               std::min(std::abs(error), std::abs(error - of_sides));
    }

    /// A quantity that is less than this of what it could be is rounding.
    static constexpr double nothing = 1e-9;
    /// The part of a relaxation time below which a cell counts as elastic.
    static constexpr double elastic = 0.01;
    /// In bodies that creep, the least ratio of the estimate to the sum of
    /// absolute contributions: cancellation beyond that is not trusted.
    static constexpr double least_share = 0.25;

    /// A solver for the matrix of tangents, until the next one is asked for,
    /// and whether that is another matrix than the last time.
    using TangentSolver =
      std::function<BulkSolver &(const TangentMatrix<dim> &, const bool)>;

    /// Whether there is a quantity, of a body that creeps.
    static bool
    is_of_creep(const Scene<dim> &scene);

    /// All arguments stay in use. Collective.
    QuantityEstimator(const Discretization<dim> &discretization,
                      const SpaceEstimator<dim> &space_estimator,
                      const TangentSolver       &solver_of_tangents);

    /// Add the quantity, its errors and the indicators to the state at the end
    /// of a step, whose estimate in the energy norm is complete. @p solver: for
    /// the matrix of a(.,.). @p slip_defects: of the step, if any. @p growth:
    /// how the mesh part goes on from that of @p accepted, if it is not
    /// estimated anew. Collective. Throws ExcMessage.
    void
    assess(BulkSolver                  &solver,
           const SlipDefects           *slip_defects,
           const std::optional<double> &growth,
           const EvaluatedState<dim>   &accepted,
           EvaluatedState<dim>         &end) const;

    /// What is kept from step to step.
    struct Memory
    {
      /// The state (u, z, history; G in the place of rate_slope) and the step
      /// size k that the tangents of creep are of; k alone if they depend on
      /// nothing else, nothing before there are any.
      std::optional<State<dim>> linearized;
      /// The dual solution of the step and that of creep: w with ghosts, empty
      /// if there is none, and its truncation.
      std::array<DistributedVector, 2> w;
      std::array<FaceTruncation, 2>    truncations;
    };

    Memory
    memory() const;

    /// Go on with what memory() has had in a run that has come to @p accepted.
    /// Collective. Throws ExcMessage.
    void
    restore(const State<dim> &accepted, const Memory &memory);

  private:
    /// Coulomb's law of the pressure of the step to @p state, whose slip rates
    /// are those of @p old; none if bounds are given. Collective.
    std::optional<CoulombLaw>
    law_of_step(const State<dim> &old, const State<dim> &state) const;

    /// Add what a step has wrong of slip to the sums of the estimate. Points
    /// that come to rest in it are held in the dual problem. Collective.
    void
    add_slip_defects(BulkSolver              &solver,
                     const SlipDefects       &defects,
                     const ContactState      &contact,
                     const CoulombLaw        *law,
                     const DualSolution<dim> &dual,
                     QuantityEstimate        &estimate) const;

    /// Set the parts of the estimate that are of the mesh, and the indicators;
    /// returns the error of the mesh with its sign. Collective.
    double
    assess_mesh(const CoulombLaw *law, EvaluatedState<dim> &end) const;

    /// How a body creeps.
    struct Creep
    {
      /// ErrorEstimate::creep_time.
      double time;
      /// How much faster errors of the stress relax than the stress itself: the
      /// exponent n of a power law, 1 of a linear one.
      double exponent;
      /// int |s| of the deviators s of stresses. Compliances without and with
      /// creep are as |s|/n to |s|/n + T |G|.
      double stress;
    };

    /// Of a state with the rate G, @p time. Collective.
    Creep
    creep_of(const State<dim> &state,
             const FlowRate   &rate,
             const double      time) const;

    /// What the errors of rates have done to the quantity by the end of a
    /// step, by active cell; and the missing sides with the dual solution of
    /// creep. Collective.
    Vector<double>
    products_of_creep(const EvaluatedState<dim> &end,
                      const Creep               &creep,
                      const CoulombLaw          *law,
                      Vector<double>            &sides) const;

    /// Carry the errors of time steps on to the end of a step, whose defects
    /// that of z has by now: they obey the equations linearized at its end,
    ///
    ///     e_z' = dG (E eps(e_u) + e_z, eps(e_u)),
    ///     a(e_u, v) + (e_z, eps(v)) + sum_c e_lambda_c . v_c = 0,
    ///
    /// where points that stick keep their e_u, and bounds follow the pressure.
    /// Collective. Throws ExcMessage.
    void
    carry_time_error(BulkSolver          &solver,
                     const CoulombLaw    *law,
                     const State<dim>    &old,
                     EvaluatedState<dim> &end) const;

    /// What the carried error does to the quantity. Collective.
    double
    time_error(const State<dim> &state) const;

    /// Settle what later steps will not change in the error of a sum.
    void
    settle(const EvaluatedState<dim> &accepted,
           const ContactState        &contact,
           QuantityEstimate          &estimate) const;

    /// Whether friction holds a point.
    bool
    holds(const ContactState &contact, const unsigned int p) const;

    /// Settle the error with which points come to rest in a step, unless the
    /// quantity is a sum. Collective.
    void
    hold(BulkSolver                &solver,
         const EvaluatedState<dim> &accepted,
         const ContactState        &contact,
         const CoulombLaw          *law,
         ErrorEstimate             &errors) const;

    /// A dual solution and what products with it take, made when first asked
    /// for. The solution is that of later steps, too, while the same points
    /// stick and slip.
    struct KeptDual
    {
      DualSolution<dim>                                      solution;
      std::optional<typename ResidualEstimator<dim>::OfDual> residuals;
      typename RecoveryEstimator<dim>::OfDual                recovered;
      /// eps(w) at the samples times their weights.
      IrreversibleStress strains;
    };

    /// DualProblem::renew() of what is kept, for the end of a step. Collective.
    /// Throws ExcMessage.
    void
    renew(BulkSolver                &solver,
          const DistributedMatrix   &matrix,
          const EvaluatedState<dim> &end,
          const CoulombLaw          *law,
          KeptDual                  &kept) const;

    const Discretization<dim> &discretization;
    const SpaceEstimator<dim> &space_estimator;
    const TangentSolver        solver_of_tangents;
    const DualProblem<dim>     dual_problem;
    const BoundaryDefects<dim> boundary_defects;
    /// Of creep, null if nothing creeps, and what it is of.
    std::unique_ptr<TangentMatrix<dim>> tangent;
    mutable std::optional<State<dim>>   linearized;
    mutable KeptDual                    dual_of_step, dual_of_creep;
  };
} // namespace Viscoplastic
