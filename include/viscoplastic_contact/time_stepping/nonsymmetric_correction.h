// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver.h>
#include <viscoplastic_contact/time_stepping/step_problem.h>

#include <functional>

namespace Viscoplastic
{
  /// Whether all laws say that their tangents are symmetric. Collective.
  template <int dim>
  bool
  have_symmetric_tangents(const FlowLaws<dim> &laws, const double t);


  /// An iterate of Newton's method for a step: u in nodal frames, and Cartesian
  /// with ghosts, z(eps(u)), and the contact state.
  template <int dim>
  struct NewtonIterate
  {
    DistributedVector  u, ghosted_u;
    IrreversibleStress z;
    ContactState       contact;
  };


  /// Newton's method for the bulk and friction together where the tangents C of
  /// backward Euler are not symmetric, so that the symmetric matrix of the
  /// contact solver misses a part of them. With the active sets that the
  /// contact solver has found, the correction w solves
  ///
  ///     P (a_C(.,.) + springs) P w = P r,
  ///
  /// where r is the exact residual with the forces of friction, the projector P
  /// holds sticking points, and the springs are the turning stiffness of
  /// slipping ones (see make_truncation()). It is solved by GMRES,
  /// preconditioned by the solver of the symmetric matrix; C is applied cell by
  /// cell without a matrix.
  ///
  /// A line search shortens the correction until the exact residual decreases
  /// in the dual norm of the matrix, or rejects it; slips that would reverse
  /// stop. Nothing is kept from one call to the next.
  template <int dim>
  class NonsymmetricCorrection
  {
  public:
    /// @p solver: of the symmetric matrix. Keeps references to all arguments.
    NonsymmetricCorrection(const Discretization<dim> &discretization,
                           const StepProblem<dim>    &problem,
                           BulkSolver                &solver);

    /// z for the strains of a ghosted displacement, from a guess. May throw
    /// ExceptionBase on all ranks if there is none.
    using StressForStrain =
      std::function<IrreversibleStress(const DistributedVector &,
                                       const IrreversibleStress &)>;

    struct Result
    {
      /// The step length of the line search; 0 if there is no descent.
      double share;
      /// Iterations of GMRES or of the preconditioner, whichever are more.
      unsigned int iterations;
    };

    /// Correct @p iterate, a result of the contact solver; the linear system is
    /// solved to the relative accuracy @p reduction. Collective.
    Result
    correct(const double           reduction,
            const StressForStrain &z_for,
            NewtonIterate<dim>    &iterate) const;

  private:
    struct Operator;
    struct Preconditioner;

    /// The residual minus the forces of the multipliers that fit it best, which
    /// are set in @p iterate.
    DistributedVector
    residual(NewtonIterate<dim> &iterate) const;

    /// The norm of a residual in the dual of the matrix's energy norm.
    double
    dual_norm(const DistributedVector &r) const;

    /// @p from + share w, but slips that would reverse stop, as do nodes at
    /// obstacles; z is not evaluated.
    NewtonIterate<dim>
    move(const NewtonIterate<dim> &from,
         const DistributedVector  &w,
         const double              share) const;

    FaceTruncation
    truncation(const ContactState &contact) const;

    const Discretization<dim>  &d;
    const StepProblem<dim>     &problem;
    const StressSpace<dim>     &stress_space;
    const AdmissibleSpace<dim> &space;
    const ContactFace<dim>     *face; // null where nothing can slip
    BulkSolver                 &solver;
  };
} // namespace Viscoplastic
