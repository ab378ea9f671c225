// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/laws/backward_euler.h>


namespace Viscoplastic
{
  namespace
  {
    // The limit on steps of continuation, including failed ones; a law without
    // jumps needs fewer.
    const unsigned int most_steps_in_k = 1000;



    /// Radial return in an isotropic body: with the trial stress E eps + z_old,
    /// whose deviator keeps its direction, sigma_eq solves
    ///
    ///     sigma_eq + 3 mu k f(sigma_eq) = sigma_eq of the trial stress.
    ///
    /// The left side is convex: Newton's method comes from above after its
    /// first step. Returns nothing if the body is anisotropic, or if the law
    /// has no radial flow or no value.
    std::optional<SymmetricTensor<2, 3>>
    radial_return(const BackwardEulerEquation &equation,
                  const SymmetricTensor<2, 3> &start)
    {
      if (!equation.stiffness.is_isotropic() ||
          !equation.law.radial_flow(0., equation.point))
        return {};
      const SymmetricTensor<2, 3> trial =
        deviator(equation.elastic + equation.old_z);
      const double trial_size = std::sqrt(1.5) * trial.norm(),
                   factor =
                     3. * equation.stiffness.shear_modulus() * equation.k;
      double sigma = std::min(von_mises(equation.elastic + start), trial_size);
      for (unsigned int iteration = 0; iteration < 200; ++iteration)
        {
          const auto   f    = equation.law.radial_flow(sigma, equation.point);
          const double step = (trial_size - sigma * (1. + factor * f->secant)) /
                              (1. + factor * f->tangent);
          if (!std::isfinite(step))
            return {};
          if (std::abs(step) <= 1e-13 * sigma || trial_size == 0.)
            {
              const double flow = factor * f->secant;
              return equation.old_z - flow / (1. + flow) * trial;
            }
          sigma = std::min(sigma + step, trial_size);
        }
      return {};
    }



    /// Return dev P + vol I (x) I + along s (x) s, where P takes the deviator.
    SymmetricTensor<4, 3>
    transversal_tensor(const double                 dev,
                       const double                 vol,
                       const double                 along,
                       const SymmetricTensor<2, 3> &s)
    {
      SymmetricTensor<4, 3> result;
      double               *C          = result.begin_raw();
      const double         *components = s.begin_raw();
      for (unsigned int i = 0; i < 6; ++i)
        for (unsigned int j = 0; j < 6; ++j)
          C[6 * i + j] = along * components[i] * components[j];
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          C[6 * i + j] += vol - dev / 3.;
      for (unsigned int i = 0; i < 6; ++i)
        C[7 * i] += i < 3 ? dev : 0.5 * dev;
      return result;
    }



    /// The factors 1/(1 + a), by which radial flow scales the deviator of a
    /// trial stress in a step, and 1/(1 + b) for its changes along its
    /// direction.
    struct RadialFactors
    {
      double                a, b;
      SymmetricTensor<2, 3> direction;
    };

    /// Returns nothing for other flow, anisotropic bodies, and without flow.
    std::optional<RadialFactors>
    radial_factors(const ViscoplasticLaw       &law,
                   const SymmetricTensor<2, 3> &stress,
                   const double                 k,
                   const Stiffness             &stiffness,
                   const LawPoint              &point)
    {
      if (!stiffness.is_isotropic())
        return {};
      SymmetricTensor<2, 3> s    = deviator(stress);
      const double          size = s.norm();
      const auto            f = law.radial_flow(std::sqrt(1.5) * size, point);
      if (!f)
        return {};
      const double mu = stiffness.shear_modulus(), a = 3. * mu * k * f->secant,
                   b = 3. * mu * k * f->tangent;
      if (!(a + b > 0.)) // or not a number
        return {};
      if (size > 0.)
        s /= size;
      return RadialFactors{a, b, s};
    }



