// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/flow_laws.h>

namespace Viscoplastic
{
  /// Backward Euler at all samples: z_n for the strains of @p ghosted_u, from
  /// @p start. Elastic cells keep their z. Throws on all ranks if there is no
  /// solution at a sample of one. Collective.
  template <int dim>
  IrreversibleStress
  implicit_irreversible_stress(const typename FlowLaws<dim>::AtTime &laws,
                               const StressSpace<dim>   &stress_space,
                               const DistributedVector  &ghosted_u,
                               const IrreversibleStress &old_z,
                               const double              k,
                               const IrreversibleStress &start);

  /// Backward Euler for the history variables of a state, whose stress is that
  /// of the end of the step, with those of the beginning. Collective.
  template <int dim>
  void
  advance_history(const typename FlowLaws<dim>::AtTime &laws,
                  const StressSpace<dim>               &stress_space,
                  const double                          k,
                  State<dim>                           &state);
} // namespace Viscoplastic
