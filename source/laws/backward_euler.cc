// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/laws/backward_euler.h>

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    // Of the continuation, with those that fail. A law without jumps would have
    // to ask for steps of a thousandth all the way to need more.
    const unsigned int most_steps_in_k = 1000;
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
    const BackwardEulerEquation equation{
      law, strain, old_z, k, stiffness, point};
    for (const auto &from : {start, -1. * equation.elastic})
      if (const auto z = equation.solve(from))
        return *z;

    // From k = 0, where z = z_old, in steps that adapt. Where the law jumps,
    // tiny ones succeed without end.
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
    // Cholesky's factorization of the matrix of components: its sign is that
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
} // namespace Viscoplastic
