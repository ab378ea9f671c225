// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/tangent_matrix.h>
#include <viscoplastic_contact/laws/backward_euler.h>

namespace Viscoplastic
{
  namespace
  {
    /// Round a step size, a difference of times, to 34 bits, so that all steps
    /// of a phase have the same matrix.
    double
    without_rounding(const double k)
    {
      int          exponent;
      const double mantissa = std::frexp(k, &exponent);
      return std::ldexp(std::round(std::ldexp(mantissa, 34)), exponent - 34);
    }



    /// The trace of the product of two tensors, as linear maps of strains.
    double
    trace(const SymmetricTensor<4, 3> &a, const SymmetricTensor<4, 3> &b)
    {
      double sum = 0.;
      for (unsigned int i = 0; i < 6; ++i)
        for (unsigned int j = 0; j < 6; ++j)
          sum += (i < 3 ? 1. : 2.) * (j < 3 ? 1. : 2.) *
                 a.access_raw_entry(6 * i + j) * b.access_raw_entry(6 * j + i);
      return sum;
    }



    /// Poisson's ratio of the isotropic tensor nearest to this one.
    double
    poissons_ratio(const SymmetricTensor<4, 3> &tangent)
    {
      double I_C_I = 0., full_trace = 0.; // sums of C_iijj, C_ijij
      for (unsigned int i = 0; i < 6; ++i)
        full_trace += (i < 3 ? 1. : 2.) * tangent.access_raw_entry(7 * i);
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          I_C_I += tangent.access_raw_entry(6 * i + j);
      const double bulk = I_C_I / 9., mu = (full_trace - I_C_I / 3.) / 10.;
      return (3. * bulk - 2. * mu) / (6. * bulk + 2. * mu);
    }
  } // namespace



  template <int dim>
  TangentMatrix<dim>::TangentMatrix(const FlowLaws<dim>     &laws,
                                    const DistributedMatrix &elastic,
                                    const bool               has_norms)
    : is_constant(laws.have_constant_tangents())
    , laws(laws)
    , elastic_matrix(elastic)
    , has_norms(has_norms)
  {}



  template <int dim>
  bool
  TangentMatrix<dim>::linearize(const DistributedVector              &ghosted_u,
                                const IrreversibleStress             &z,
                                const typename FlowLaws<dim>::AtTime &now,
                                const double                          k_exact)
  {
    const double k = is_constant ? without_rounding(k_exact) : k_exact;
    if (is_constant && k == step_size)
      return false;

    const StressSpace<dim>            &stress_space = laws.stress_space;
    const unsigned int                 n            = stress_space.n_samples;
    std::vector<SymmetricTensor<2, 3>> strain(n);
    const MPI_Comm                     comm = stress_space.space.communicator;
    // Tangents count as new at the first call, also on ranks without cells, and
    // after a call that has thrown.
    const double old_max_nu = max_nu;
    bool         is_same    = max_nu > -1.;
    max_nu                  = -1.;
    step_size               = 0.;
    tangents.resize(stress_space.n_cells() * n);
    compliances.resize(has_norms ? tangents.size() : 0);
    double                largest = 1., largest_nu = -1.;
    const Stiffness      *last = nullptr;
    SymmetricTensor<4, 3> E, E_inverse;
    // A law without derivatives at a sample throws, on all ranks together.
    fail_together(comm, [&] {
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        {
          const ViscoplasticLaw *law       = now.law(c);
          const Stiffness       &stiffness = stress_space.moduli(c);
          if (&stiffness != last)
            {
              E         = stiffness.tensor();
              E_inverse = invert(E);
              last      = &stiffness;
            }
          if (law)
            stress_space.strains(c, ghosted_u.begin(), strain.data());
          for (unsigned int s = 0; s < n; ++s)
            {
              const std::size_t           i = c * n + s;
              const SymmetricTensor<4, 3> next =
                law ? step_tangent(*law,
                                   stiffness.stress(strain[s]) + z[i],
                                   now.mechanical(strain[s], c, s),
                                   k,
                                   stiffness,
                                   now.point(c, s),
                                   has_norms ? &compliances[i] : nullptr) :
                      E;
              is_same     = is_same && next == tangents[i];
              tangents[i] = next;
              largest_nu  = std::max(largest_nu, poissons_ratio(tangents[i]));
              if (!has_norms)
                continue;
              if (!law)
                compliances[i] = E_inverse;
              // The trace of C^-1 E minus 5 bounds its largest eigenvalue: with
              // a potential, the other five are at least 1.
              largest = std::max(largest, trace(compliances[i], E) - 5.);
            }
        }
    });
    step_size = k;
    if (Utilities::MPI::min(is_same ? 1 : 0, comm) == 1)
      {
        max_nu = old_max_nu;
        return false;
      }
    max_nu = Utilities::MPI::max(largest_nu, comm);
    ratio  = std::sqrt(Utilities::MPI::max(largest, comm));
    assemble();
    return true;
  }



