// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/error/evaluated_state.h>

#include <functional>

namespace Viscoplastic
{
  /// Decides when the mesh of a run changes, and marks its cells: every so many
  /// steps by fractions of the estimate, or, in a run to a tolerance, where the
  /// error of the mesh leaves its share of the budget. Whoever changes the mesh
  /// carries the state over.
  template <int dim>
  class MeshController
  {
  public:
    /// All arguments stay in use. @p budget is null without a tolerance.
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

    /// Whether steps are repeated whose mesh has been too coarse.
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

    /// The ratio of the error of the mesh to what it may be, for the step that
    /// is repeated.
    double
    excess() const
    {
      return ratio;
    }

    /// The step will do.
    void
    accept_step()
    {
      n_refinements = n_vain = 0;
    }

    /// Mark cells of the first mesh if an estimate of it is larger than
    /// @p allowed. Returns whether the mesh is to change and the initial state
    /// to be made again. Collective.
    bool
    mark_first(const Discretization<dim> &discretization,
               const double               estimate,
               const double               allowed,
               const Vector<double>      &squared_indicators);

  private:
    /// The bounds of the scene, with the number of cells that its bound on
    /// memory allows. Collective.
    RefinementParameters
    limits(const Discretization<dim> &discretization) const;

    /// Whether the estimate of the mesh is what rounding and iterations leave,
    /// as of a body that is carried along or strained uniformly: that says
    /// nothing about the mesh, and differs between numbers of ranks.
    /// Collective.
    bool
    estimate_is_rounding(const Discretization<dim> &discretization,
                         const EvaluatedState<dim> &accepted) const;

    /// The error of the mesh over what it may be in a run to a tolerance.
    double
    space_ratio(const ErrorEstimate &errors, const double so_far) const;

    /// A function that withdraws marks for coarsening where z would lose too
    /// much for the tolerance of the run; empty where nothing is coarsened.
    std::function<void()>
    limit_coarsening(const Discretization<dim> &discretization,
                     const EvaluatedState<dim> &accepted,
                     const double               so_far);

    const Scene<dim>                          &scene;
    const RefinementParameters                &wanted;
    parallel::distributed::Triangulation<dim> &triangulation;
    ErrorBudget                               *budget;
    /// How often the mesh has been refined for the step that is being made.
    unsigned int n_refinements = 0;
    /// How many times in turn that has not lowered the error, and the last one.
    unsigned int n_vain     = 0;
    double       last_error = 0.;
    double       ratio      = 0.;

    /// Whether a step has an error that finer meshes do not lower.
    bool
    is_in_vain(const EvaluatedState<dim> &end);
  };
} // namespace Viscoplastic
