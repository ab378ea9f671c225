// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  struct StepEnergies
  {
    double stored;
    /// External work and dissipation in the step, in units of energy; see
    /// FlowEnergies and FrictionIdentities.
    double external_work, viscous_dissipation, friction_dissipation;
    double thermal_work = 0.;
  };



  /// The energies of a state that a change of the mesh changes.
  struct EnergiesOnMesh
  {
    /// 1/2 int E^-1 sigma : sigma, and what laws store beyond it.
    double stored = 0.;
    /// The work of the present loads on the way from zero to u.
    double of_loads = 0.;
  };



  /// The balance of energy over a run,
  ///
  ///     external work + work of heating = change of the stored energy
  ///                                       + viscous dissipation
  ///                                       + dissipation by friction.
  ///
  /// The time integration keeps that of the bulk exactly, whatever the step
  /// size, so that the defect is that of friction: sum lambda . s takes the
  /// multiplier at the end of each step, the work of the loads the mean. It
  /// vanishes with the step size, but for steps in which a body jumps, as where
  /// it slips or opens after a stage. A body gives way when its mesh is
  /// refined, and the loads do work; what changes of the mesh do to the stored
  /// energy beyond that is no physics and counts apart.
  struct EnergyBalance
  {
    double initial_energy = 0., stored_energy = 0., external_work = 0.,
           viscous_dissipation = 0., friction_dissipation = 0.;
    /// What thermal strain has done.
    double thermal_work = 0.;
    /// What changes of the mesh have added to the stored energy beyond the work
    /// of the loads, which comes from the mesh alone.
    double adaptation_energy = 0.;
    /// The same of stages of construction: the energy of what is removed, and
    /// what the surroundings lose when they give way at once.
    double construction_energy = 0.;
    /// The largest amount that loads or heating had given.
    double largest_work = 0.;

    void
    begin(const double energy)
    {
      initial_energy = stored_energy = energy;
    }

    void
    add_step(const StepEnergies &step)
    {
      stored_energy = step.stored;
      external_work += step.external_work;
      viscous_dissipation += step.viscous_dissipation;
      friction_dissipation += step.friction_dissipation;
      thermal_work += step.thermal_work;
      largest_work = std::max(
        {largest_work, std::abs(external_work), std::abs(thermal_work)});
    }

    /// Add a change between two steps: the work of the loads, and to
    /// adaptation_energy or construction_energy, @p beyond, what the stored
    /// energy gains beside that.
    void
    add_change(const EnergiesOnMesh &before,
               const EnergiesOnMesh &after,
               double               &beyond)
    {
      const double of_loads = after.of_loads - before.of_loads;
      external_work += of_loads;
      largest_work = std::max(largest_work, std::abs(external_work));
      beyond += after.stored - before.stored - of_loads;
    }

    /// The residual of the energy balance since t = 0.
    double
    defect() const
    {
      return external_work + thermal_work -
             (stored_energy - initial_energy - adaptation_energy -
              construction_energy) -
             viscous_dissipation - friction_dissipation;
    }

    /// The sum of absolute energies exchanged, to which defect() is compared,
    /// also where loads give back what they took.
    double
    scale() const
    {
      return largest_work + initial_energy;
    }

    template <typename Archive>
    void
    exchange(Archive &archive)
    {
      archive &initial_energy &stored_energy &external_work &largest_work
        &viscous_dissipation &friction_dissipation &adaptation_energy
          &construction_energy &thermal_work;
    }
  };
} // namespace Viscoplastic
