// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/implicit_flow.h>
#include <viscoplastic_contact/laws/backward_euler.h>

namespace Viscoplastic
{
  namespace
  {
    /// Newton's step for a law with constant tangents, which is exact; keeps
    /// the inverse of the last sample, of which most have the same.
    class LinearEquation
    {
    public:
      SymmetricTensor<2, 3>
      solve(const BackwardEulerEquation &equation,
            const SymmetricTensor<2, 3> &start)
      {
        if (law != &equation.law || stiffness != &equation.stiffness ||
            k != equation.k || parameters != equation.point.parameters ||
            temperature != equation.point.temperature)
          {
            law         = &equation.law;
            stiffness   = &equation.stiffness;
            k           = equation.k;
            parameters  = equation.point.parameters;
            temperature = equation.point.temperature;
            inverse     = invert(
              identity_tensor<3>() -
              k * law->step_tangents({}, {}, k, *stiffness, equation.point)
                    .stress);
          }
        return start - inverse * equation.residual(start);
      }

    private:
      const ViscoplasticLaw *law       = nullptr;
      const Stiffness       *stiffness = nullptr;
      double                 k         = 0.;
      LawParameters          parameters{};
      double                 temperature = 0.;
      SymmetricTensor<4, 3>  inverse;
    };
  } // namespace



  template <int dim>
  IrreversibleStress
  implicit_irreversible_stress(const typename FlowLaws<dim>::AtTime &laws,
                               const StressSpace<dim>   &stress_space,
                               const DistributedVector  &ghosted_u,
                               const IrreversibleStress &old_z,
                               const double              k,
                               const IrreversibleStress &start)
  {
    IrreversibleStress                 z(old_z);
    std::vector<SymmetricTensor<2, 3>> strain(stress_space.n_samples);
    LinearEquation                     linear_equation;
    const auto                         solve_cell = [&](const std::size_t c) {
      const ViscoplasticLaw &law = *laws.law(c);
      const Stiffness       &stiffness = stress_space.moduli(c);
      stress_space.strains(c, ghosted_u.begin(), strain.data());
      // An inverse for one sample costs more than radial return.
      const bool keeps_inverse =
        law.has_constant_tangents() &&
        !(laws.varies_in_space(c) && stiffness.is_isotropic() &&
          law.radial_flow(0., laws.point(c, 0)));
      for (unsigned int s = 0; s < stress_space.n_samples; ++s)
        {
          const std::size_t i = c * stress_space.n_samples + s;
          const LawPoint    point = laws.point(c, s);
          // The stress is that of the mechanical strain and the part of z that
          // is not thermal.
          const SymmetricTensor<2, 3> strain_of_law =
            laws.mechanical(strain[s], c, s);
          const double                excess = laws.thermal_strain(c, s);
          const SymmetricTensor<2, 3> thermal =
            excess != 0. ? ThermalStrain<dim>::stress(stiffness, excess) :
                                                   SymmetricTensor<2, 3>();
          const SymmetricTensor<2, 3> old = old_z[i] - thermal,
                                      from = start[i] - thermal;
          z[i]                             = thermal +
                 (keeps_inverse ?
                                            linear_equation.solve(
                      {law, strain_of_law, old, k, stiffness, point}, from) :
                                            implicit_irreversible_stress(
                      law, strain_of_law, old, k, stiffness, point, from));
        }
    };

    // A sample without a solution fails the step.
    fail_together(stress_space.space.communicator, [&] {
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        if (laws.law(c) != nullptr)
          solve_cell(c);
    });
    return z;
  }



  template <int dim>
  void
  advance_history(const typename FlowLaws<dim>::AtTime &laws,
                  const StressSpace<dim>               &stress_space,
                  const double                          k,
                  State<dim>                           &state)
  {
    if (!stress_space.space.scene.has_history())
      return;
    const unsigned int                 n = stress_space.n_samples;
    std::vector<SymmetricTensor<2, 3>> strain(n);
    fail_together(stress_space.space.communicator, [&] {
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        if (const ViscoplasticLaw *law = laws.law(c);
            law && law->n_history_variables > 0)
          {
            const Stiffness &stiffness = stress_space.moduli(c);
            stress_space.strains(c, state.u.begin(), strain.data());
            for (unsigned int s = 0; s < n; ++s)
              state.history[c * n + s] =
                law->history_after_step(stiffness.stress(strain[s]) +
                                          state.z[c * n + s],
                                        laws.mechanical(strain[s], c, s),
                                        k,
                                        stiffness,
                                        laws.point(c, s));
          }
    });
  }



  VISCOPLASTIC_INSTANTIATE(advance_history);
  VISCOPLASTIC_INSTANTIATE(implicit_irreversible_stress);
} // namespace Viscoplastic
