// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/laws/pointwise_law.h>

namespace Viscoplastic
{
  LawDescription
  maxwell_description();

  namespace
  {
    /// G = -E dev sigma/(2 eta): an elastic spring in series with a dashpot
    /// whose strain rate is dev sigma/(2 eta).
    class Maxwell final : public RadialLaw<Maxwell>
    {
    public:
      explicit Maxwell(const LawSection &section)
        : RadialLaw({{section, "Viscosity", LawParameter::Range::positive}})
      {}

      FlowSlopes
      slopes(const double /*sigma_eq*/, const LawPoint &point) const
      {
        const double fluidity = 1. / (3. * point.parameters[viscosity]);
        return {fluidity, fluidity};
      }

      bool
      has_constant_tangents() const override
      {
        return true;
      }

    private:
      enum
      {
        viscosity
      };
    };
  } // namespace



  LawDescription
  maxwell_description()
  {
    return {"maxwell",
            "G = -E dev(sigma)/(2 eta): a linear viscoelastic fluid, elastic "
            "under pressure. At fixed strain the deviator of the stress decays "
            "like exp(-t mu/eta). (Findley, Lai, Onaran, Creep and Relaxation "
            "of Nonlinear Viscoelastic Materials, 1976, chapter 5.)",
            declare_entries({{"Viscosity",
                              "0.5",
                              "The shear viscosity eta > 0. Unit: stress times "
                              "time."}}),
            make_law<Maxwell>};
  }
} // namespace Viscoplastic
