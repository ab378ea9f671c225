// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>

namespace Viscoplastic
{
  /// Integrals of the stress of a state.
  template <int dim>
  struct StressSummary
  {
    /// The largest von Mises stress of cell means, and its mean by volume.
    double max_von_mises = 0., mean_von_mises = 0.;
    /// The center of the cell with the largest von Mises stress.
    Point<dim> von_mises_position;
    /// int |eps|^3 / int |eps|^2 of cell means, |eps| = (eps : eps)^(1/2): the
    /// mean strain, weighted like elastic energy. It represents the deforming
    /// part, however small, and converges also with singular strains.
    double mean_strain = 0.;
    /// (int sigma : sigma)^(1/2) of cell means.
    double stress_norm = 0.;
  };

  /// Return the summary of a state. Collective.
  template <int dim>
  StressSummary<dim>
  summarize_stress(const StressSpace<dim> &stress_space,
                   const State<dim>       &state);

  /// The energies of z in a step, for a cell or the body.
  struct FlowEnergies
  {
    /// 1/2 int E^-1 z : z, plus the stored energy of laws that define it, minus
    /// 1/2 int E^-1 sigma : sigma there.
    double irreversible_energy = 0.;
    /// -int (z_n - z_{n-1}) : A with the driving strain A of the law,
    /// E^-1 sigma for most, at the mean of the states at t_{n-1} and t_n: the
    /// viscous dissipation of the step; with this mean the balance of energy of
    /// the bulk is exact, whatever the step size.
    double viscous_dissipation = 0.;
    /// -int sigma : (increment of the thermal strain), with sigma at the same
    /// mean: the work of heating on the body.
    double thermal_work = 0.;
  };

  /// Return those of a cell; @p before and @p now: laws.at() of both states.
  template <int dim>
  FlowEnergies
  energies_of_cell(const FlowLaws<dim>                  &laws,
                   const typename FlowLaws<dim>::AtTime &before,
                   const typename FlowLaws<dim>::AtTime &now,
                   const State<dim>                     &old_state,
                   const State<dim>                     &state,
                   const std::size_t                     cell);

  /// Return the energies of all cells; @p old_state: the state before the step,
  /// or @p state itself. Collective.
  template <int dim>
  FlowEnergies
  energies_of_flow(const FlowLaws<dim> &laws,
                   const State<dim>    &old_state,
                   const State<dim>    &state);

  /// Return norm(sigma - P0 sigma)/norm(sigma) with sigma = E eps(u) + z: the
  /// part of the stress that cell means do not contain. Collective.
  template <int dim>
  double
  relative_stress_fluctuation(const StressSpace<dim> &stress_space,
                              const State<dim>       &state);
} // namespace Viscoplastic