  template <int dim>
  void
  TangentMatrix<dim>::assemble()
  {
    const StressSpace<dim>     &stress_space = laws.stress_space;
    const AdmissibleSpace<dim> &space        = stress_space.space;
    const unsigned int          n            = stress_space.n_samples;
    tangent_matrix                           = elastic_matrix;

    FullMatrix<double>                   cell_matrix;
    std::vector<types::global_dof_index> dofs;
    std::vector<SymmetricTensor<4, 3>>   change(n);
    std::size_t                          index = 0;
    const Stiffness                     *last  = nullptr;
    SymmetricTensor<4, 3>                E;
    for (const auto &cell : space.cells)
      {
        const std::size_t c     = index++;
        bool              flows = false;
        if (&stress_space.moduli(c) != last)
          {
            last = &stress_space.moduli(c);
            E    = last->tensor();
          }
        for (unsigned int s = 0; s < n; ++s)
          {
            change[s] = tangents[c * n + s] - E;
            flows |= tangents[c * n + s] != E;
          }
        if (!flows)
          continue;
        space.get_dofs(cell, dofs);
        cell_matrix.reinit(dofs.size(), dofs.size());
        stress_space.add_stiffness(c, change.data(), cell_matrix);
        space.add_cell_matrix(dofs, cell_matrix, tangent_matrix);
      }
    tangent_matrix.compress();
  }



  template <int dim>
  IrreversibleStress
  TangentMatrix<dim>::extrapolate(const IrreversibleStress &z,
                                  const DistributedVector  &ghosted_from,
                                  const DistributedVector  &ghosted_to) const
  {
    const StressSpace<dim>            &stress_space = laws.stress_space;
    const unsigned int                 n            = stress_space.n_samples;
    IrreversibleStress                 result(z);
    std::vector<SymmetricTensor<2, 3>> from(n), to(n);
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      {
        const Stiffness &stiffness = stress_space.moduli(c);
        stress_space.strains(c, ghosted_from.begin(), from.data());
        stress_space.strains(c, ghosted_to.begin(), to.data());
        for (unsigned int s = 0; s < n; ++s)
          {
            const SymmetricTensor<2, 3> change = to[s] - from[s];
            result[c * n + s] +=
              tangents[c * n + s] * change - stiffness.stress(change);
          }
      }
    return result;
  }



  template <int dim>
  double
  TangentMatrix<dim>::norm(const IrreversibleStress &stress) const
  {
    const StressSpace<dim> &stress_space = laws.stress_space;
    const unsigned int      n            = stress_space.n_samples;
    double                  sum          = 0.;
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      for (unsigned int s = 0; s < n; ++s)
        {
          const SymmetricTensor<2, 3> &tau = stress[c * n + s];
          sum +=
            stress_space.weight(c, s) * (tau * (compliances[c * n + s] * tau));
        }
    return std::sqrt(Utilities::MPI::sum(sum, stress_space.space.communicator));
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(TangentMatrix);
} // namespace Viscoplastic
