// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/laws/pointwise_law.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  LawDescription
  burgers_description();
  LawDescription
  lubby2_description();

  namespace
  {
    /// A spring, a dashpot and a Kelvin body in series. The history variables
    /// are the strain e of the Kelvin body. With s = dev sigma,
    ///
    ///     e' = (s - 2 G_K e)/(2 eta_K),   G = -E (s/(2 eta_M) + e').
    ///
    /// In Lubby2, eta_M, G_K and eta_K are their values at zero stress times
    /// exp(m sigma_eq), exp(k_1 sigma_eq) and exp(k_2 sigma_eq), where sigma_eq
    /// is at most the stress cap.
    class Burgers final : public PointwiseLaw<Burgers>
    {
    public:
      Burgers(const LawSection &section, const bool is_linear)
        : PointwiseLaw(read(section, is_linear),
                       SymmetricTensor<2, 3>::n_independent_components)
        , is_linear(is_linear)
      {}

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> &strain,
           const Stiffness             &stiffness,
           const LawPoint              &point) const override
      {
        return stiffness.stress(-coefficients(stress, point).maxwell *
                                  deviator(stress) -
                                history_rate(stress, strain, stiffness, point));
      }

      SymmetricTensor<2, 3>
      history_rate(const SymmetricTensor<2, 3> &stress,
                   const SymmetricTensor<2, 3> & /*strain*/,
                   const Stiffness & /*stiffness*/,
                   const LawPoint &point) const override
      {
        const Coefficients c = coefficients(stress, point);
        return c.kelvin * (deviator(stress) - c.modulus * *point.history);
      }

      SymmetricTensor<2, 3>
      history_after_step(const SymmetricTensor<2, 3> &stress,
                         const SymmetricTensor<2, 3> & /*strain*/,
                         const double k,
                         const Stiffness & /*stiffness*/,
                         const LawPoint &point) const override
      {
        const Coefficients c = coefficients(stress, point);
        return (*point.history + k * c.kelvin * deviator(stress)) /
               (1. + k * c.kelvin * c.modulus);
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> &strain,
               const Stiffness             &stiffness,
               const LawPoint              &point) const override
      {
        return step_tangents(stress, strain, 0., stiffness, point);
      }

      /// Uses e' = (s - 2 G_K e_old)/(2 (eta_K + k G_K)) after a step.
      Tangents
      step_tangents(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> & /*strain*/,
                    const double     k,
                    const Stiffness &stiffness,
                    const LawPoint  &point) const override
      {
        const Coefficients    c       = coefficients(stress, point);
        const double          damping = 1. / (1. + k * c.kelvin * c.modulus);
        SymmetricTensor<4, 3> slope =
          (c.maxwell + damping * c.kelvin) * deviator_tensor<3>();
        const SymmetricTensor<2, 3> s    = deviator(stress);
        const double                size = s.norm();
        if (!is_linear && size > 0.)
          slope += outer_product(
            c.maxwell_slope * s +
              damping * damping *
                (c.kelvin_slope - k * c.kelvin * c.kelvin * c.modulus_slope) *
                (s - c.modulus * *point.history) -
              damping * c.kelvin * c.modulus_slope * *point.history,
            std::sqrt(1.5) / size * s);
        return {stiffness.stress(-1. * slope), {}};
      }

      bool
      has_constant_tangents() const override
      {
        return is_linear;
      }

      bool
      has_symmetric_tangents() const override
      {
        return is_linear;
      }

      /// The largest eigenvalue of a 2 x 2 matrix for sigma and e, in which the
      /// stress dependence of the coefficients of Lubby2 enters by norms.
      double
      relaxation_rate(const SymmetricTensor<2, 3> &stress,
                      const SymmetricTensor<2, 3> & /*strain*/,
                      const Stiffness &stiffness,
                      const LawPoint  &point) const override
      {
        const Coefficients c = coefficients(stress, point);
        const double       E = stiffness.largest_deviatoric_eigenvalue();
        const SymmetricTensor<2, 3> of_kelvin =
          c.kelvin_slope * (deviator(stress) - c.modulus * *point.history) -
          c.kelvin * c.modulus_slope * *point.history;
        const double of_stress =
                       E * (c.maxwell + c.kelvin +
                            std::sqrt(1.5) *
                              (c.maxwell_slope * deviator(stress) + of_kelvin)
                                .norm()),
                     of_strain = c.kelvin * c.modulus,
                     coupling  = 4. * E * of_strain *
                                (c.kelvin + std::sqrt(1.5) * of_kelvin.norm()),
                     difference = of_stress - of_strain;
        return 0.5 * (of_stress + of_strain +
                      std::sqrt(difference * difference + coupling));
      }

      bool
      deviatoric_flow() const override
      {
        return true;
      }

      bool
      has_own_energy() const override
      {
        return true;
      }

      double
      stored_energy(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> & /*strain*/,
                    const Stiffness &stiffness,
                    const LawPoint  &point) const override
      {
        return 0.5 * (stress * stiffness.strain(stress) +
                      coefficients(stress, point).modulus *
                        (*point.history * *point.history));
      }

      bool
      has_cap() const override
      {
        return !is_linear;
      }

      bool
      is_beyond_cap(const SymmetricTensor<2, 3> &stress,
                    const LawPoint              &point) const override
      {
        return !is_linear && von_mises(stress) > point.parameters[cap];
      }

    private:
      // In the order of read(). The last four stay zero in the linear law.
      enum
      {
        maxwell_viscosity,
        kelvin_modulus,
        kelvin_viscosity,
        maxwell_exponent,
        modulus_exponent,
        kelvin_exponent,
        cap
      };

      static std::vector<LawParameter>
      read(const LawSection &section, const bool is_linear)
      {
        using Range = LawParameter::Range;
        std::vector<LawParameter> result;
        for (const char *entry :
             {"Maxwell viscosity", "Kelvin modulus", "Kelvin viscosity"})
          result.emplace_back(section, entry, Range::positive);
        if (!is_linear)
          {
            for (const char *entry : {"Maxwell viscosity exponent",
                                      "Kelvin modulus exponent",
                                      "Kelvin viscosity exponent"})
              result.emplace_back(section, entry, Range::non_positive);
            result.emplace_back(section, "Stress cap", Range::positive);
          }
        return result;
      }

      /// 1/(2 eta_M), 1/(2 eta_K), 2 G_K and their derivatives by sigma_eq.
      struct Coefficients
      {
        double maxwell, kelvin, modulus, maxwell_slope = 0., kelvin_slope = 0.,
                                         modulus_slope = 0.;
      };

      Coefficients
      coefficients(const SymmetricTensor<2, 3> &stress,
                   const LawPoint              &point) const
      {
        const auto  &p = point.parameters;
        Coefficients result{0.5 / p[maxwell_viscosity],
                            0.5 / p[kelvin_viscosity],
                            2. * p[kelvin_modulus]};
        if (is_linear)
          return result;
        const double sigma_eq = von_mises(stress),
                     capped   = std::min(sigma_eq, p[cap]);
        result.maxwell *= std::exp(-p[maxwell_exponent] * capped);
        result.kelvin *= std::exp(-p[kelvin_exponent] * capped);
        result.modulus *= std::exp(p[modulus_exponent] * capped);
        if (sigma_eq < p[cap])
          {
            result.maxwell_slope = -p[maxwell_exponent] * result.maxwell;
            result.kelvin_slope  = -p[kelvin_exponent] * result.kelvin;
            result.modulus_slope = p[modulus_exponent] * result.modulus;
          }
        return result;
      }

      const bool is_linear;
    };



    const std::vector<DeclaredEntry> linear_entries{
      {"Maxwell viscosity",
       "1",
       "The shear viscosity eta_M > 0 of steady creep. Unit: stress times "
       "time."},
      {"Kelvin modulus",
       "1",
       "The shear modulus G_K > 0, from which transient creep comes back. "
       "Unit: stress."},
      {"Kelvin viscosity",
       "1",
       "The shear viscosity eta_K > 0 of transient creep. Unit: stress times "
       "time."}};
  } // namespace



  LawDescription
  burgers_description()
  {
    return {"burgers",
            "G = -E (dev(sigma)/(2 eta_M) + e'), e' = (dev(sigma) - 2 G_K "
            "e)/(2 eta_K): steady creep after a transient one, whose strain e "
            "comes back when the load has gone. (Findley, Lai, Onaran, as of "
            "maxwell.)",
            declare_entries(linear_entries),
            [](const LawSection &section) {
              return std::make_unique<Burgers>(section, /* is_linear = */ true);
            }};
  }



  LawDescription
  lubby2_description()
  {
    std::vector<DeclaredEntry> entries(linear_entries);
    entries.insert(
      entries.end(),
      {{"Maxwell viscosity exponent", "0", "m <= 0. Unit: 1/stress."},
       {"Kelvin modulus exponent", "0", "k_1 <= 0. Unit: 1/stress."},
       {"Kelvin viscosity exponent", "0", "k_2 <= 0. Unit: 1/stress."},
       {"Stress cap",
        "",
        "The von Mises stress beyond which these factors stay as they are: "
        "above the stress you expect. It has to be given. Unit: stress."}});
    return {"lubby2",
            "burgers for rock salt: eta_M, G_K and eta_K, given for small "
            "stresses, are multiplied by exp(m sigma_eq), exp(k_1 sigma_eq) "
            "and exp(k_2 sigma_eq) with the von Mises stress sigma_eq. (Lux, "
            "Gebirgsmechanischer Entwurf und Felderfahrungen im "
            "Salzkavernenbau, 1984.)",
            declare_entries(entries),
            [](const LawSection &section) {
              if (section.prm.get("Stress cap").empty())
                refuse("'" + section.path +
                       "/Stress cap' is not given; beyond this von Mises "
                       "stress moduli and viscosities fall no further, so "
                       "choose one above the stress you expect.");
              return std::make_unique<Burgers>(section,
                                               /* is_linear = */ false);
            }};
  }
} // namespace Viscoplastic
