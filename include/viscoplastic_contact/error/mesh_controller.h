// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/error/evaluated_state.h>

#include <functional>

namespace Viscoplastic
{
  /// Decides when the mesh of a run changes, and marks its cells: every given
  /// number of steps by fractions of the estimate, or, in a run to a tolerance,
  /// when the error of the mesh leaves its share of the budget. The caller
  /// changes the mesh and transfers the state.
  template <int dim>
  class MeshController
  {
  public:
    /// Keeps references to all arguments. @p budget: null without a tolerance.
    MeshController(const Scene<dim>                          &scene,
                   parallel::distributed::Triangulation<dim> &triangulation,
                   ErrorBudget                               *budget);

    /// Whether the mesh may change between step @p n and the next.
    bool
    is_due(const unsigned int n) const;

    /// Mark cells by the estimate of the accepted state. @p so_far: the largest
    /// size of the solution up to now (ErrorBudget::size()). Returns whether
    /// the mesh is to change. Collective.
    bool
    mark(const Discretization<dim> &discretization,
         const EvaluatedState<dim> &accepted,
         const double               so_far);

    /// Whether steps are repeated if their mesh has been too coarse.
    bool
    repeats_steps() const;

    /// Mark cells if the mesh is too coarse for a step from the accepted state
    /// to @p end. Returns whether the mesh is to change and the step to be
    /// repeated. Collective.
    bool
    mark_for_step(const Discretization<dim> &discretization,
                  const EvaluatedState<dim> &accepted,
                  const EvaluatedState<dim> &end,
                  const double               so_far);

    /// The ratio of the mesh error to the allowed one in the last call of
    /// mark_for_step().
    double
    excess() const
    {
      return ratio;
    }

    /// Whether the run has to begin again on the mesh that mark_for_step() has
    /// chosen, since errors that earlier meshes have left in the history, or
    /// what has settled of that of a work of friction, are more than half of
    /// what is allowed.
    bool
    begins_again() const
    {
      return has_settled;
    }

    /// Coarsen no cells: those of a run that has begun again.
    void
    keep_cells()
    {
      keeps_cells = true;
    }

    /// Reset the counters of refinements after a step has been accepted.
    void
    accept_step()
    {
      n_refinements = n_vain = 0;
    }

    /// Mark cells of the first mesh if it is too coarse for the initial data,
    /// whose @p squared_errors by cell are given, or, if these are null, for
    /// the equilibrium at t = 0. Returns whether the mesh is to change and the
    /// initial state to be made again. Collective.
    bool
    mark_first(const Discretization<dim> &discretization,
               const EvaluatedState<dim> &initial,
               const Vector<double>      *squared_errors);

  private:
    /// The limits of the scene, with the number of cells that its memory budget
    /// allows. Collective.
    RefinementParameters
    limits(const Discretization<dim> &discretization) const;

    /// Whether the mesh estimate is only the error of rounding and iterations,
    /// as in rigid motion or uniform strain. Such an estimate says nothing
    /// about the mesh and differs between numbers of ranks. Collective.
    bool
    estimate_is_rounding(const Discretization<dim> &discretization,
                         const EvaluatedState<dim> &accepted) const;

    /// The absolute error that the mesh may make. @p so_far: as of mark().
    double
    allowed(const ErrorEstimate &errors, const double so_far) const;

    /// The ratio of the mesh error to the allowed one in a run to a tolerance.
    double
    space_ratio(const ErrorEstimate &errors, const double so_far) const;

    /// The part of the error of a quantity that no mesh removes any more.
    double
    settled(const QuantityEstimate &quantity) const;

    /// Return a function that withdraws coarsening marks where z would lose too
    /// much for the tolerance; empty if no cells may be coarsened.
    std::function<void()>
    limit_coarsening(const Discretization<dim> &discretization,
                     const EvaluatedState<dim> &accepted,
                     const double               so_far);

    const Scene<dim>                          &scene;
    const RefinementParameters                &wanted;
    parallel::distributed::Triangulation<dim> &triangulation;
    ErrorBudget                               *budget;
    /// How often the mesh has been refined for the present step.
    unsigned int n_refinements = 0;
    /// The number of successive refinements in vain, and the last error.
    unsigned int n_vain      = 0;
    double       last_error  = 0.;
    double       ratio       = 0.;
    bool         has_settled = false, keeps_cells = false;

    /// Update n_vain; return whether finer meshes do not lower the error.
    bool
    is_in_vain(const EvaluatedState<dim> &end);
  };
} // namespace Viscoplastic
