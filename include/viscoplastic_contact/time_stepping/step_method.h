// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/timer.h>

#include <viscoplastic_contact/linear_solvers/bulk_solver.h>
#include <viscoplastic_contact/time_stepping/step_problem.h>
#include <viscoplastic_contact/time_stepping/step_solver.h>

#include <memory>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /// A scheme for one step, on one mesh. A step is a function of its problem
  /// alone, except for what an iterative linear solver keeps of earlier solves
  /// (PreconditionerState): with that restored, the same problem gives the same
  /// bits.
  template <int dim>
  class StepMethod
  {
  public:
    virtual ~StepMethod() = default;

    /// Solve one step. Throws StepBeyondStability, and an exception of another
    /// type if the step cannot be solved. Collective.
    virtual StepSolution<dim>
    advance(const StepProblem<dim> &problem) = 0;

    /// Solve for the equilibrium at t = 0, a step of size zero whose z is given
    /// by the old state. Collective.
    virtual StepSolution<dim>
    equilibrate(const StepProblem<dim> &problem) = 0;

    /// The state of the preconditioner at an accepted state, to be kept in
    /// checkpoints; nothing if all solves are alike. Collective.
    virtual std::optional<PreconditionerState>
    preconditioner_state() const = 0;

    /// Restore the method as it was at the state @p accepted on this mesh, when
    /// it had this state of its preconditioner. Collective.
    virtual void
    restore(const EvaluatedState<dim>                &accepted,
            const std::optional<PreconditionerState> &preconditioner) = 0;

    /// The solver for the matrix of a(.,.); null if steps have another matrix.
    virtual StepSolver<dim> *
    elastic_solver() = 0;

    /// The linear solver in use; empty before there is one.
    virtual std::string
    solver_name() const = 0;
  };



  /// Whether load, bounds and prescribed displacements of the step are those of
  /// the state before. Collective.
  template <int dim>
  bool
  data_are_unchanged(const Discretization<dim> &discretization,
                     const StepProblem<dim>    &problem);



  /// The scheme that a scene asks for: explicit, implicit, or explicit up to
  /// the stability limit and implicit beyond it. Keeps references to @p
  /// discretization, which has its matrix, and to @p timer, which gets the
  /// seconds by phase. Collective.
  template <int dim>
  std::unique_ptr<StepMethod<dim>>
  make_step_method(const Discretization<dim> &discretization,
                   TimerOutput               &timer);
} // namespace Viscoplastic
