// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/viscoplastic_law.h>

namespace Viscoplastic
{
  LawDescription
  perzyna_description();

  namespace
  {
    /**
     * G = -(1/lambda) E (sigma - P_K sigma) with the elastic range
     * K = {|dev sigma| <= k_Y}. The projection P_K shortens the deviator to
     * the length k_Y and leaves the pressure alone, so that with s = dev sigma
     *
     *     sigma - P_K sigma = (1 - k_Y/|s|)_+ s.
     */
    class Perzyna : public ViscoplasticLaw
    {
    public:
      Perzyna(const double yield_radius, const double viscosity)
        : yield_radius(yield_radius)
        , viscosity(viscosity)
      {}

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> & /*strain*/,
           const Stiffness &stiffness,
           const LawPoint & /*point*/) const override
      {
        const SymmetricTensor<2, 3> s      = deviator(stress);
        const double                length = s.norm();
        // In this sense of the comparison a NaN goes on, and is seen.
        if (length <= yield_radius)
          return {};
        return stiffness.stress((1 - yield_radius / length) / -viscosity * s);
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> & /*strain*/,
               const Stiffness &stiffness,
               const LawPoint & /*point*/) const override
      {
        Tangents                    tangents;
        const SymmetricTensor<2, 3> s      = deviator(stress);
        const double                length = s.norm();
        if (length <= yield_radius)
          return tangents;

        // Along s the excess grows one to one; across s it only turns.
        const SymmetricTensor<2, 3> e     = s / length;
        const double                ratio = yield_radius / length;
        tangents.stress =
          stiffness.tensor() *
          ((1 - ratio) * deviator_tensor<3>() + ratio * outer_product(e, e)) /
          -viscosity;
        return tangents;
      }

      double
      relaxation_rate(const SymmetricTensor<2, 3> & /*stress*/,
                      const SymmetricTensor<2, 3> & /*strain*/,
                      const Stiffness &stiffness,
                      const LawPoint & /*point*/) const override
      {
        // Not zero inside K: the next step may begin outside.
        return stiffness.largest_deviatoric_eigenvalue() / viscosity;
      }

      bool
      deviatoric_flow() const override
      {
        return true;
      }

    private:
      const double yield_radius;
      const double viscosity;
    };
  } // namespace



  LawDescription
  perzyna_description()
  {
    LawDescription law;
    law.name = "perzyna";
    law.help =
      "G = -(1/lambda) E (sigma - P_K sigma), where P_K projects on the "
      "elastic range K of all stresses with |dev(sigma)| <= k_Y in the "
      "Frobenius norm: elastic inside K, and flowing in proportion to the "
      "distance from K outside, without hardening. Excess stress held at "
      "fixed strain decays like exp(-2 mu t/lambda) back to K. k_Y is the "
      "`Yield radius' in Pa (the yield stress of a tensile test times "
      "sqrt(2/3), or of a shear test times sqrt(2)), lambda the `Viscosity' "
      "in Pa s (twice the shear viscosity of the flow beyond K). With k_Y = 0 "
      "it is maxwell with eta = lambda/2. Reference: P. Perzyna, Fundamental "
      "problems in viscoplasticity, Advances in Applied Mechanics 9 (1966) "
      "243-377; the form with P_K is that of G. Duvaut, J.-L. Lions, "
      "Inequalities in Mechanics and Physics, Springer 1976, chapter 5.";
    law.declare = [](ParameterHandler &prm) {
      prm.declare_entry("Yield radius",
                        "0.1",
                        Patterns::Double(),
                        "The radius k_Y of the elastic range, the largest "
                        "Frobenius norm of dev(sigma) without flow, unit of "
                        "stress; zero or positive.");
      prm.declare_entry("Viscosity",
                        "1",
                        Patterns::Double(),
                        "The viscosity lambda, stress times time; positive.");
    };
    law.make = [name = law.name](ParameterHandler &prm) {
      return std::make_unique<Perzyna>(get_non_negative(prm,
                                                        name,
                                                        "Yield radius"),
                                       get_positive(prm, name, "Viscosity"));
    };
    return law;
  }
} // namespace Viscoplastic
