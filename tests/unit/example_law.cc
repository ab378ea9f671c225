// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/laws/pointwise_law.h>

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
    class Garofalo final : public RadialLaw<Garofalo>
    {
    public:
      explicit Garofalo(const LawSection &section)
        : RadialLaw(
            {{section, "Rate factor", LawParameter::Range::non_negative},
             {section, "Stress scale", LawParameter::Range::positive},
             {section, "Stress cap", LawParameter::Range::positive}})
      {}

      /// f/sigma_eq and df/dsigma_eq.
      FlowSlopes
      slopes(const double sigma, const LawPoint &point) const
      {
        const double A       = point.parameters[rate_factor];
        const double sigma_0 = point.parameters[stress_scale];
        const double capped  = std::min(sigma, point.parameters[cap]);

        FlowSlopes result;
        result.tangent = A / sigma_0 * std::cosh(capped / sigma_0);
        result.secant  = A / sigma_0; // the limit of zero stress
        if (sigma > 0)
          result.secant = (A * std::sinh(capped / sigma_0) +
                           result.tangent * (sigma - capped)) /
                          sigma;
        return result;
      }

      bool
      has_cap() const override
      {
        return true;
      }

      bool
      is_capped(const double sigma, const LawPoint &point) const
      {
        return sigma > point.parameters[cap];
      }

    private:
      // In the order of the constructor.
      enum
      {
        rate_factor,
        stress_scale,
        cap
      };
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
