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
  class EnergyBalance
  {
  public:
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
      thermal += step.thermal_work;
      largest_work = std::max(largest_work, std::abs(thermal));
    }

    /// Add a change of the mesh. What it does to the stored energy beyond the
    /// work of the loads comes from the mesh alone.
    void
    add_mesh_change(const EnergiesOnMesh &before, const EnergiesOnMesh &after)
    {
      adaptation += add_change(before, after);
    }

    /// Add the beginning of a stage of construction. What it does to the stored
    /// energy beyond the work of the loads goes with the materials: that of
    /// what is removed, and what the surroundings lose when they give way at
    /// once.
    void
    add_stage(const EnergiesOnMesh &before, const EnergiesOnMesh &after)
    {
      construction += add_change(before, after);
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

    /// The work of thermal strain since t = 0.
    double
    thermal_work() const
    {
      return thermal;
    }

    double
    adaptation_energy() const
    {
      return adaptation;
    }

    double
    construction_energy() const
    {
      return construction;
    }

    /// The residual of the energy balance since t = 0.
    double
    defect() const
    {
      return work + thermal -
             (energy - initial_energy - adaptation - construction) - viscous -
             friction;
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
      archive &initial_energy &energy &work &largest_work &viscous &friction
        &adaptation &construction &thermal;
    }

  private:
    /// Add the work of the loads in a change between two steps, and return what
    /// it adds to the stored energy beyond that.
    double
    add_change(const EnergiesOnMesh &before, const EnergiesOnMesh &after)
    {
      const double of_loads = after.of_loads - before.of_loads;
      work += of_loads;
      largest_work = std::max(largest_work, std::abs(work));
      return after.stored - before.stored - of_loads;
    }

    double initial_energy = 0., energy = 0., work = 0., largest_work = 0.,
           viscous = 0., friction = 0., adaptation = 0., construction = 0.,
           thermal = 0.;
  };
} // namespace Viscoplastic
