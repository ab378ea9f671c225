// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/error/evaluated_state.h>
#include <viscoplastic_contact/laws/backward_euler.h>

namespace Viscoplastic
{
  /// What becomes of errors of z in a step, cell by cell.
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

    /// What stress at a given strain leaves of its error, at sample @p i, one
    /// of this cell. State and point count where it asks_for_stress.
    const ErrorRelaxation &
    relaxation_at(const std::size_t            i,
                  const SymmetricTensor<2, 3> &stress,
                  const SymmetricTensor<2, 3> &strain,
                  const LawPoint              &point);

    const StressSpace<dim>              &stress_space;
    const typename FlowLaws<dim>::AtTime now;
    const double                         k;
    const FlowRate                      &rate;

    // Of the cell:
    const ViscoplasticLaw               *law       = nullptr;
    const Stiffness                     *stiffness = nullptr;
    std::optional<SymmetricTensor<4, 3>> growth;
    /// What is left of an error that makes no stress, where it grows() with
    /// the strain.
    SymmetricTensor<4, 3> fading;
    bool                  asks_for_stress = false;

  private:
    ErrorRelaxation relaxation;
    bool            is_uniform = false, is_radial = false, is_known = false;
    std::size_t     cell = 0;
  };



  /// Let the carried error of z at the end of a step relax, with the carried
  /// error of u that it makes. Collective.
  template <int dim>
  void
  relax_carried_error(const FlowLaws<dim> &laws,
                      const State<dim>    &old,
                      EvaluatedState<dim> &end);
} // namespace Viscoplastic
