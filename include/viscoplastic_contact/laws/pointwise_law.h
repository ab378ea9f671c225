// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/laws/viscoplastic_law.h>

namespace Viscoplastic
{
  /// An entry of a law: name, default value, and text of the manual.
  struct DeclaredEntry
  {
    const char *name, *value, *help;
  };

  /// Return a function for LawDescription::declare that declares entries.
  inline std::function<void(ParameterHandler &)>
  declare_entries(const std::vector<DeclaredEntry> &entries)
  {
    return [entries](ParameterHandler &prm) {
      for (const auto &[name, value, help] : entries)
        prm.declare_entry(name, value, Patterns::Anything(), help);
    };
  }

  /// A function for LawDescription::make.
  template <typename Law>
  std::unique_ptr<ViscoplasticLaw>
  make_law(const LawSection &section)
  {
    return std::make_unique<Law>(section);
  }


  /// The base class (CRTP) of a law that is written point by point,
  ///
  ///     class Perzyna final : public PointwiseLaw<Perzyna>
  template <typename Law>
  class PointwiseLaw : public ViscoplasticLaw
  {
  public:
    using ViscoplasticLaw::ViscoplasticLaw;

    void
    flow(const LawStates &states, Flow *result) const final
    {
      flow_at_points(static_cast<const Law &>(*this), states, result);
    }
  };



  /// The base class (CRTP) of a law of flow along the deviator,
  ///
  ///     G = -E (strain rate),   strain rate = 3/2 f dev(sigma)/sigma_eq,
  ///
  /// whose equivalent strain rate f depends on the von Mises stress sigma_eq
  /// and the point alone and is convex in sigma_eq. A law has to define only
  ///
  ///     FlowSlopes slopes(const double sigma_eq, const LawPoint &point) const;
  ///
  /// and, if it is continued beyond a cap, also has_cap() and
  ///
  ///     bool is_capped(const double sigma_eq, const LawPoint &point) const;
  ///
  /// Such a flow has a potential and preserves volume.
  template <typename Law>
  class RadialLaw : public ViscoplasticLaw
  {
  public:
    using ViscoplasticLaw::ViscoplasticLaw;

    SymmetricTensor<2, 3>
    rate(const SymmetricTensor<2, 3> &stress,
         const SymmetricTensor<2, 3> & /*strain*/,
         const Stiffness &stiffness,
         const LawPoint  &point) const final
    {
      return rate_along(deviator(stress),
                        law().slopes(von_mises(stress), point).secant,
                        stiffness);
    }

    Tangents
    tangents(const SymmetricTensor<2, 3> &stress,
             const SymmetricTensor<2, 3> & /*strain*/,
             const Stiffness &stiffness,
             const LawPoint  &point) const final
    {
      const FlowSlopes slope = law().slopes(von_mises(stress), point);
      return {stiffness.stress(
                flow_tangent(stress, -slope.secant, -slope.tangent)),
              {}};
    }

    std::optional<FlowSlopes>
    radial_flow(const double sigma_eq, const LawPoint &point) const final
    {
      return law().slopes(sigma_eq, point);
    }

    /// The relaxation rate from the tangent, which is at least the secant.
    double
    relaxation_rate(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> & /*strain*/,
                    const Stiffness &stiffness,
                    const LawPoint  &point) const final
    {
      return 1.5 * stiffness.largest_deviatoric_eigenvalue() *
             law().slopes(von_mises(stress), point).tangent;
    }

    bool
    has_symmetric_tangents() const final
    {
      return true;
    }

    bool
    deviatoric_flow() const final
    {
      return true;
    }

    bool
    is_beyond_cap(const SymmetricTensor<2, 3> &stress,
                  const LawPoint              &point) const final
    {
      return law().is_capped(von_mises(stress), point);
    }

    void
    flow(const LawStates &states, Flow *result) const final
    {
      for (unsigned int i = 0; i < states.n; ++i)
        {
          const SymmetricTensor<2, 3> s        = deviator(states.stress[i]);
          const double                sigma_eq = std::sqrt(1.5) * s.norm();
          const FlowSlopes slope = law().slopes(sigma_eq, states.point[i]);
          result[i].rate = rate_along(s, slope.secant, states.stiffness);
          result[i].relaxation_rate =
            1.5 * states.stiffness.largest_deviatoric_eigenvalue() *
            slope.tangent;
          result[i].is_beyond_cap = law().is_capped(sigma_eq, states.point[i]);
        }
    }

    bool
    is_capped(const double /*sigma_eq*/, const LawPoint & /*point*/) const
    {
      return false;
    }

  private:
    const Law &
    law() const
    {
      return static_cast<const Law &>(*this);
    }

    static SymmetricTensor<2, 3>
    rate_along(const SymmetricTensor<2, 3> &s,
               const double                 secant,
               const Stiffness             &stiffness)
    {
      const double factor = -1.5 * secant;
      return stiffness.is_isotropic() ?
               factor * stiffness.largest_deviatoric_eigenvalue() * s :
               stiffness.stress(factor * s);
    }
  };
} // namespace Viscoplastic
