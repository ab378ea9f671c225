// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/error_estimator.h>
#include <viscoplastic_contact/error/state_transfer.h>
#include <viscoplastic_contact/results/energy_balance.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <optional>

namespace Viscoplastic
{
  /// Carries the accepted state of a run to another discretization of the body,
  /// where it finds its equilibrium while friction holds: the next step lets it
  /// slip. Construct one of the classes below on the old discretization, make
  /// the new one, then carry(). Constructors and functions are collective.
  template <int dim>
  class StateCarrier
  {
  public:
    /// The energies on the old mesh.
    EnergiesOnMesh energies;

  protected:
    /// @p error_estimator is null if there is none.
    StateCarrier(const ErrorEstimator<dim> *error_estimator,
                 const Discretization<dim> &discretization,
                 const EvaluatedState<dim> &accepted);

    /// What comes after the fields of the state are there. @p loss and
    /// @p history: see ErrorEstimator::change_mesh().
    void
    complete(const Discretization<dim> &discretization,
             const double               loss,
             const double               history,
             EvaluatedState<dim>       &accepted) const;

    const ErrorEstimator<dim> *error_estimator;
    /// The density of the multipliers at the nodes; empty without contact
    /// points.
    DistributedVector density;
  };



  /// Carries a state to another mesh, whose cells have been marked.
  template <int dim>
  class MeshChange : public StateCarrier<dim>
  {
  public:
    MeshChange(const ErrorEstimator<dim>                 *error_estimator,
               const Discretization<dim>                 &discretization,
               const EvaluatedState<dim>                 &accepted,
               parallel::distributed::Triangulation<dim> &triangulation);

    void
    carry(const Discretization<dim> &discretization,
          TimeStepper<dim>          &time_stepper,
          EvaluatedState<dim>       &accepted);

  private:
    const std::optional<State<dim>> without_temperature;
    const State<dim>               &carried;
    const double                    loss;
    StateTransfer<dim>              transfer;
  };



  /// Carries a state to another stage of construction: materials come and go.
  template <int dim>
  class StageChange : public StateCarrier<dim>
  {
  public:
    StageChange(const ErrorEstimator<dim> *error_estimator,
                const Discretization<dim> &discretization,
                const EvaluatedState<dim> &accepted);

    void
    carry(const Discretization<dim> &discretization,
          TimeStepper<dim>          &time_stepper,
          EvaluatedState<dim>       &accepted);

  private:
    std::vector<bool>            was_present; // by cell
    std::set<types::material_id> were_absent;
  };
} // namespace Viscoplastic
