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
    ErrorDecay(const FlowLaws<dim> &laws,
               const State<dim>    &old,
               const State<dim>    &end)
      : stress_space(laws.stress_space)
      , now(laws.at(end.t, old.history))
      , k(end.k)
    {}

    /// Set what all samples of a cell have in common.
    void
    enter(const std::size_t c);

    /// What stress at a given strain leaves of its error, at a sample of this
    /// cell.
    const ErrorRelaxation &
    relaxation_at(const SymmetricTensor<2, 3> &stress,
                  const SymmetricTensor<2, 3> &strain,
                  const LawPoint              &point);

    const StressSpace<dim>              &stress_space;
    const typename FlowLaws<dim>::AtTime now;
    const double                         k;

    // Of the cell:
    const ViscoplasticLaw               *law       = nullptr;
    const Stiffness                     *stiffness = nullptr;
    std::optional<SymmetricTensor<4, 3>> growth;
    /// What is left of an error that makes no stress, where it grows() with
    /// the strain.
    SymmetricTensor<4, 3> fading;
    bool                  is_uniform = false;

  private:
    ErrorRelaxation relaxation;
    bool            is_known = false;
    std::size_t     cell     = 0;
  };



  /// Let the carried error of z at the end of a step relax, with the carried
  /// error of u that it makes. Collective.
  template <int dim>
  void
  relax_carried_error(const FlowLaws<dim> &laws,
                      const State<dim>    &old,
                      EvaluatedState<dim> &end);
} // namespace Viscoplastic
