// SPDX-License-Identifier: LGPL-2.1-or-later

// The balance of energy over the steps of a run. Every test holds on any number
// of ranks.

#include "stepping_body.h"
#include <viscoplastic_contact/results/energy_balance.h>
#include <viscoplastic_contact/results/step_quantities.h>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  template <typename Dimension>
  class EnergyBalances : public testing::Test
  {};
  TYPED_TEST_SUITE(EnergyBalances, Dimensions);



  /// The energy balance of all steps of a body up to t = 1.
  template <int dim>
  EnergyBalance
  balance_of(SteppingBody<dim> &body)
  {
    EnergyBalance balance;
    balance.begin(energies_on_mesh(*body.discretization, body.accepted).stored);
    while (body.accepted.state.t < 1.)
      {
        const AcceptedStep<dim>   step = body.stepper->next(body.accepted);
        const StepQuantities<dim> quantities =
          measure_step(*body.discretization, body.accepted, step);
        // From nodal forces, and sample by sample.
        const FlowEnergies flow = energies_of_flow(body.discretization->laws,
                                                   body.accepted.state,
                                                   step.end.state);
        EXPECT_NEAR(quantities.flow.irreversible_energy,
                    flow.irreversible_energy,
                    1e-13 * quantities.stored_energy);
        EXPECT_NEAR(quantities.flow.viscous_dissipation,
                    flow.viscous_dissipation,
                    1e-13 * quantities.stored_energy);
        balance.add_step({quantities.stored_energy,
                          quantities.external_work,
                          quantities.flow.viscous_dissipation,
                          quantities.friction.dissipation});
        body.accepted = step.end;
      }
    return balance;
  }



  std::string
  tight()
  {
    return subsection("Solver", "set Contact tolerance = 1e-12");
  }



  TYPED_TEST(EnergyBalances, IsExactInTheBulk)
  {
    // The large friction bound makes all points stick.
    constexpr int dim = TypeParam::value;
    for (const std::string law : {"elastic", "maxwell", "zener"})
      for (const std::string scheme : {"forward Euler", "backward Euler"})
        {
          SCOPED_TRACE(law + ", " + scheme);
          SteppingBody<dim>   body(subsection("Material", "set Law = " + law) +
                                   time(scheme, "1: 4") + tight(),
                                 /* friction_bound = */ "1e3");
          const EnergyBalance balance = balance_of(body);
          EXPECT_GT(balance.external_work, 1e-3);
          EXPECT_EQ(balance.friction_dissipation, 0.);
          if (law == "elastic")
            EXPECT_EQ(balance.viscous_dissipation, 0.);
          else
            EXPECT_GT(balance.viscous_dissipation,
                      0.01 * balance.external_work);
          EXPECT_LT(std::abs(balance.defect()), 1e-9 * balance.external_work);
        }
  }



  TYPED_TEST(EnergyBalances, DefectOfFrictionVanishesWithTheStep)
  {
    constexpr int       dim = TypeParam::value;
    std::vector<double> defects;
    for (const std::string phases : {"1: 8", "1: 16", "1: 32"})
      {
        SteppingBody<dim>   body(maxwell + time("forward Euler", phases) +
                               tight());
        const EnergyBalance balance = balance_of(body);
        EXPECT_GT(balance.friction_dissipation, 0.01 * balance.external_work);
        defects.push_back(std::abs(balance.defect()) / balance.external_work);
      }
    EXPECT_LT(defects[0], 0.1);
    EXPECT_LT(defects[2], 0.6 * defects[1]);
    EXPECT_LT(defects[1], 0.8 * defects[0]);
  }



  TEST(EnergyBalance, MeshesAreNoPhysics)
  {
    EnergyBalance balance;
    balance.begin(1.);
    balance.add_step({3., 2.5, 0.25, 0.25});
    EXPECT_EQ(balance.defect(), 0.);
    // The energy grows by 1.5, of which 1 is work of the loads.
    balance.add_change({3., 4.}, {4.5, 5.}, balance.adaptation_energy);
    EXPECT_EQ(balance.adaptation_energy, 0.5);
    balance.add_step({4.5, -1., 0., 0.});
    EXPECT_EQ(balance.defect(), -1.);
    EXPECT_EQ(balance.external_work, 2.5);
    EXPECT_EQ(balance.scale(), 4.5);
  }
} // namespace
