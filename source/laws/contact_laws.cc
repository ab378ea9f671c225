// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/laws/contact_laws.h>

#include <cmath>

// The registry of contact laws and friction laws: a new law is a row here.

namespace Viscoplastic
{
  PressureLaw
  power_pressure(const double m)
  {
    return {[m](const double k, const double w) { return k * std::pow(w, m); },
            [m](const double k, const double w) {
              return m * k * std::pow(w, m - 1.);
            },
            [m](const double k, const double w) {
              return k * std::pow(w, m + 1.) / (m + 1.);
            },
            [m](const double k, const double p) {
              return std::pow(p / k, 1. / m);
            }};
  }



  const std::vector<ContactLaw> &
  contact_laws()
  {
    using Kind = ContactLaw::Kind;
    static const std::vector<ContactLaw> laws{
      {{"bilateral", "u_nu = d, also under tension", "bilateral contact"},
       Kind::bilateral},
      {{"given normal stress", "sigma_nu = S", "given normal stress"},
       Kind::given_stress},
      {{"unilateral",
        "u_n <= g + d, a foundation that presses but does not pull, so that "
        "contact opens and closes",
        "unilateral contact"},
       Kind::unilateral},
      {{"normal compliance",
        "the same with a foundation that gives way, sigma_n = -c (u_n - g - "
        "d)_+^m",
        "normal compliance",
        {{"Compliance",
          "c(x) >= 0 of normal compliance, the pressure at a penetration of "
          "one. Unit: stress/length^m."},
         {"Compliance exponent",
          "m >= 1 of normal compliance. Unit: 1.",
          false,
          "1",
          1.}}},
       Kind::unilateral,
       [](const std::vector<double> &m) { return power_pressure(m[0]); }}};
    return laws;
  }



  const std::vector<FrictionLaw> &
  friction_laws()
  {
    static const std::vector<FrictionLaw> laws{
      {{"none", "contact without friction", ""}},
      {{"tresca",
        "a given friction bound (5.22)",
        "Tresca friction",
        {{"Friction bound", "g(x,t) >= 0 of the law tresca. Unit: stress."}}}},
      {{"coulomb",
        "the bound mu |S| of a given normal stress (5.6), or in unilateral "
        "contact and normal compliance mu p with the pressure p that comes out "
        "(`Solver/Coulomb pressure')",
        "Coulomb friction",
        {{"Friction coefficient",
          "mu(x,t) >= 0 of the law coulomb, a pure number. Unit: 1.",
          true}}}},
      {{"glued", "the body is held fast to the foundation", "glued contact"},
       true}};
    return laws;
  }
} // namespace Viscoplastic
