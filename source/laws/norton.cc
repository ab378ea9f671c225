// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/laws/pointwise_law.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  LawDescription
  norton_description();

  namespace
  {
    /// G = -E (strain rate), strain rate = 3/2 f(sigma_eq) s/sigma_eq, where
    /// s = dev sigma, sigma_eq is the von Mises stress, and f the equivalent
    /// strain rate
    ///
    ///     f = A sigma_eq^n                             up to the cap c,
    ///     f = A c^n + A n c^(n-1) (sigma_eq - c)       beyond:
    ///
    /// the tangent at c, since G has to be Lipschitz.
    class Norton final : public RadialLaw<Norton>
    {
    public:
      explicit Norton(const LawSection &section)
        : RadialLaw(
            {{section, "Rate factor", LawParameter::Range::non_negative},
             {section, "Exponent", LawParameter::Range::at_least_one},
             {section, "Stress cap", LawParameter::Range::positive}})
      {}

      FlowSlopes
      slopes(const double sigma_eq, const LawPoint &point) const
      {
        // A sigma^n is formed as (A^(1/n) sigma)^n: in SI units neither A nor
        // sigma^n need be within the range of a double.
        const double n     = point.parameters[exponent];
        const double a     = point.parameters[root_of_rate_factor];
        const double sigma = std::min(sigma_eq, point.parameters[cap]);
        FlowSlopes   result;
        result.secant  = a * power(a * sigma, n - 1.);
        result.tangent = n * result.secant;
        if (sigma_eq > sigma)
          result.secant +=
            (result.tangent - result.secant) * (1. - sigma / sigma_eq);
        return result;
      }

      bool
      has_cap() const override
      {
        return true;
      }

      bool
      is_capped(const double sigma_eq, const LawPoint &point) const
      {
        return sigma_eq > point.parameters[cap];
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
        cap,
        root_of_rate_factor // A^(1/n), added by prepare()
      };

      void
      prepare(LawPoint &point) const override
      {
        point.parameters[root_of_rate_factor] =
          std::pow(point.parameters[rate_factor],
                   1. / point.parameters[exponent]);
      }

      /// Return x^m, by a few products for the whole numbers that most
      /// exponents are.
      static double
      power(double x, const double m)
      {
        const double most = 16.;
        if (!(m <= most && m == std::floor(m)))
          return std::pow(x, m);
        double result = 1.;
        for (auto n = static_cast<unsigned int>(m); n > 0; n /= 2, x *= x)
          if (n % 2 == 1)
            result *= x;
        return result;
      }
    };
  } // namespace



  LawDescription
  norton_description()
  {
    return {"norton",
            "G = -E (3/2) A sigma_eq^n dev(sigma)/sigma_eq with the von Mises "
            "stress sigma_eq: steady creep by a power law, in a tensile test "
            "at the strain rate A sigma^n; n = 1 is maxwell with eta = 1/(3 "
            "A). (Norton, The Creep of Steel at High Temperatures, 1929; "
            "Odqvist, Mathematical Theory of Creep and Creep Rupture, 1966.)",
            declare_entries(
              {{"Rate factor", "1", "A >= 0. Unit: 1/(stress^n time)."},
               {"Exponent", "3", "n >= 1. Unit: 1."},
               {"Stress cap",
                "",
                "The von Mises stress c > 0 beyond which the power is "
                "continued by its tangent: well above the stress you "
                "expect. It has to be given. Unit: stress."}}),
            [](const LawSection &section) {
              if (section.prm.get("Stress cap").empty())
                refuse("'" + section.path +
                       "/Stress cap' is not given; beyond this von Mises "
                       "stress the power law is continued linearly, so choose "
                       "one well above the stress you expect.");
              return std::make_unique<Norton>(section);
            }};
  }
} // namespace Viscoplastic
