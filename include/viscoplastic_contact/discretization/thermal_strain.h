// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/stress_space.h>

#include <array>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// The temperature T and the thermal strain alpha (T - T_0) I at the samples
  /// of all owned cells. With it
  ///
  ///     sigma = E (eps(u) - alpha (T - T_0) I) + z':
  ///
  /// the thermal stress -E alpha (T - T_0) I is a part of z = sigma - E eps(u),
  /// which is updated in each step, so that only code that needs the viscous
  /// part of z, or the mechanical strain of a law, has to treat it. With cell
  /// means, the temperature at the cell's center counts.
  template <int dim>
  class ThermalStrain
  {
  public:
    /// The scene must have a temperature. Collective.
    explicit ThermalStrain(const StressSpace<dim> &stress_space);

    /// T and alpha (T - T_0) at each sample.
    struct Samples
    {
      double              t;
      std::vector<double> temperature, strain;
    };

    /// The temperature and thermal strain at the samples at time t, kept until
    /// another time is asked for. Throws ExcMessage where the temperature has
    /// no value, or is not positive but has to be absolute. Collective.
    std::shared_ptr<const Samples>
    at(const double t) const;

    /// Whether any material expands, known on all ranks.
    const bool expands;
    /// Whether thermal strains and rates may change from step to step.
    const bool varies_in_time;
    /// Whether z is nothing but the thermal stress.
    const bool is_alone;

    /// Whether the temperature at time t differs from that at @p t_old at some
    /// sample. Collective.
    bool
    changes(const double t_old, const double t) const;

    /// Add @p factor times the thermal stress at time t to a stress.
    /// Collective.
    void
    add_stress(const double        t,
               const double        factor,
               IrreversibleStress &stress) const;

    /// Add to z the change of the thermal stress from @p t_old to @p t.
    /// Collective.
    void
    follow(const double t_old, const double t, IrreversibleStress &z) const;

    /// The thermal stress -E strain I, unit of stress.
    static SymmetricTensor<2, 3>
    stress(const Stiffness &stiffness, const double strain)
    {
      return stiffness.stress(-strain * unit_symmetric_tensor<3>());
    }

  private:
    const StressSpace<dim> &stress_space;
    /// alpha of each cell, empty if none expands, and T_0 of each sample.
    std::vector<double> expansion, reference;
    /// The samples at the last two times asked for, the ends of a step.
    mutable std::array<std::shared_ptr<const Samples>, 2> last;
  };



  /// Return z minus the thermal stress at time t: z itself without temperature
  /// (@p thermal null), otherwise @p rest, which gets the difference, or stays
  /// empty if z is only thermal stress. Collective.
  template <int dim>
  const IrreversibleStress &
  without_thermal_stress(const ThermalStrain<dim> *thermal,
                         const double              t,
                         const IrreversibleStress &z,
                         IrreversibleStress       &rest);
} // namespace Viscoplastic
