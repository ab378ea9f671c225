// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/laws/pointwise_law.h>

#include <algorithm>

namespace Viscoplastic
{
  LawDescription
  parsed_description();

  namespace
  {
    /// G = -E (strain rate), strain rate = 3/2 F f s/sigma_eq, where s = dev
    /// sigma, F is a function of position and time, and the equivalent strain
    /// rate f(sigma_eq, p, eps_eq, T, t) is given as an expression of the
    /// temperature T and
    ///
    ///     sigma_eq = sqrt(3/2) |s|,   p = -tr(sigma)/3,
    ///     eps_eq = sqrt(2/3) |d|,     d = dev(eps - E^-1 sigma).
    class Parsed final : public PointwiseLaw<Parsed>
    {
    public:
      explicit Parsed(const LawSection &section)
        : PointwiseLaw({{section, "Factor", LawParameter::Range::non_negative}})
        , f(section.prm.get("Strain rate"),
            section.path + "/Strain rate",
            "sigma_eq,p,eps_eq,T")
        , name(section.path + "/Strain rate")
      {
        // Most runs start at rest: refuse an expression without a value there.
        if (!f.depends_on_additional_variable())
          strain_rate(Point<3>(), LawPoint());
      }

      bool
      depends_on_time() const override
      {
        return f.depends_on_time() || ViscoplasticLaw::depends_on_time();
      }

      bool
      depends_on_temperature() const override
      {
        return f.depends_on_additional_variable() ||
               has_parameters_of_temperature();
      }

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> &strain,
           const Stiffness             &stiffness,
           const LawPoint              &point) const override
      {
        const Point<3> state = invariants(stress, strain, stiffness);
        // Flow has no direction if the deviator is zero.
        if (state[0] == 0)
          return {};
        return stiffness.stress(-1.5 * point.parameters[factor] *
                                strain_rate(state, point) / state[0] *
                                deviator(stress));
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> &strain,
               const Stiffness             &stiffness,
               const LawPoint              &point) const override
      {
        const SymmetricTensor<2, 3> s = deviator(stress);
        const Point<3> state          = invariants(stress, strain, stiffness);
        const Slopes   slope          = slopes(state, stiffness, point);

        SymmetricTensor<4, 3> by_stress =
          flow_tangent(stress, slope.secant, slope.by[0]);
        SymmetricTensor<4, 3> by_strain;
        if (s.norm() > 0)
          {
            const SymmetricTensor<2, 3> e = s / s.norm();
            by_stress -= std::sqrt(1.5) / 3. * slope.by[1] *
                         outer_product(e, unit_symmetric_tensor<3>());

            const SymmetricTensor<2, 3> d =
              deviator(strain - stiffness.strain(stress));
            if (d.norm() > 0 && slope.by[2] != 0)
              {
                const SymmetricTensor<2, 3> n = d / d.norm();
                by_stress -=
                  slope.by[2] * outer_product(e, stiffness.strain(n));
                by_strain = slope.by[2] * outer_product(e, n);
              }
          }

        return {stiffness.stress(-1. * by_stress),
                stiffness.stress(-1. * by_strain)};
      }

      double
      relaxation_rate(const SymmetricTensor<2, 3> &stress,
                      const SymmetricTensor<2, 3> &strain,
                      const Stiffness             &stiffness,
                      const LawPoint              &point) const override
      {
        const Slopes slope =
          slopes(invariants(stress, strain, stiffness), stiffness, point);
        const double largest = stiffness.largest_deviatoric_eigenvalue();

        // The hardening term has rank one and is bounded in the norm of E^-1 as
        // in perzyna.cc. So is the pressure term, which is zero in isotropic
        // bodies, where deviatoric flow does not change the pressure.
        double result =
          1.5 * largest * std::max(slope.by[0], slope.secant) +
          std::fabs(slope.by[2]) *
            std::sqrt(largest / stiffness.smallest_deviatoric_eigenvalue());
        if (!stiffness.is_isotropic())
          result +=
            std::sqrt(1.5) / 3. * std::fabs(slope.by[1]) *
            std::sqrt(largest *
                      trace(stiffness.strain(unit_symmetric_tensor<3>())));
        return result;
      }

