// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/error/evaluated_state.h>
#include <viscoplastic_contact/laws/backward_euler.h>

namespace Viscoplastic
{
  /// Computes by which factors errors of z decay in a step, cell by cell.
  template <int dim>
  class ErrorDecay
  {
  public:
    ErrorDecay(const FlowLaws<dim>       &laws,
               const State<dim>          &old,
               const EvaluatedState<dim> &end)
      : stress_space(laws.stress_space)
      , now(laws.at(end.state.t, old.history))
      , k(end.state.k)
      , rate(*end.rate)
    {}

    /// Set what all samples of a cell have in common.
    void
    enter(const std::size_t c);

    /// Return the map from a stress error before the step to that after it, at
    /// fixed strain, for sample @p i of the present cell. The other arguments
    /// are used only if asks_for_stress.
    const ErrorRelaxation &
    relaxation_at(const std::size_t            i,
                  const SymmetricTensor<2, 3> &stress,
                  const SymmetricTensor<2, 3> &strain,
                  const LawPoint              &point);

    const StressSpace<dim>              &stress_space;
    const typename FlowLaws<dim>::AtTime now;
    const double                         k;
    const FlowRate                      &rate;

    // Data of the present cell:
    const ViscoplasticLaw               *law       = nullptr;
    const Stiffness                     *stiffness = nullptr;
    std::optional<SymmetricTensor<4, 3>> growth;
    /// (1 + growth)^-1, the decay of errors of z that make no stress.
    SymmetricTensor<4, 3> fading;
    bool                  asks_for_stress = false;

  private:
    ErrorRelaxation relaxation;
    bool            is_uniform = false, is_radial = false, is_known = false;
    std::size_t     cell = 0;
  };



  /// Relax State::carried_error at the end of a step, given the error of u that
  /// it makes, State::carried_error_of_u. Collective.
  template <int dim>
  void
  relax_carried_error(const FlowLaws<dim> &laws,
                      const State<dim>    &old,
                      EvaluatedState<dim> &end);
} // namespace Viscoplastic
