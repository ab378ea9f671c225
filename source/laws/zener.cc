// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/viscoplastic_law.h>

#include <sstream>

namespace Viscoplastic
{
  LawDescription
  zener_description();

  namespace
  {
    /**
     * G = -(1/theta) (sigma - E_inf eps): two springs in parallel, one of
     * stiffness E_inf and one of stiffness B = E - E_inf in series with a
     * dashpot, which carries the stress q = sigma - E_inf eps. The stored
     * energy is that of both springs,
     *
     *     1/2 E_inf eps : eps + 1/2 B^-1 q : q.
     *
     * A mode of E that does not relax, e.g. the volumetric one where
     * K_inf = K, has no second spring: it is left out of B^-1.
     */
    class Zener : public ViscoplasticLaw
    {
    public:
      explicit Zener(const LawSection &section)
        : ViscoplasticLaw(
            {{section,
              "Long-term Young's modulus",
              LawParameter::Range::non_negative},
             {section,
              "Long-term Poisson's ratio",
              LawParameter::Range::poissons_ratio},
             {section, "Relaxation time", LawParameter::Range::positive}})
      {
        for (const auto modulus : {youngs_modulus, poissons_ratio})
          AssertThrow(!parameters[modulus].depends_on_time(),
                      ExcMessage("'" + parameters[modulus].get_name() +
                                 "' depends on t; elastic moduli must be "
                                 "functions of position only."));
      }

      void
      check(const Stiffness &stiffness, const LawPoint &point) const override
      {
        // Equal moduli may come out of different formulas.
        const double tolerance = 1e-10 * spectrum(stiffness.tensor()).values[5];
        const double smallest  = relaxing_modes(stiffness, point).values[0];
        std::ostringstream message;
        message << "'" << parameters[youngs_modulus].get_name()
                << "' = " << point.parameters[youngs_modulus]
                << " with Poisson's ratio " << point.parameters[poissons_ratio]
                << " makes the body stiffer in the long term than at once, at "
                   "x = ("
                << point.x << "): the smallest eigenvalue of E - E_inf is "
                << smallest << "; it must be zero or positive.";
        AssertThrow(smallest >= -tolerance, ExcMessage(message.str()));
      }

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> &strain,
           const Stiffness & /*stiffness*/,
           const LawPoint &point) const override
      {
        return (stress - long_term_stress(strain, point)) /
               -point.parameters[relaxation_time];
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> & /*stress*/,
               const SymmetricTensor<2, 3> & /*strain*/,
               const Stiffness & /*stiffness*/,
               const LawPoint &point) const override
      {
        Tangents tangents;
        tangents.stress =
          identity_tensor<3>() / -point.parameters[relaxation_time];
        if (point.parameters[youngs_modulus] > 0)
          tangents.strain =
            long_term(point).tensor() / point.parameters[relaxation_time];
        return tangents;
      }

      double
      relaxation_rate(const SymmetricTensor<2, 3> & /*stress*/,
                      const SymmetricTensor<2, 3> & /*strain*/,
                      const Stiffness & /*stiffness*/,
                      const LawPoint &point) const override
      {
        return 1. / point.parameters[relaxation_time];
      }

      bool
      deviatoric_flow() const override
      {
        return false;
      }

