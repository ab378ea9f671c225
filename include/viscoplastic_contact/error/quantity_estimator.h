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
  /// Estimates the error of a quantity of interest J at the end of each step,
  /// on one mesh. With the residual R of the state and the solution w of the
  /// dual problem (DualProblem),
  ///
  ///     J(u) - J(u_h) = sign R(w - w_h) + sign R_z(w),
  ///
  /// where R_z is the residual due to errors of z:
  ///
  /// - mesh: R(w - w_h) is a(e_u, e_w), with e the errors of both problems;
  ///   ResidualEstimator::multiply() gives its part by cell. The estimate is
  ///   safety times the sum; absolute values are the refinement indicators.
  /// - mesh, in creep: rates that have been wrong for long have moved the body,
  ///   which the residual of its present stress does not show. The creep strain
  ///   is T G with the present G and its path T |G|
  ///   (ErrorEstimate::creep_time): one step T of backward Euler, whose stress
  ///   S(eps(u)) has the tangents C. A force is the work of its stress on any
  ///   displacement that is 1 where it acts and 0 where others do, also on the
  ///   solution w_h of the dual problem of C, so that
  ///
  ///       |J(u) - J(u_h)| = |int (S(eps(u)) - S(eps(u_h))) : eps(w_h)|
  ///                       = |int (e_u : C e_w - r(-e_u) : eps(w_h))|
  ///
  ///   with the remainder r of RecoveryEstimator::multiply(); displacements of
  ///   points likewise. The larger of this and of a(e_u, e_w) counts. T is the
  ///   time t under steady loads, less while they grow, and unbounded where
  ///   stress relaxes: C and the memory of forces fade accordingly.
  /// - the boundary: BoundaryDefects, which R does not contain. The errors by
  ///   straight sides and by bounds that vary within faces are signed, as those
  ///   of the mesh.
  /// - time steps: R_z(w) = -(e_z, eps(w)) + sum_c f_c . e_c with the errors of
  ///   z and of sticking points from carry_time_error(), and the constraint
  ///   forces f_c of w at the latter. For sums over steps -(D, eps(w)) with the
  ///   sum D of the defects of all steps (see ErrorEstimator).
  /// - slip that turns or comes to rest within a step has defects d_c
  ///   (SlipDefects), and the quantity an error sum_c f_c . d_c with the
  ///   constraint force f_c of w at the point. Absolute values are summed over
  ///   the steps, and over points that come to rest. Later slip removes errors
  ///   of turns, which are bounded by their energy norm times a(w, w)^{1/2}.
  /// - other errors are known by their norms: of lagging bounds and iterations,
  ///   times a(w, w)^{1/2}; of initial data, changes of the mesh and the
  ///   history, orthogonal to cell-wise constants, times the error of w.
  ///
  /// The work of friction, int rho |s'|, is sum rho_c |s_c| with s_c the slip
  /// since point c began to slip: its error is that of J(u) at the end of a
  /// step, and for points that have come to rest since, that at the time when
  /// they did. The error is continuous then: what it loses with these points
  /// held, at the state from which the step starts, is settled (settled_space;
  /// of time steps, in proportion to bounds: settled_time); if bounds change,
  /// so is its share -d(rho)/rho, by integration by parts. Bounds at the ends
  /// of steps, instead of those in between, make a quadrature error -1/2 (rho_n
  /// - rho_{n-1}) |s|, settled at once. If bounds follow the pressure, its
  /// errors count for the slip up to now, taken as that of slip_steps steps
  /// like the last one.
  ///
  /// Sticking points keep the error e_c at which they came to rest, and any
  /// other quantity has the error sum_c f_c . e_c with the constraint force f_c
  /// of w. The error is continuous when points come to rest: with w for the
  /// points that stuck before, and w' for these and the new ones,
  ///
  ///     sum_c f'_c . e_c = R(w) - R(w'),
  ///
  /// at the state from which the step starts. This is settled, too, in
  /// proportion to the bounds of points that still stick. For a force the
  /// settled error relaxes as stress does, and recovers the part due to strains
  /// of D that the law resists.
  template <int dim>
  class QuantityEstimator
  {
  public:
    /// The estimate is exact to leading order for the mesh of one step, but
    /// unaware of effects of former meshes on z and of slip fronts between
    /// nodes. For their size see doc/error_bar.md.
    static constexpr double safety = 2.;

    /// Return the estimate for a signed error of the mesh. The safety factor
    /// omits the exact part by straight sides, unless that cancels the rest.
    static double
    with_safety(const double error, const double of_sides)
    {
      return std::abs(error) +
             (safety - 1.) *
               std::min(std::abs(error), std::abs(error - of_sides));
    }

    /// A quantity is rounding if it is less than the first of these times its
    /// bound, and vanishes but for iterations below the second one. (Quantities
    /// that do not vanish are 0.5 to 5e-3 of it at least.)
    static constexpr double rounding = 1e-9, nothing = 1e-4;
    /// The ratio of creep to relaxation time below which a body is elastic.
    static constexpr double elastic = 0.01;
    /// In bodies that creep, the least ratio of the estimate to the sum of
    /// absolute contributions: cancellation beyond that is not trusted.
    static constexpr double least_share = 0.25;

    /// Returns a solver for the matrix of tangents, valid until the next call;
    /// the flag tells whether the matrix differs from that of the last call.
    using TangentSolver =
      std::function<BulkSolver &(const TangentMatrix<dim> &, const bool)>;

    /// Whether the scene has viscosity and a quantity of interest.
    static bool
    is_of_creep(const Scene<dim> &scene);

    /// Keeps references to all arguments. Collective.
    QuantityEstimator(const Discretization<dim> &discretization,
                      const SpaceEstimator<dim> &space_estimator,
                      const TangentSolver       &solver_of_tangents);

    /// Add the quantity, its errors and the indicators to the state at the end
    /// of a step, whose estimate in the energy norm is complete. @p solver: for
    /// the matrix of a(.,.). @p slip_defects: of the step, if any. @p growth:
    /// the ratio of the mesh part to that of @p accepted, if it is not
    /// estimated anew. @p old_rate: G of @p accepted, null if not known.
    /// Collective. Throws ExcMessage.
    void
    assess(BulkSolver                  &solver,
           const SlipDefects           *slip_defects,
           const std::optional<double> &growth,
           const EvaluatedState<dim>   &accepted,
           const FlowRate              *old_rate,
           EvaluatedState<dim>         &end) const;

    /// Whether the tangents of creep are those of another creep time than that
    /// of a state with @p rate, so that the last estimate cannot serve on.
    bool
    has_crept_on(const EvaluatedState<dim> &end, const FlowRate &rate) const;

    /// The data kept from step to step.
    struct Memory
    {
      /// The state (u, z, history; G in place of rate_slope) and step size k at
      /// which the creep tangents are linearized; k alone if they depend on
      /// nothing else, nothing before there are any.
      std::optional<State<dim>> linearized;
      /// The dual solutions of the step and of creep: w with ghosts, empty if
      /// there is none, and the truncations.
      std::array<DistributedVector, 2> w;
      std::array<FaceTruncation, 2>    truncations;
    };

    Memory
    memory() const;

    /// Restore the result of memory() in a run that has reached @p accepted.
    /// Collective. Throws ExcMessage.
    void
    restore(const State<dim> &accepted, const Memory &memory);

  private:
    /// Return Coulomb's law for the pressure of the step to @p state, with the
    /// slip rates of @p old; none if bounds are given or lagged. Collective.
    std::optional<CoulombLaw>
    law_of_step(const State<dim> &old, const State<dim> &state) const;

    /// Add the errors by slip defects of a step to the sums of the estimate.
    /// The dual problem fixes points that come to rest in it. Collective.
    void
    add_slip_defects(BulkSolver              &solver,
                     const SlipDefects       &defects,
                     const ContactState      &contact,
                     const CoulombLaw        *law,
                     const DualSolution<dim> &dual,
                     QuantityEstimate        &estimate) const;

    /// Set the mesh parts of the estimate, and the indicators; return the
    /// signed error of the mesh. Collective.
    double
    assess_mesh(const CoulombLaw *law, EvaluatedState<dim> &end) const;

    /// Return BoundaryDefects::unresolved_bounds() for a dual solution at a
    /// state, with points that stick or slip as in @p contact. Collective.
    Vector<double>
    unresolved_bounds(const State<dim>        &state,
                      const ContactState      &contact,
                      const DualSolution<dim> &dual,
                      const double             slip_steps) const;

    /// Characteristic numbers of the creep of a body.
    struct Creep
    {
      /// The duration of creep, ErrorEstimate::creep_time.
      double time;
      /// The ratio of the relaxation rates of stress errors and of the stress
      /// itself: the exponent n of a power law, 1 of a linear one.
      double exponent;
      /// int |s| of the deviatoric stress s. Compliances without and with creep
      /// have the ratio of |s|/n to |s|/n + T |G|.
      double stress;
    };

    /// Return these numbers for a state and @p time. Collective.
    Creep
    creep_of(const State<dim> &state,
             const FlowRate   &rate,
             const double      time) const;

    /// The step of backward Euler that stands for the creep up to a state.
    struct CreepStep
    {
      /// Its length T, and that of the step of the tangents, at most a thousand
      /// relaxation times.
      double time, k;
    };

    CreepStep
    step_of_creep(const EvaluatedState<dim> &end, const FlowRate &rate) const;

    /// Return the error of the quantity by wrong rates up to the end of a step,
    /// by active cell, and set @p sides to the missing sides with the dual
    /// solution of creep. Collective.
    Vector<double>
    products_of_creep(const EvaluatedState<dim> &end,
                      const Creep               &creep,
                      const CoulombLaw          *law,
                      Vector<double>            &sides) const;

    /// Carry the errors of time steps to the end of a step, whose defect is
    /// already in that of z: they obey the equations linearized at its end,
    ///
    ///     e_z' = dG (E eps(e_u) + e_z, eps(e_u)),
    ///     a(e_u, v) + (e_z, eps(v)) + sum_c e_lambda_c . v_c = 0,
    ///
    /// where sticking points keep e_u, and bounds follow the pressure.
    /// Collective.
    void
    carry_time_error(BulkSolver          &solver,
                     const CoulombLaw    *law,
                     const State<dim>    &old,
                     EvaluatedState<dim> &end) const;

    /// Return the error of the quantity due to the carried errors. Collective.
    double
    time_error(const State<dim> &state) const;

    /// Settle the part of a sum's error that later steps cannot change: of the
    /// mesh, the error at the start of the step less that with points held that
    /// come to rest or turn back. Collective. Throws ExcMessage.
    void
    settle(BulkSolver                &solver,
           const CoulombLaw          *law,
           const EvaluatedState<dim> &accepted,
           const FlowRate            *old_rate,
           const ContactState        &contact,
           QuantityEstimate          &estimate) const;

    /// Settle the error with which points come to rest in a step, for
    /// quantities other than sums over steps. Collective.
    void
    hold(BulkSolver                &solver,
         const EvaluatedState<dim> &accepted,
         const ContactState        &contact,
         const CoulombLaw          *law,
         ErrorEstimate             &errors) const;

    /// A dual solution and data for products with it, computed on first use.
    /// They are kept for later steps while the same points stick and slip.
    struct KeptDual
    {
      DualSolution<dim>                                      solution;
      std::optional<typename ResidualEstimator<dim>::OfDual> residuals;
      typename RecoveryEstimator<dim>::OfDual                recovered;
      /// eps(w) at the samples times their weights.
      IrreversibleStress strains;
    };

    /// Call DualProblem::renew() for the end of a step, and reset @p kept if
    /// the solution has changed. Collective. Throws ExcMessage.
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
    /// The creep tangents, null if nothing creeps, and the state at which they
    /// are linearized (see Memory).
    std::unique_ptr<TangentMatrix<dim>> tangent;
    mutable std::optional<State<dim>>   linearized;
    mutable KeptDual                    dual_of_step, dual_of_creep;
  };
} // namespace Viscoplastic
