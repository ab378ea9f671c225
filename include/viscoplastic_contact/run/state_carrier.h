// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/error_estimator.h>
#include <viscoplastic_contact/error/state_transfer.h>
#include <viscoplastic_contact/results/energy_balance.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <optional>

namespace Viscoplastic
{
  /// Transfers the accepted state of a run to another discretization and
  /// restores equilibrium with sticking friction; the next step lets it slip.
  /// Construct a derived class on the old discretization, make the new one,
  /// then call carry(). Constructors and functions are collective.
  template <int dim>
  class StateCarrier
  {
  public:
    /// The energies on the old mesh.
    EnergiesOnMesh energies;

  protected:
    /// @p error_estimator: null if errors are not estimated.
    StateCarrier(const ErrorEstimator<dim> *error_estimator,
                 const Discretization<dim> &discretization,
                 const EvaluatedState<dim> &accepted);

    /// Reset the rate and update the errors of a transferred state. @p loss and
    /// @p history: see ErrorEstimator::change_mesh().
    void
    complete(const Discretization<dim> &discretization,
             const double               loss,
             const double               history,
             EvaluatedState<dim>       &accepted) const;

    const ErrorEstimator<dim> *error_estimator;
    /// The density of the contact multipliers at nodes; empty without contact
    /// points.
    DistributedVector density;
  };



  /// Transfers a state to the mesh for which cells have been marked.
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



  /// Transfers a state to a stage of construction with other materials.
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