      bool
      deviatoric_flow() const override
      {
        return true;
      }

    private:
      enum
      {
        factor
      };

      const Expression<3> f;
      const std::string   name;

      /// Return (sigma_eq, p, eps_eq).
      static Point<3>
      invariants(const SymmetricTensor<2, 3> &stress,
                 const SymmetricTensor<2, 3> &strain,
                 const Stiffness             &stiffness)
      {
        return {von_mises(stress),
                -trace(stress) / 3,
                std::sqrt(2. / 3.) *
                  deviator(strain - stiffness.strain(stress)).norm()};
      }

      double
      strain_rate(const Point<3> &state, const LawPoint &point) const
      {
        const double value = f.value(state, point.t, point.temperature);
        if (!(value >= 0))
          refuse("'" + name + "' is " + as_text(value) + " at sigma_eq = " +
                 as_text(state[0]) + ", p = " + as_text(state[1]) +
                 ", eps_eq = " + as_text(state[2]) +
                 ", t = " + as_text(point.t) +
                 "; it must be zero or positive, since flow against the "
                 "stress would create energy.");
        return value;
      }

      /// F f/sigma_eq, and F times the derivatives of f by the invariants.
      struct Slopes
      {
        double                secant = 0.;
        std::array<double, 3> by{};
      };

      Slopes
      slopes(const Point<3>  &state,
             const Stiffness &stiffness,
             const LawPoint  &point) const
      {
        // The steps of central differences balance truncation and rounding;
        // their lower bound at rest is small for stresses or strains of this
        // body.
        const Point<3> floor(1e-6 * stiffness.shear_modulus(),
                             1e-6 * stiffness.shear_modulus(),
                             1e-6);
        Slopes         result;
        for (unsigned int i = 0; i < 3; ++i)
          {
            const double h = 1e-5 * std::max(std::fabs(state[i]), floor[i]);
            Point<3>     left(state), right(state);
            right[i] += h;
            // Equivalent stress and strain are not negative.
            left[i] = i == 1 ? state[i] - h : std::max(0., state[i] - h);
            result.by[i] =
              point.parameters[factor] *
              (strain_rate(right, point) - strain_rate(left, point)) /
              (right[i] - left[i]);
          }
        result.secant = state[0] > 0 ? point.parameters[factor] *
                                         strain_rate(state, point) / state[0] :
                                       result.by[0];
        return result;
      }
    };
  } // namespace



  LawDescription
  parsed_description()
  {
    return {"parsed",
            "G = -E (3/2) F f dev(sigma)/sigma_eq with an equivalent strain "
            "rate f(sigma_eq, p, eps_eq, t) of your own and a `Factor' F. "
            "sigma_eq is the von Mises stress, p = -tr(sigma)/3 the pressure, "
            "eps_eq = sqrt(2/3) |dev(eps - E^-1 sigma)| the present equivalent "
            "viscoplastic strain. Let f vanish at sigma_eq = 0 and limit "
            "powers (the theory asks for a Lipschitz function), as in "
            "1e-3*min(sigma_eq, 2e7)^3. Examples: "
            "1e-21*sigma_eq^2*exp(-eps_eq/0.1) for primary creep, 1e-12*max(0, "
            "sigma_eq - 1e6 - 0.5*p) for flow beyond a yield stress that grows "
            "with pressure.",
            declare_entries(
              {{"Strain rate",
                "sigma_eq",
                "f >= 0, an expression of sigma_eq, p, eps_eq, the "
                "temperature T and t. Unit: 1/time."},
               {"Factor", "1", "F >= 0. Unit: 1."}}),
            make_law<Parsed>};
  }
} // namespace Viscoplastic