      /// B^-1 q, the strain of the second spring.
      SymmetricTensor<2, 3>
      driving_strain(const SymmetricTensor<2, 3> &stress,
                     const SymmetricTensor<2, 3> &strain,
                     const Stiffness             &stiffness,
                     const LawPoint              &point) const override
      {
        const SymmetricTensor<2, 3> q =
          stress - long_term_stress(strain, point);
        const double tolerance = 1e-10 * (2 * stiffness.shear_modulus() +
                                          3 * stiffness.bulk_modulus());
        SymmetricTensor<2, 3> result;
        if (stiffness.is_isotropic())
          {
            // The general case takes a thousand times longer.
            const bool   relaxes_fully = point.parameters[youngs_modulus] == 0;
            const double mu =
              stiffness.shear_modulus() -
              (relaxes_fully ? 0. : long_term(point).shear_modulus());
            const double bulk =
              stiffness.bulk_modulus() -
              (relaxes_fully ? 0. : long_term(point).bulk_modulus());
            if (2 * mu > tolerance)
              result += deviator(q) / (2 * mu);
            if (3 * bulk > tolerance)
              result += trace(q) / (9 * bulk) * unit_symmetric_tensor<3>();
            return result;
          }

        const Spectrum B = relaxing_modes(stiffness, point);
        for (unsigned int mode = 0; mode < 6; ++mode)
          if (B.values[mode] > tolerance)
            result += (B.modes[mode] * q) / B.values[mode] * B.modes[mode];
        return result;
      }

      bool
      has_own_energy() const override
      {
        return true;
      }

      double
      stored_energy(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> &strain,
                    const Stiffness             &stiffness,
                    const LawPoint              &point) const override
      {
        const SymmetricTensor<2, 3> elastic = long_term_stress(strain, point);
        return 0.5 * (elastic * strain +
                      (stress - elastic) *
                        driving_strain(stress, strain, stiffness, point));
      }

    private:
      enum Parameter
      {
        youngs_modulus,
        poissons_ratio,
        relaxation_time
      };

      static Stiffness
      long_term(const LawPoint &point)
      {
        return Stiffness::isotropic(point.parameters[youngs_modulus],
                                    point.parameters[poissons_ratio]);
      }

      /// E_inf eps.
      static SymmetricTensor<2, 3>
      long_term_stress(const SymmetricTensor<2, 3> &strain,
                       const LawPoint              &point)
      {
        if (point.parameters[youngs_modulus] == 0)
          return {};
        return long_term(point).stress(strain);
      }

      /// Of E - E_inf.
      static Spectrum
      relaxing_modes(const Stiffness &stiffness, const LawPoint &point)
      {
        SymmetricTensor<4, 3> B = stiffness.tensor();
        if (point.parameters[youngs_modulus] > 0)
          B -= long_term(point).tensor();
        return spectrum(B);
      }
    };
  } // namespace



  LawDescription
  zener_description()
  {
    LawDescription law;
    law.name = "zener";
    law.help =
      "G = -(1/theta) (sigma - E_inf eps), the standard linear solid: a "
      "viscoelastic solid with the elastic tensor E at once and the isotropic "
      "tensor E_inf <= E in the long term, pressure included. The stress that "
      "a fixed strain leaves beyond E_inf eps decays like exp(-t/theta); "
      "under constant stress the strain creeps towards E_inf^-1 sigma. theta "
      "is the `Relaxation time' in s; E_inf is given by the `Long-term "
      "Young's modulus' in Pa (zero: all stress relaxes) and the `Long-term "
      "Poisson's ratio'. Bulk and shear modulus must not exceed those of E; "
      "where one of them equals that of E, that part does not relax. With a "
      "long-term Poisson's ratio near 1/2 choose mean dilatation. "
      "Reference: C. Zener, Elasticity and Anelasticity of Metals, University "
      "of Chicago Press 1948, chapter 5.";
    law.declare = [](ParameterHandler &prm) {
      prm.declare_entry("Long-term Young's modulus",
                        "0.5",
                        Patterns::Anything(),
                        "Young's modulus of E_inf, zero or positive, an "
                        "expression of position. Unit: stress.");
      prm.declare_entry("Long-term Poisson's ratio",
                        "0.3",
                        Patterns::Anything(),
                        "Poisson's ratio of E_inf in (-1, 1/2), an expression "
                        "of position.");
      prm.declare_entry("Relaxation time",
                        "1",
                        Patterns::Anything(),
                        "theta > 0 at fixed strain, an expression of position "
                        "and t. Unit: time.");
    };
    law.make = [](const LawSection &section) {
      return std::make_unique<Zener>(section);
    };
    return law;
  }
} // namespace Viscoplastic
