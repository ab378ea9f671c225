// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/backward_euler.h>
#include <viscoplastic_contact/messages.h>

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// z - z_old - k G(E eps + z, eps) = 0 at one sample.
    struct SampleEquation
    {
      const ViscoplasticLaw       &law;
      const SymmetricTensor<2, 3> &strain, &old_z;
      const double                 k;
      const Stiffness             &stiffness;
      const LawPoint              &point;
      const SymmetricTensor<2, 3>  elastic = stiffness.stress(strain);

      SymmetricTensor<2, 3>
      residual(const SymmetricTensor<2, 3> &z) const
      {
        return z - old_z - k * law.rate(elastic + z, strain, stiffness, point);
      }

      /// Its norm; not finite where the law has no value, which a trial may
      /// meet.
      double
      try_residual(const SymmetricTensor<2, 3> &z,
                   SymmetricTensor<2, 3>       &F) const
      {
        try
          {
            F = residual(z);
            return norm(F);
          }
        catch (const ExceptionBase &)
          {
            return std::numeric_limits<double>::quiet_NaN();
          }
      }

      /// In the energy norm of stresses, in which flow with a potential is
      /// monotone.
      double
      norm(const SymmetricTensor<2, 3> &stress) const
      {
        return std::sqrt(stress * stiffness.strain(stress));
      }

      /// Newton's method; nothing if it fails.
      std::optional<SymmetricTensor<2, 3>>
      solve(SymmetricTensor<2, 3> z) const
      {
        const double          scale = norm(elastic) + norm(old_z) + norm(z);
        SymmetricTensor<2, 3> F;
        double                size = try_residual(z, F);
        for (unsigned int iteration = 0; iteration < 100; ++iteration)
          {
            if (size == 0.)
              return z;
            if (!std::isfinite(size))
              return {};
            const auto tangents =
              law.tangents(elastic + z, strain, stiffness, point);
            const SymmetricTensor<2, 3> step =
              -1. * (invert(identity_tensor<3>() - k * tangents.stress) * F);
            const double step_size = norm(step);
            if (!std::isfinite(step_size))
              return {};
            // Rounding of F, which k r multiplies, does not matter: that of
            // the correction does.
            if (step_size <= 1e-12 * scale)
              return z + step;
            double damping = 1.;
            for (;; damping *= 0.5)
              {
                // All that rounding leaves; beside a kink of the law, a shorter
                // step does better.
                if (damping < 1e-3 && step_size <= 1e-9 * scale)
                  return z + step;
                if (damping < 1e-9)
                  return {};
                const SymmetricTensor<2, 3> trial = z + damping * step;
                SymmetricTensor<2, 3>       F_trial;
                const double new_size = try_residual(trial, F_trial);
                if (new_size <= (1. - 1e-4 * damping) * size)
                  {
                    z    = trial;
                    F    = F_trial;
                    size = new_size;
                    break;
                  }
              }
          }
        return {};
      }
    };
  } // namespace



  SymmetricTensor<2, 3>
  implicit_irreversible_stress(const ViscoplasticLaw       &law,
                               const SymmetricTensor<2, 3> &strain,
                               const SymmetricTensor<2, 3> &old_z,
                               const double                 k,
                               const Stiffness             &stiffness,
                               const LawPoint              &point,
                               const SymmetricTensor<2, 3> &start)
  {
    // Where a law is steep, the way from zero stress is shorter.
    const SampleEquation equation{law, strain, old_z, k, stiffness, point};
    for (const auto &from : {start, -1. * equation.elastic})
      if (const auto z = equation.solve(from))
        return *z;

    // From k = 0, where z = z_old, in steps that adapt.
    SymmetricTensor<2, 3> z    = old_z;
    double                done = 0., step = 0.25;
    while (done < 1.)
      {
        const double next = std::min(1., done + step);
        if (const auto result =
              SampleEquation{law, strain, old_z, next * k, stiffness, point}
                .solve(z))
          {
            z    = *result;
            done = next;
            step *= 2.;
            continue;
          }
        step *= 0.25;
        if (step < 1e-8)
          {
            std::ostringstream message;
            message << "The stress of backward Euler at x = (" << point.x
                    << "), t = " << point.t
                    << " cannot be found for the time step " << k
                    << ": its law of flow may soften or jump there; take more "
                       "steps in 'Time/Phases'.";
            AssertThrow(false, ExcMessage(message.str()));
          }
      }
    return z;
  }



  SymmetricTensor<4, 3>
  algorithmic_tangent(const ViscoplasticLaw       &law,
                      const SymmetricTensor<2, 3> &stress,
                      const SymmetricTensor<2, 3> &strain,
                      const double                 k,
                      const Stiffness             &stiffness,
                      const LawPoint              &point)
  {
    const auto tangents = law.tangents(stress, strain, stiffness, point);
    const SymmetricTensor<4, 3> E = stiffness.tensor();
    // Exactly, so that a matrix is known to be that of an elastic body.
    if (tangents.stress.norm() == 0. && tangents.strain.norm() == 0.)
      return E;
    return invert(identity_tensor<3>() - k * tangents.stress) *
           (E + k * tangents.strain);
  }



  SymmetricTensor<4, 3>
  definite_tangent(const SymmetricTensor<4, 3> &tangent,
                   const Stiffness             &stiffness)
  {
    // Cholesky's factorisation of the matrix of components: its sign is that
    // of the tensor, in whatever basis. Relative to the elastic pivots.
    const auto is_definite = [](const SymmetricTensor<4, 3> &C,
                                const SymmetricTensor<4, 3> &E) {
      std::array<std::array<double, 6>, 6> factor;
      for (unsigned int i = 0; i < 6; ++i)
        for (unsigned int j = 0; j <= i; ++j)
          {
            double entry = C.access_raw_entry(6 * i + j);
            for (unsigned int l = 0; l < j; ++l)
              entry -= factor[i][l] * factor[j][l];
            if (j < i)
              factor[i][j] = entry / factor[j][j];
            else if (entry > 1e-9 * E.access_raw_entry(7 * i))
              factor[i][i] = std::sqrt(entry);
            else
              return false;
          }
      return true;
    };

    const SymmetricTensor<4, 3> E = stiffness.tensor();
    SymmetricTensor<4, 3>       C;
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        C.access_raw_entry(6 * i + j) =
          0.5 * (tangent.access_raw_entry(6 * i + j) +
                 tangent.access_raw_entry(6 * j + i));
    for (unsigned int tenths = 0; tenths < 10; ++tenths)
      {
        const double                share = 0.1 * tenths;
        const SymmetricTensor<4, 3> blend =
          tenths == 0 ? C : (1. - share) * C + share * E;
        if (is_definite(blend, E))
          return blend;
      }
    return E;
  }



  namespace
  {
    /// Newton's step for a law with constant tangents, which is exact; keeps
    /// the inverse of the last sample, of which most have the same.
    class LinearEquation
    {
    public:
      SymmetricTensor<2, 3>
      solve(const SampleEquation &equation, const SymmetricTensor<2, 3> &start)
      {
        if (law != &equation.law || stiffness != &equation.stiffness ||
            k != equation.k || parameters != equation.point.parameters)
          {
            law        = &equation.law;
            stiffness  = &equation.stiffness;
            k          = equation.k;
            parameters = equation.point.parameters;
            inverse    = invert(
              identity_tensor<3>() -
              k * law->tangents({}, {}, *stiffness, equation.point).stress);
          }
        return start - inverse * equation.residual(start);
      }

    private:
      const ViscoplasticLaw *law       = nullptr;
      const Stiffness       *stiffness = nullptr;
      double                 k         = 0.;
      std::array<double, 6>  parameters{};
      SymmetricTensor<4, 3>  inverse;
    };
  } // namespace



  template <int dim>
  IrreversibleStress
  implicit_irreversible_stress(const typename FlowLaws<dim>::AtTime &laws,
                               const StressSampling<dim>            &sampling,
                               const DistributedVector              &ghosted_u,
                               const IrreversibleStress             &old_z,
                               const double                          k,
                               const IrreversibleStress             &start)
  {
    IrreversibleStress                 z(old_z);
    std::vector<SymmetricTensor<2, 3>> strain(sampling.n_samples);
    LinearEquation                     linear_equation;
    const auto                         solve_cell = [&](const std::size_t c) {
      const ViscoplasticLaw &law       = *laws.law(c);
      const Stiffness       &stiffness = sampling.moduli(c);
      sampling.strains(c, ghosted_u.begin(), strain.data());
      for (unsigned int s = 0; s < sampling.n_samples; ++s)
        {
          const std::size_t i = c * sampling.n_samples + s;
          const LawPoint    point = laws.point(c, s);
          z[i] =
            law.has_constant_tangents() ?
                                      linear_equation.solve(
                {law, strain[s], old_z[i], k, stiffness, point}, start[i]) :
                                      implicit_irreversible_stress(
                law, strain[s], old_z[i], k, stiffness, point, start[i]);
        }
    };

    // A sample without a solution fails the step.
    fail_together(sampling.space.communicator, [&] {
      for (std::size_t c = 0; c < sampling.n_cells(); ++c)
        if (laws.law(c) != nullptr)
          solve_cell(c);
    });
    return z;
  }



  template IrreversibleStress
  implicit_irreversible_stress<2>(const FlowLaws<2>::AtTime &,
                                  const StressSampling<2> &,
                                  const DistributedVector &,
                                  const IrreversibleStress &,
                                  const double,
                                  const IrreversibleStress &);
  template IrreversibleStress
  implicit_irreversible_stress<3>(const FlowLaws<3>::AtTime &,
                                  const StressSampling<3> &,
                                  const DistributedVector &,
                                  const IrreversibleStress &,
                                  const double,
                                  const IrreversibleStress &);
} // namespace Viscoplastic
