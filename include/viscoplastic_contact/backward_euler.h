// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/flow_laws.h>

namespace Viscoplastic
{
  /**
   * Backward Euler for one sample at a given strain: the z that solves
   *
   *     z = z_old + k G(t_n, E eps + z, eps)
   *
   * by Newton's method from @p start, damped so that the residual decreases,
   * and by continuation in k where that fails. @p point has the time t_n.
   * Throws ExcMessage if there is no solution within reach.
   */
  SymmetricTensor<2, 3>
  implicit_irreversible_stress(const ViscoplasticLaw       &law,
                               const SymmetricTensor<2, 3> &strain,
                               const SymmetricTensor<2, 3> &old_z,
                               const double                 k,
                               const Stiffness             &stiffness,
                               const LawPoint              &point,
                               const SymmetricTensor<2, 3> &start);

  /**
   * The algorithmic tangent, the derivative of sigma = E eps + z(eps):
   *
   *     C = (I - k dG/dsigma)^-1 (E + k dG/deps).
   *
   * Symmetric and positive definite if the flow has a potential, and E itself
   * where nothing flows.
   */
  SymmetricTensor<4, 3>
  algorithmic_tangent(const ViscoplasticLaw       &law,
                      const SymmetricTensor<2, 3> &stress,
                      const SymmetricTensor<2, 3> &strain,
                      const double                 k,
                      const Stiffness             &stiffness,
                      const LawPoint              &point);

  /**
   * What a solver may take for C: its symmetric part, moved towards E as far as
   * it takes to be positive definite. Laws without a potential, such as those
   * that harden, do not have a symmetric one.
   */
  SymmetricTensor<4, 3>
  definite_tangent(const SymmetricTensor<4, 3> &tangent,
                   const Stiffness             &stiffness);


  /**
   * The same at all samples: z_n for the strains of @p ghosted_u, from @p
   * start. Elastic cells keep their z. Throws on all ranks if there is no
   * solution at a sample of one. Collective.
   */
  template <int dim>
  IrreversibleStress
  implicit_irreversible_stress(const typename FlowLaws<dim>::AtTime &laws,
                               const StressSampling<dim>            &sampling,
                               const DistributedVector              &ghosted_u,
                               const IrreversibleStress             &old_z,
                               const double                          k,
                               const IrreversibleStress             &start);
} // namespace Viscoplastic
