// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/laws/arrhenius.h>

#include <utility>

namespace Viscoplastic
{
  namespace
  {
    class Arrhenius final : public ViscoplasticLaw
    {
    public:
      Arrhenius(std::unique_ptr<ViscoplasticLaw> law_,
                const double                     activation_temperature,
                const double                     law_temperature)
        : ViscoplasticLaw({}, law_->n_history_variables)
        , law(std::move(law_))
        , activation_temperature(activation_temperature)
        , inverse_law_temperature(1. / law_temperature)
      {}

      LawPoint
      point(const Point<3> &x,
            const double    t,
            const double    temperature) const override
      {
        return law->point(x, t, temperature);
      }

      bool
      depends_on_position() const override
      {
        return law->depends_on_position();
      }

      bool
      depends_on_time() const override
      {
        return law->depends_on_time();
      }

      bool
      has_parameters_of_temperature() const override
      {
        return law->has_parameters_of_temperature();
      }

      bool
      depends_on_temperature() const override
      {
        return true;
      }

      bool
      needs_absolute_temperature() const override
      {
        return true;
      }

      void
      check(const Stiffness &stiffness, const LawPoint &point) const override
      {
        law->check(stiffness, point);
      }

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> &strain,
           const Stiffness             &stiffness,
           const LawPoint              &point) const override
      {
        return factor(point) * law->rate(stress, strain, stiffness, point);
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> &strain,
               const Stiffness             &stiffness,
               const LawPoint              &point) const override
      {
        Tangents     result = law->tangents(stress, strain, stiffness, point);
        const double f      = factor(point);
        result.stress *= f;
        result.strain *= f;
        return result;
      }

      SymmetricTensor<2, 3>
      history_rate(const SymmetricTensor<2, 3> &stress,
                   const SymmetricTensor<2, 3> &strain,
                   const Stiffness             &stiffness,
                   const LawPoint              &point) const override
      {
        return factor(point) *
               law->history_rate(stress, strain, stiffness, point);
      }

      // Multiplying rates by the factor is the same as multiplying the step k.

      SymmetricTensor<2, 3>
      history_after_step(const SymmetricTensor<2, 3> &stress,
                         const SymmetricTensor<2, 3> &strain,
                         const double                 k,
                         const Stiffness             &stiffness,
                         const LawPoint              &point) const override
      {
        return law->history_after_step(
          stress, strain, k * factor(point), stiffness, point);
      }

      Tangents
      step_tangents(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> &strain,
                    const double                 k,
                    const Stiffness             &stiffness,
                    const LawPoint              &point) const override
      {
        const double f = factor(point);
        Tangents     result =
          law->step_tangents(stress, strain, k * f, stiffness, point);
        result.stress *= f;
        result.strain *= f;
        return result;
      }

      bool
      has_constant_tangents() const override
      {
        return law->has_constant_tangents();
      }

      bool
      has_symmetric_tangents() const override
      {
        return law->has_symmetric_tangents();
      }

      std::optional<FlowSlopes>
      radial_flow(const double sigma_eq, const LawPoint &point) const override
      {
        auto result = law->radial_flow(sigma_eq, point);
        if (result)
          {
            const double f = factor(point);
            result->secant *= f;
            result->tangent *= f;
          }
        return result;
      }

      double
      relaxation_rate(const SymmetricTensor<2, 3> &stress,
                      const SymmetricTensor<2, 3> &strain,
                      const Stiffness             &stiffness,
                      const LawPoint              &point) const override
      {
        return factor(point) *
               law->relaxation_rate(stress, strain, stiffness, point);
      }

      bool
      deviatoric_flow() const override
      {
        return law->deviatoric_flow();
      }

      // Stored energy and driving strain do not depend on how fast the flow is.

      SymmetricTensor<2, 3>
      driving_strain(const SymmetricTensor<2, 3> &stress,
                     const SymmetricTensor<2, 3> &strain,
                     const Stiffness             &stiffness,
                     const LawPoint              &point) const override
      {
        return law->driving_strain(stress, strain, stiffness, point);
      }

      bool
      has_own_energy() const override
      {
        return law->has_own_energy();
      }

      double
      stored_energy(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> &strain,
                    const Stiffness             &stiffness,
                    const LawPoint              &point) const override
      {
        return law->stored_energy(stress, strain, stiffness, point);
      }

      bool
      has_cap() const override
      {
        return law->has_cap();
      }

      bool
      is_beyond_cap(const SymmetricTensor<2, 3> &stress,
                    const LawPoint              &point) const override
      {
        return law->is_beyond_cap(stress, point);
      }

      void
      flow(const LawStates &states, Flow *result) const override
      {
        law->flow(states, result);
        for (unsigned int i = 0; i < states.n; ++i)
          {
            const double f = factor(states.point[i]);
            result[i].rate *= f;
            result[i].relaxation_rate *= f;
          }
      }

      std::string
      announcement() const override
      {
        return law->announcement();
      }

    private:
      double
      factor(const LawPoint &point) const
      {
        return std::exp(activation_temperature *
                        (inverse_law_temperature - 1. / point.temperature));
      }

      const std::unique_ptr<const ViscoplasticLaw> law;
      const double activation_temperature, inverse_law_temperature;
    };
  } // namespace



  std::unique_ptr<ViscoplasticLaw>
  thermally_activated(std::unique_ptr<ViscoplasticLaw> law,
                      const double                     activation_temperature,
                      const double                     law_temperature)
  {
    return std::make_unique<Arrhenius>(std::move(law),
                                       activation_temperature,
                                       law_temperature);
  }
} // namespace Viscoplastic
