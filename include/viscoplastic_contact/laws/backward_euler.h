// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/laws/viscoplastic_law.h>

namespace Viscoplastic
{
  /// The equation z - z_old - k G(t_n, E eps + z, eps) = 0 at one point. For
  /// laws with history variables, G is step_rate() here and below: @p point has
  /// the history variables at the beginning of the step.
  struct BackwardEulerEquation
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
      return z - old_z -
             k * law.step_rate(elastic + z, strain, k, stiffness, point);
    }

    /// Compute the residual @p F at a trial state and return its norm, which is
    /// NaN where the law has no value.
    double
    try_residual(const SymmetricTensor<2, 3> &z, SymmetricTensor<2, 3> &F) const
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

    /// The energy norm (tau : E^-1 tau)^(1/2), in which flow with a potential
    /// is monotone.
    double
    norm(const SymmetricTensor<2, 3> &stress) const
    {
      return std::sqrt(stress * stiffness.strain(stress));
    }

    /// Damped Newton's method; returns nothing if it fails.
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
            law.step_tangents(elastic + z, strain, k, stiffness, point);
          const SymmetricTensor<2, 3> step =
            -1. * (invert(identity_tensor<3>() - k * tangents.stress) * F);
          const double step_size = norm(step);
          if (!std::isfinite(step_size))
            return {};
          // Test the correction: rounding errors of F may be k r times as
          // large.
          if (step_size <= 1e-12 * scale)
            return z + step;
          double damping = 1.;
          for (;; damping *= 0.5)
            {
              // Accept the level of rounding, but only after damping, which
              // helps beside a kink of the law.
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


  /// Backward Euler at one point for a given strain: return the z that solves
  ///
  ///     z = z_old + k G(t_n, E eps + z, eps)
  ///
  /// by Newton's method from @p start, damped so that the residual decreases,
  /// and by continuation in k where that fails. @p point has the time t_n.
  /// Throws ExcMessage if no solution is found.
  SymmetricTensor<2, 3>
  implicit_irreversible_stress(const ViscoplasticLaw       &law,
                               const SymmetricTensor<2, 3> &strain,
                               const SymmetricTensor<2, 3> &old_z,
                               const double                 k,
                               const Stiffness             &stiffness,
                               const LawPoint              &point,
                               const SymmetricTensor<2, 3> &start);

  /// The algorithmic (consistent) tangent of Simo and Taylor, Comput. Methods
  /// Appl. Mech. Eng. 48, 1985: the derivative of sigma = E eps + z(eps),
  ///
  ///     C = (I - k dG/dsigma)^-1 (E + k dG/deps).
  ///
  /// Symmetric and positive definite if the flow has a potential, and E itself
  /// where nothing flows.
  SymmetricTensor<4, 3>
  algorithmic_tangent(const ViscoplasticLaw       &law,
                      const SymmetricTensor<2, 3> &stress,
                      const SymmetricTensor<2, 3> &strain,
                      const double                 k,
                      const Stiffness             &stiffness,
                      const LawPoint              &point);

  /// The symmetric part of C, moved towards E until it is positive definite. C
  /// itself is not symmetric for laws without a potential, such as hardening.
  SymmetricTensor<4, 3>
  definite_tangent(const SymmetricTensor<4, 3> &tangent,
                   const Stiffness             &stiffness);

  /// The map (I - k dG/dsigma)^-1, by which relaxation in a step reduces an
  /// error of z at a given strain. Radial flow in isotropic bodies needs no
  /// tensor: deviators are scaled by one factor, and their part along a
  /// direction by another one in addition.
  struct ErrorRelaxation
  {
    double                               of_deviators = 1., more_along = 0.;
    SymmetricTensor<2, 3>                direction;
    std::optional<SymmetricTensor<4, 3>> any; // if set, used alone

    /// Become the map for radial flow that divides the deviator of a trial
    /// stress by 1 + a, and changes of it along @p flow by 1 + b.
    void
    set_radial(const double                 a,
               const double                 b,
               const SymmetricTensor<2, 3> &flow)
    {
      const double square = flow * flow;
      of_deviators        = 1. / (1. + a);
      more_along = square > 0. ? (a - b) / ((1. + a) * (1. + b) * square) : 0.;
      direction  = flow;
    }

    SymmetricTensor<2, 3>
    operator*(const SymmetricTensor<2, 3> &error) const
    {
      if (any)
        return *any * error;
      SymmetricTensor<2, 3> result = of_deviators * error;
      if (more_along != 0.)
        result += (more_along * (direction * error)) * direction;
      const double pressure = (1. - of_deviators) / 3. * trace(error);
      for (unsigned int d = 0; d < 3; ++d)
        result[d][d] += pressure;
      return result;
    }
  };

  ErrorRelaxation
  error_relaxation(const ViscoplasticLaw       &law,
                   const SymmetricTensor<2, 3> &stress,
                   const SymmetricTensor<2, 3> &strain,
                   const double                 k,
                   const Stiffness             &stiffness,
                   const LawPoint              &point);

  /// The positive definite tangent that linear solvers use in the place of C:
  /// definite_tangent() of algorithmic_tangent(); in closed form for radial
  /// flow in isotropic bodies. Also computes the inverse @p compliance, if
  /// given.
  SymmetricTensor<4, 3>
  step_tangent(const ViscoplasticLaw       &law,
               const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> &strain,
               const double                 k,
               const Stiffness             &stiffness,
               const LawPoint              &point,
               SymmetricTensor<4, 3>       *compliance = nullptr);
} // namespace Viscoplastic
