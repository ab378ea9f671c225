// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>

#include <vector>

namespace Viscoplastic
{
  /// The matrix of a step of backward Euler,
  ///
  ///     a(u, v) + sum_s w_s (C_s - E) eps_s(u) : eps_s(v),
  ///
  /// with an algorithmic tangent C_s at each sample of the flow law; strain
  /// variations within cells that samples do not see stay elastic.
  template <int dim>
  class TangentMatrix
  {
  public:
    /// Keeps references to @p laws and @p elastic, the matrix of a(u, v).
    /// @p has_norms: whether norm_ratio() and norm() are available.
    TangentMatrix(const FlowLaws<dim>     &laws,
                  const DistributedMatrix &elastic,
                  const bool               has_norms = true);

    /// Whether the tangents depend on the step size alone.
    const bool is_constant;

    /// Compute the tangents at the strain of @p ghosted_u and at @p z, for the
    /// laws at the end of the step and the history variables of its beginning,
    /// and assemble the matrix if the tangents differ from its present ones.
    /// Returns whether the matrix has changed. Collective.
    bool
    linearize(const DistributedVector              &ghosted_u,
              const IrreversibleStress             &z,
              const typename FlowLaws<dim>::AtTime &now,
              const double                          k);

    const DistributedMatrix &
    matrix() const
    {
      return tangent_matrix;
    }

    /// The tangents C = d sigma/d eps at the samples, unit of stress.
    const std::vector<SymmetricTensor<4, 3>> &
    at_samples() const
    {
      return tangents;
    }

    /// The largest Poisson's ratio of the isotropic tensors nearest to
    /// tangents.
    double
    max_poissons_ratio() const
    {
      return max_nu;
    }

    /// A bound on the energy norm of a(.,.) over that of the matrix, at least
    /// 1 and about (1 + k r)^(1/2).
    double
    norm_ratio() const
    {
      return ratio;
    }

    /// z + (C - E) (eps(to) - eps(from)), at the samples.
    IrreversibleStress
    extrapolate(const IrreversibleStress &z,
                const DistributedVector  &ghosted_from,
                const DistributedVector  &ghosted_to) const;

    /// The norm of stresses (sum_s w_s C^-1 tau : tau)^(1/2). It bounds the
    /// norm of the functional sum_s w_s tau : eps_s(v) in the dual of the
    /// matrix's energy norm. Collective.
    double
    norm(const IrreversibleStress &stress) const;

  private:
    void
    assemble();

    const FlowLaws<dim>               &laws;
    const DistributedMatrix           &elastic_matrix;
    const bool                         has_norms;
    std::vector<SymmetricTensor<4, 3>> tangents, compliances; // one per sample
    DistributedMatrix                  tangent_matrix;
    double                             step_size = 0., max_nu = -1., ratio = 1.;
  };
} // namespace Viscoplastic
