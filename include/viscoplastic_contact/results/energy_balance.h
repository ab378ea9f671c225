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



  /// The energies of a state that change with the mesh.
  struct EnergiesOnMesh
  {
    /// 1/2 int E^-1 sigma : sigma, and other energy stored by laws.
    double stored = 0.;
    /// The work of the present loads along u.
    double of_loads = 0.;
  };



  /// The balance of energy over a run,
  ///
  ///     external work + work of heating = change of the stored energy
  ///                                       + viscous dissipation
  ///                                       + dissipation by friction.
  ///
  /// Time integration keeps the balance in the body exactly, for all step
  /// sizes. The defect is due to friction: sum lambda . s uses the multiplier
  /// at the end of each step, the work of loads the mean. It vanishes with the
  /// step size, except for steps in which a body jumps, as when it slips or
  /// opens after a stage. A refined mesh is more compliant, and the loads do
  /// work; further changes of the stored energy by the mesh are not physical
  /// and are summed separately.
  struct EnergyBalance
  {
    double initial_energy = 0., stored_energy = 0., external_work = 0.,
           viscous_dissipation = 0., friction_dissipation = 0.;
    /// The work of thermal strain.
    double thermal_work = 0.;
    /// Stored energy added by changes of the mesh beyond the resulting work of
    /// the loads.
    double adaptation_energy = 0.;
    /// The same for stages of construction: the energy of removed parts, and
    /// that lost when the rest gives way at once.
    double construction_energy = 0.;
    /// The largest absolute work of loads or of heating so far.
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

    /// Add a change of mesh or stage between two steps: the work of the loads,
    /// and the stored energy gained beyond it to @p beyond, which is
    /// adaptation_energy or construction_energy.
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

    /// The largest work plus the initial energy, to which defect() is compared;
    /// nonzero also if the loads have taken back their work.
    double
    scale() const
    {
      return largest_work + initial_energy;
    }

    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      archive &initial_energy &stored_energy &external_work &largest_work
        &viscous_dissipation &friction_dissipation &adaptation_energy
          &construction_energy &thermal_work;
    }
  };
} // namespace Viscoplastic
