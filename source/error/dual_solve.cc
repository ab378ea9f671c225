// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/discretization/force_balance.h>
#include <viscoplastic_contact/error/dual_problem.h>

// Solves of linearized problems: that of a quantity, and its dual.

namespace Viscoplastic
{
  namespace
  {
    /// The relative tolerance of the dual solution in the energy norm. The
    /// estimate needs no more than 1e-3, but refinement marks depend on it and
    /// must not vary with the number of ranks.
    constexpr double dual_tolerance = 1e-6;
    /// The largest ratio of a spring to its node's stiffness. It approximates a
    /// rigid constraint well enough; rho/|s| is unbounded in short steps, and
    /// the preconditioner is not rebuilt for it.
    constexpr double stiffest_spring = 1e3;
    /// The tolerance is relative to the initial error, which may be this times
    /// the energy norm of the solution before another correction follows.
    constexpr double enough = 30.;
  } // namespace



  template <int dim>
  FaceTruncation
  DualProblem<dim>::truncation(const BulkSolver   &solver,
                               const ContactState &contact,
                               const CoulombLaw   *law,
                               const bool          transposed) const
  {
    const ContactLayout &face   = discretization.face->layout();
    ContactState         linear = contact;
    for (unsigned int p = 0; p < linear.n_points(); ++p)
      linear.sticks[p] = linear.holds(face.points[p], p);
    std::vector<Tensor<2, 3>> inverse_diagonal;
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      inverse_diagonal.push_back(
        invert(solver.face_matrix().diagonal_block(node)));
    FaceTruncation result =
      make_truncation(face, linear, inverse_diagonal, stiffest_spring);
    if (law != nullptr)
      law->tilt(face, linear, inverse_diagonal, result, stiffest_spring);
    if (transposed)
      for (Tensor<2, 3> &spring : result.spring)
        spring = transpose(spring);
    result.transposed = transposed;
    return result;
  }



  template <int dim>
  bool
  DualProblem<dim>::renew(BulkSolver              &solver,
                          const DistributedMatrix &matrix,
                          const ContactState      &contact,
                          const CoulombLaw        *law,
                          const double             slip_steps,
                          DualSolution<dim>       &dual) const
  {
    const ContactFace<dim> *face = discretization.slipping_face();
    DualSolution<dim>       result;
    if (face != nullptr)
      result.truncation =
        truncation(solver, contact, law, /* transposed = */ true);
    if (dual.w.size() > 0 && !quantity.is_sum() &&
        (face == nullptr ||
         result.truncation.equals(dual.truncation, face->layout())))
      return false;
    result.w = prescribed();
    // With bounds of the step before, the estimate uses the norm of w alone.
    if (quantity.is_sum() && law != nullptr &&
        !discretization.scene().has_bounds_of_step_before())
      prescribe_work_of_pressure(contact, *law, slip_steps, result.w);
    const DistributedVector load = right_side(contact);
    // Residuals are scaled by w, not by the step that has been solved.
    Forces<dim> forces;
    forces.u           = result.w;
    forces.load.values = load;
    forces.internal    = result.w;
    const SolutionScale scale{
      energy_rounding(discretization.space, matrix, forces).size};
    const bool is_zero = load.l2_norm() == 0. && result.w.l2_norm() == 0.;
    if (face == nullptr && !is_zero)
      solver.solve(load, result.w, dual_tolerance, scale);
    else if (!is_zero)
      {
        // A few corrections leave at most rounding of the initial values;
        // complete() recognizes a w that is no more than that.
        solve_truncated(*solver.begin(load, result.w, scale),
                        face->layout(),
                        result.truncation,
                        /* is_kept = */ false,
                        Vector<double>(face->layout().n_dofs()),
                        dual_tolerance,
                        enough);
      }
    complete(matrix, load, result);
    dual = std::move(result);
    return true;
  }



  template <int dim>
  void
  DualProblem<dim>::solve_linearized(BulkSolver              &solver,
                                     const ContactState      &contact,
                                     const CoulombLaw        *law,
                                     const DistributedVector &load,
                                     DistributedVector       &u) const
  {
    if (load.l2_norm() == 0. && u.l2_norm() == 0.)
      return;
    const ContactFace<dim> *face = discretization.slipping_face();
    if (face == nullptr)
      {
        solver.solve(load, u, dual_tolerance);
        return;
      }
    // Points in contact have no normal error, whatever their state was before.
    const ContactLayout &layout   = face->layout();
    ContactState         touching = contact;
    touching.sticks.assign(touching.n_points(), false);
    for (const unsigned int o : layout.obstacles())
      touching.sticks[o] = contact.multiplier[o][0] > 0.;
    Vector<double> on_face = face->restriction().gather(u);
    make_truncation(layout, touching, {}).project(layout, on_face);
    face->restriction().set(on_face, u);
    solve_truncated(*solver.begin(load, u),
                    layout,
                    truncation(solver, contact, law, /* transposed = */ false),
                    /* is_kept = */ false,
                    Vector<double>(layout.n_dofs()),
                    dual_tolerance,
                    enough);
  }



  template <int dim>
  DualSolution<dim>
  DualProblem<dim>::restore(const DistributedVector &ghosted_w,
                            const FaceTruncation    &truncation,
                            const DistributedMatrix &matrix) const
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    DualSolution<dim>           dual;
    dual.w = space.owned_vector();
    for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
      dual.w.begin()[i] = ghosted_w.begin()[space.relevant.index_within_set(
        space.owned.nth_index_in_set(i))];
    dual.truncation            = truncation;
    dual.truncation.transposed = true;
    complete(matrix, point_load, dual);
    return dual;
  }



  template <int dim>
  void
  DualProblem<dim>::complete(const DistributedMatrix &matrix,
                             const DistributedVector &load,
                             DualSolution<dim>       &dual) const
  {
    const Discretization<dim>  &d     = discretization;
    const AdmissibleSpace<dim> &space = d.space;
    if (probe)
      dual.load = &load_density;
    DistributedVector elastic = space.owned_vector();
    matrix.vmult(elastic, dual.w);
    dual.norm = std::sqrt(std::max(0., dual.w * elastic));
    // A force that statics or friction bounds determine depends on no residual:
    // w is a rigid motion or zero, up to rounding.
    Forces<dim> forces;
    forces.u = prescribed();
    forces.u += dual.w;
    forces.load.values = load;
    forces.internal    = elastic;
    if (energy_rounding(space, matrix, forces).is_all_of_the_strain)
      dual.norm = 0.;
    dual.cartesian = space.ghosted_vector();
    space.to_cartesian(dual.w, dual.cartesian);
    // The point load is no constraint force of w; the load of friction is.
    DistributedVector force = point_load;
    force -= elastic;
    if (d.face)
      {
        dual.force   = d.face->restriction().gather(force);
        dual.density = density(dual.force);
      }
    if (d.held_traction)
      d.held_traction->add_density(force, dual.density);
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(DualProblem, renew);
  VISCOPLASTIC_INSTANTIATE_MEMBER(DualProblem, solve_linearized);
  VISCOPLASTIC_INSTANTIATE_MEMBER(DualProblem, restore);
  VISCOPLASTIC_INSTANTIATE_MEMBER(DualProblem, truncation);
  VISCOPLASTIC_INSTANTIATE_MEMBER(DualProblem, complete);
} // namespace Viscoplastic
