// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  /// The energies of one step.
  struct StepEnergies
  {
    /// The energy stored at its end.
    double stored;
    /// What has come and gone in the step; see StressSummary and
    /// FrictionIdentities.
    double external_work, viscous_dissipation, friction_dissipation;
  };



  /**
   * The balance of energy over a run,
   *
   *     external work = change of the stored energy + viscous dissipation
   *                     + dissipation by friction.
   *
   * The time integration keeps that of the bulk exactly, whatever the step
   * size, so that the defect is that of friction: sum lambda . s takes the
   * multiplier at the end of each step, the work of the loads the mean. It
   * vanishes with the step size. What changes of the mesh do to the stored
   * energy is no physics and counts apart.
   */
  class EnergyBalance
  {
  public:
    /// Begin with the energy that the initial state stores.
    void
    begin(const double stored_energy)
    {
      initial_energy = energy = stored_energy;
    }

    void
    add_step(const StepEnergies &step)
    {
      energy = step.stored;
      work += step.external_work;
      largest_work = std::max(largest_work, std::abs(work));
      viscous += step.viscous_dissipation;
      friction += step.friction_dissipation;
    }

    /// A change of the mesh has added to the stored energy.
    void
    add_mesh_change(const double change)
    {
      adaptation += change;
    }

    double
    stored_energy() const
    {
      return energy;
    }

    double
    external_work() const
    {
      return work;
    }

    double
    viscous_dissipation() const
    {
      return viscous;
    }

    double
    friction_dissipation() const
    {
      return friction;
    }

    double
    adaptation_energy() const
    {
      return adaptation;
    }

    /// What is missing in the balance.
    double
    defect() const
    {
      return work - (energy - initial_energy - adaptation) - viscous - friction;
    }

    /// What there was to balance, also where loads give back what they took.
    double
    scale() const
    {
      return largest_work + initial_energy;
    }

    /// Write to, or read from, an archive.
    template <typename Archive>
    void
    exchange(Archive &archive)
    {
      archive &initial_energy &energy &work &largest_work &viscous &friction
        &adaptation;
    }

  private:
    double initial_energy = 0., energy = 0., work = 0., largest_work = 0.,
           viscous = 0., friction = 0., adaptation = 0.;
  };
} // namespace Viscoplastic
