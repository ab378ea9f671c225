// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <algorithm>

namespace Viscoplastic
{
  LawDescription
  norton_description();

  namespace
  {
    /**
     * G = -E (strain rate), strain rate = 3/2 f(sigma_eq) s/sigma_eq, where
     * s = dev sigma, sigma_eq is the von Mises stress, and f the equivalent
     * strain rate
     *
     *     f = A sigma_eq^n                             up to the cap c,
     *     f = A c^n + A n c^(n-1) (sigma_eq - c)       beyond:
     *
     * the tangent there, without which G were not Lipschitz.
     */
    class Norton : public ViscoplasticLaw
    {
    public:
      explicit Norton(const LawSection &section)
        : ViscoplasticLaw(
            {{section, "Rate factor", LawParameter::Range::non_negative},
             {section, "Exponent", LawParameter::Range::at_least_one},
             {section, "Stress cap", LawParameter::Range::positive}})
      {}

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> & /*strain*/,
           const Stiffness &stiffness,
           const LawPoint  &point) const override
      {
        return stiffness.stress(-1.5 * slopes(von_mises(stress), point).secant *
                                deviator(stress));
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> & /*strain*/,
               const Stiffness &stiffness,
               const LawPoint  &point) const override
      {
        const FlowSlopes slope = slopes(von_mises(stress), point);
        Tangents         tangents;
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
        // The tangent is the larger slope. It changes continuously with the
        // stress, so the present one counts.
        return 1.5 * stiffness.largest_deviatoric_eigenvalue() *
               slopes(von_mises(stress), point).tangent;
      }

      std::optional<FlowSlopes>
      radial_flow(const double sigma_eq, const LawPoint &point) const override
      {
        return slopes(sigma_eq, point);
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

      std::string
      announcement() const override
      {
        return "continued linearly beyond the von Mises "
               "stress '" +
               parameters[cap].get_name() + "' = " + parameters[cap].get_text();
      }

    private:
      enum
      {
        rate_factor,
        exponent,
        cap
      };

      static FlowSlopes
      slopes(const double equivalent_stress, const LawPoint &point)
      {
        // A sigma^n is formed as (A^(1/n) sigma)^n: in SI units neither A nor
        // sigma^n need be within the range of a double.
        const double n     = point.parameters[exponent];
        const double a     = std::pow(point.parameters[rate_factor], 1. / n);
        const double sigma = std::min(equivalent_stress, point.parameters[cap]);
        FlowSlopes   result;
        result.secant  = a * std::pow(a * sigma, n - 1.);
        result.tangent = n * result.secant;
        if (equivalent_stress > sigma)
          result.secant +=
            (result.tangent - result.secant) * (1. - sigma / equivalent_stress);
        return result;
      }
    };
  } // namespace



  LawDescription
  norton_description()
  {
    LawDescription law;
    law.name = "norton";
    law.help =
      "G = -E (3/2) A sigma_eq^n dev(sigma)/sigma_eq with the von Mises "
      "stress sigma_eq = sqrt(3/2) |dev(sigma)|: steady creep by a power law, "
      "in a tensile test at the strain rate A sigma^n. A is the `Rate factor' "
      "in Pa^-n/s (for a given temperature T it is A_0 exp(-Q/(R T))), n >= 1 "
      "the `Exponent'; with n = 1 the law is maxwell with eta = 1/(3 A). "
      "Beyond the `Stress cap' c in Pa, which has to be given, the strain "
      "rate grows linearly with slope A n c^(n-1), since the theory asks for "
      "a Lipschitz function: choose it well above the stress you expect. The "
      "relaxation rate 3 mu A n sigma_eq^(n-1) grows with the stress, and "
      "time steps have to be small where it is large. Reference: F. H. "
      "Norton, The Creep of Steel at High Temperatures, McGraw-Hill 1929; "
      "three-dimensional form: F. K. G. Odqvist, Mathematical Theory of Creep "
      "and Creep Rupture, Clarendon Press 1966.";
    law.declare = [](ParameterHandler &prm) {
      prm.declare_entry("Rate factor",
                        "1",
                        Patterns::Anything(),
                        "A >= 0, an expression of position and t. Unit: "
                        "1/(stress^n time).");
      prm.declare_entry("Exponent",
                        "3",
                        Patterns::Anything(),
                        "n >= 1, an expression of position and t. Unit: 1.");
      prm.declare_entry("Stress cap",
                        "",
                        Patterns::Anything(),
                        "The von Mises stress c > 0 beyond which the power is "
                        "continued by its tangent, an expression of position "
                        "and t; it has to be given. Unit: stress.");
    };
    law.make = [](const LawSection &section) {
      AssertThrow(!section.prm.get("Stress cap").empty(),
                  ExcMessage("'" + section.path +
                             "/Stress cap' is not given; beyond this von Mises "
                             "stress the power law is continued linearly, so "
                             "choose one well above the stress you expect."));
      return std::make_unique<Norton>(section);
    };
    return law;
  }
} // namespace Viscoplastic
