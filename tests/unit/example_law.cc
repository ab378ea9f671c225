// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <algorithm>

namespace Viscoplastic
{
  LawDescription
  garofalo_description();

  namespace
  {
    /**
     * G = -E (strain rate), strain rate = 3/2 f dev(sigma)/sigma_eq with
     * f = A sinh(sigma_eq/sigma_0) up to the cap, and its tangent beyond.
     */
    class Garofalo : public ViscoplasticLaw
    {
    public:
      explicit Garofalo(const LawSection &section)
        : ViscoplasticLaw(
            {{section, "Rate factor", LawParameter::Range::non_negative},
             {section, "Stress scale", LawParameter::Range::positive},
             {section, "Stress cap", LawParameter::Range::positive}})
      {}

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> & /*strain*/,
           const Stiffness &stiffness,
           const LawPoint  &point) const override
      {
        return stiffness.stress(-1.5 * slopes(stress, point).secant *
                                deviator(stress));
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> & /*strain*/,
               const Stiffness &stiffness,
               const LawPoint  &point) const override
      {
        const Slopes slope = slopes(stress, point);
        Tangents     tangents;
        tangents.stress = -1. * stiffness.tensor() *
                          flow_tangent(stress, slope.secant, slope.tangent);
        return tangents;
      }

      double
      relaxation_rate(const SymmetricTensor<2, 3> &stress,
                      const SymmetricTensor<2, 3> & /*strain*/,
                      const Stiffness &stiffness,
                      const LawPoint  &point) const override
      {
        return 1.5 * stiffness.largest_deviatoric_eigenvalue() *
               slopes(stress, point).tangent;
      }

      bool
      has_symmetric_tangents() const override
      {
        return true;
      }

      bool
      deviatoric_flow() const override
      {
        return true;
      }

      bool
      has_cap() const override
      {
        return true;
      }

      bool
      is_beyond_cap(const SymmetricTensor<2, 3> &stress,
                    const LawPoint              &point) const override
      {
        return von_mises(stress) > point.parameters[cap];
      }

    private:
      // In the order of the constructor.
      enum
      {
        rate_factor,
        stress_scale,
        cap
      };

      /// f/sigma_eq and df/dsigma_eq; the first is at most the second, since
      /// sinh is convex.
      struct Slopes
      {
        double secant, tangent;
      };

      static Slopes
      slopes(const SymmetricTensor<2, 3> &stress, const LawPoint &point)
      {
        const double A       = point.parameters[rate_factor];
        const double sigma_0 = point.parameters[stress_scale];
        const double sigma   = von_mises(stress);
        const double capped  = std::min(sigma, point.parameters[cap]);

        Slopes result;
        result.tangent = A / sigma_0 * std::cosh(capped / sigma_0);
        result.secant  = A / sigma_0; // the limit of zero stress
        if (sigma > 0)
          result.secant = (A * std::sinh(capped / sigma_0) +
                           result.tangent * (sigma - capped)) /
                          sigma;
        return result;
      }
    };
  } // namespace



  LawDescription
  garofalo_description()
  {
    LawDescription law;
    law.name = "garofalo";
    law.help =
      "G = -E (3/2) A sinh(sigma_eq/sigma_0) dev(sigma)/sigma_eq with the von "
      "Mises stress sigma_eq: creep that is linear in small stresses and "
      "exponential in large ones. A is the `Rate factor' in 1/s, sigma_0 the "
      "`Stress scale' in Pa; beyond the `Stress cap' in Pa the strain rate "
      "grows linearly. Reference: F. Garofalo, Fundamentals of Creep and "
      "Creep-Rupture in Metals, Macmillan 1965.";
    law.declare = [](ParameterHandler &prm) {
      prm.declare_entry("Rate factor",
                        "1",
                        Patterns::Anything(),
                        "A >= 0, an expression of position and t. Unit: "
                        "1/time.");
      prm.declare_entry("Stress scale",
                        "1",
                        Patterns::Anything(),
                        "sigma_0 > 0, an expression of position and t. Unit: "
                        "stress.");
      prm.declare_entry("Stress cap",
                        "10",
                        Patterns::Anything(),
                        "The von Mises stress beyond which f is continued by "
                        "its tangent, an expression of position and t. Unit: "
                        "stress.");
    };
    law.make = [](const LawSection &section) {
      return std::make_unique<Garofalo>(section);
    };
    return law;
  }
} // namespace Viscoplastic