    /// Return the tangent after radial_return(), and its inverse if asked for:
    /// dev sigma is the deviator of the trial stress over 1 + a, and changes by
    /// 1/(1 + b) along itself. Both are definite, since f is convex. Nothing is
    /// returned where radial_factors() returns nothing.
    std::optional<SymmetricTensor<4, 3>>
    radial_tangent(const ViscoplasticLaw       &law,
                   const SymmetricTensor<2, 3> &stress,
                   const double                 k,
                   const Stiffness             &stiffness,
                   const LawPoint              &point,
                   SymmetricTensor<4, 3>       *compliance = nullptr)
    {
      const auto factors = radial_factors(law, stress, k, stiffness, point);
      if (!factors)
        return {};
      const auto &[a, b, s] = *factors;
      const double mu = stiffness.shear_modulus(), K = stiffness.bulk_modulus();
      if (compliance != nullptr)
        *compliance = transversal_tensor((1. + a) / (2. * mu),
                                         1. / (9. * K),
                                         (b - a) / (2. * mu),
                                         s);
      return transversal_tensor(2. * mu / (1. + a),
                                K,
                                2. * mu * (a - b) / ((1. + a) * (1. + b)),
                                s);
    }
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
    // After @p start, zero stress is tried: it is closer where a law is steep.
    const BackwardEulerEquation equation{
      law, strain, old_z, k, stiffness, point};
    if (const auto z = radial_return(equation, start))
      return *z;
    for (const auto &from : {start, -1. * equation.elastic})
      if (const auto z = equation.solve(from))
        return *z;

    // Continuation from k = 0, where z = z_old, with adaptive steps. Where the
    // law jumps, tiny steps might succeed without end.
    SymmetricTensor<2, 3> z    = old_z;
    double                done = 0., step = 0.25;
    for (unsigned int n = 1; done < 1.; ++n)
      {
        const double next = std::min(1., done + step);
        if (const auto result =
              BackwardEulerEquation{
                law, strain, old_z, next * k, stiffness, point}
                .solve(z))
          {
            z    = *result;
            done = next;
            step *= 2.;
            continue;
          }
        step *= 0.25;
        if (step < 1e-8 || n >= most_steps_in_k)
          refuse("The stress of backward Euler at x = (" + as_text(point.x) +
                 "), t = " + as_text(point.t) +
                 " cannot be found for the time step " + as_text(k) +
                 ": its law of flow may soften or jump there; take shorter "
                 "steps.");
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
    if (const auto radial = radial_tangent(law, stress, k, stiffness, point))
      return *radial;
    const auto tangents =
      law.step_tangents(stress, strain, k, stiffness, point);
    const SymmetricTensor<4, 3> E = stiffness.tensor();
    // Return E exactly, so that the matrix of an elastic body is recognized.
    if (tangents.stress.norm() == 0. && tangents.strain.norm() == 0.)
      return E;
    return invert(identity_tensor<3>() - k * tangents.stress) *
           (E + k * tangents.strain);
  }



  SymmetricTensor<4, 3>
  definite_tangent(const SymmetricTensor<4, 3> &tangent,
                   const Stiffness             &stiffness)
  {
    // Try Cholesky's factorization of the matrix of components, which is
    // definite if the tensor is. Pivots are compared with the diagonal of E.
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



  ErrorRelaxation
  error_relaxation(const ViscoplasticLaw       &law,
                   const SymmetricTensor<2, 3> &stress,
                   const SymmetricTensor<2, 3> &strain,
                   const double                 k,
                   const Stiffness             &stiffness,
                   const LawPoint              &point)
  {
    ErrorRelaxation result;
    if (const auto factors = radial_factors(law, stress, k, stiffness, point))
      {
        const auto &[a, b, s] = *factors;
        result.set_radial(a, b, s);
      }
    else
      result.any = invert(
        identity_tensor<3>() -
        k * law.step_tangents(stress, strain, k, stiffness, point).stress);
    return result;
  }



  SymmetricTensor<4, 3>
  step_tangent(const ViscoplasticLaw       &law,
               const SymmetricTensor<2, 3> &stress,
               const SymmetricTensor<2, 3> &strain,
               const double                 k,
               const Stiffness             &stiffness,
               const LawPoint              &point,
               SymmetricTensor<4, 3>       *compliance)
  {
    if (const auto radial =
          radial_tangent(law, stress, k, stiffness, point, compliance))
      return *radial;
    const SymmetricTensor<4, 3> C = definite_tangent(
      algorithmic_tangent(law, stress, strain, k, stiffness, point), stiffness);
    if (compliance != nullptr)
      *compliance = invert(C);
    return C;
  }
} // namespace Viscoplastic
