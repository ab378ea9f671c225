// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/laws/pointwise_law.h>

namespace Viscoplastic
{
  LawDescription
  perzyna_description();

  namespace
  {
    /// Perzyna's viscoplasticity (Adv. Appl. Mech. 9, 1966) with the elastic
    /// range K = {|dev sigma| <= R},
    ///
    ///     G = -(1/lambda) E (sigma - P_K sigma).
    ///
    /// The projection P_K shortens the deviator to the
    /// length R and leaves the pressure alone, so that with s = dev sigma
    ///
    ///     sigma - P_K sigma = (1 - R/|s|)_+ s.
    ///
    /// The radius grows with the viscoplastic strain eps - E^-1 sigma,
    ///
    ///     R = k_Y + H sqrt(2/3) |d|,   d = dev(eps - E^-1 sigma).
    class Perzyna final : public PointwiseLaw<Perzyna>
    {
    public:
      explicit Perzyna(const LawSection &section)
        : PointwiseLaw(
            {{section, "Yield radius", LawParameter::Range::non_negative},
             {section, "Hardening modulus", LawParameter::Range::non_negative},
             {section, "Viscosity", LawParameter::Range::positive}})
      {}

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> &strain,
           const Stiffness             &stiffness,
           const LawPoint              &point) const override
      {
        const SymmetricTensor<2, 3> s      = deviator(stress);
        const double                length = s.norm();
        const double R = radius(stress, strain, stiffness, point);
        // Written so that NaN ends up in the result.
        if (length <= R)
          return {};
        return stiffness.stress((1 - R / length) /
                                -point.parameters[viscosity] * s);
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> &strain,
               const Stiffness             &stiffness,
               const LawPoint              &point) const override
      {
        Tangents                    tangents;
        const SymmetricTensor<2, 3> s      = deviator(stress);
        const double                length = s.norm();
        const double R = radius(stress, strain, stiffness, point);
        if (length <= R && R > 0)
          return tangents;

        // The excess |s| - R grows with s along s; across s it only turns. With
        // R = 0 the direction e does not matter, and |s| may be zero.
        const double ratio = R > 0 ? R / length : 0.,
                     along = -1. / (1.5 * point.parameters[viscosity]);
        SymmetricTensor<2, 3> e;
        if (length > 0)
          e = s / length;
        tangents.stress =
          stiffness.stress(flow_tangent(stress, (1. - ratio) * along, along));

        // With n = d/|d|, dR = H sqrt(2/3) n : (deps - E^-1 dsigma).
        if (point.parameters[hardening] > 0)
          {
            const SymmetricTensor<2, 3> d =
              deviator(strain - stiffness.strain(stress));
            if (d.norm() > 0)
              {
                const SymmetricTensor<2, 3> n = d / d.norm();
                tangents.strain               = std::sqrt(2. / 3.) *
                                  point.parameters[hardening] /
                                  point.parameters[viscosity] *
                                  outer_product(stiffness.stress(e), n);
                tangents.stress -=
                  std::sqrt(2. / 3.) * point.parameters[hardening] /
                  point.parameters[viscosity] *
                  outer_product(stiffness.stress(e), stiffness.strain(n));
              }
          }
        return tangents;
      }

      double
      relaxation_rate(const SymmetricTensor<2, 3> & /*stress*/,
                      const SymmetricTensor<2, 3> & /*strain*/,
                      const Stiffness &stiffness,
                      const LawPoint  &point) const override
      {
        // The rate is not zero inside K, since the next step may begin outside.
        // Hardening also reduces the excess: its rank-one term E e (x) E^-1 n
        // is bounded in the norm of E^-1.
        const double largest = stiffness.largest_deviatoric_eigenvalue();
        return (largest +
                std::sqrt(2. / 3.) * point.parameters[hardening] *
                  std::sqrt(largest /
                            stiffness.smallest_deviatoric_eigenvalue())) /
               point.parameters[viscosity];
      }

      bool
      has_symmetric_tangents() const override
      {
        const LawParameter &H = parameters[hardening];
        return !H.depends_on_position() && !H.depends_on_time() &&
               H.value(Point<3>(), 0.) == 0.;
      }

      bool
      deviatoric_flow() const override
      {
        return true;
      }

    private:
      enum
      {
        yield_radius,
        hardening,
        viscosity
      };

      static double
      radius(const SymmetricTensor<2, 3> &stress,
             const SymmetricTensor<2, 3> &strain,
             const Stiffness             &stiffness,
             const LawPoint              &point)
      {
        if (point.parameters[hardening] == 0)
          return point.parameters[yield_radius];
        return point.parameters[yield_radius] +
               point.parameters[hardening] * std::sqrt(2. / 3.) *
                 deviator(strain - stiffness.strain(stress)).norm();
      }
    };
  } // namespace



  LawDescription
  perzyna_description()
  {
    return {"perzyna",
            "G = -(1/lambda) E (sigma - P_K sigma), where P_K projects on the "
            "elastic range |dev(sigma)| <= R = k_Y + H eps_eq (Frobenius "
            "norm), eps_eq = sqrt(2/3) |dev(eps - E^-1 sigma)| the present "
            "equivalent viscoplastic strain: flow that returns softens again. "
            "k_Y is the yield stress of a tensile test times sqrt(2/3), of a "
            "shear test times sqrt(2); H the slope of the tensile one over "
            "eps_eq times sqrt(2/3); lambda twice the shear viscosity beyond "
            "the range. (Perzyna, Advances in Applied Mechanics 9, 1966, "
            "243-377; Duvaut, Lions, Inequalities in Mechanics and Physics, "
            "1976, chapter 5.)",
            declare_entries(
              {{"Yield radius",
                "0.1",
                "The radius k_Y >= 0 of the elastic range. Unit: stress."},
               {"Hardening modulus", "0", "H >= 0. Unit: stress."},
               {"Viscosity", "1", "lambda > 0. Unit: stress times time."}}),
            make_law<Perzyna>};
  }
} // namespace Viscoplastic
