// SPDX-License-Identifier: LGPL-2.1-or-later

// The tangent of backward Euler at one sample against differences of the
// stress.

#include "law_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  /// The largest entry of C - C^T as a 6 x 6 matrix, relative to |C|.
  double
  asymmetry(const Tensor4 &C)
  {
    double sum = 0.;
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < i; ++j)
        sum = std::max(sum,
                       std::fabs(C.access_raw_entry(6 * i + j) -
                                 C.access_raw_entry(6 * j + i)));
    return sum / C.norm();
  }



  TEST(BackwardEuler, TangentHasItsInverse)
  {
    for (const Stiffness &E : {isotropic, anisotropic()})
      for (const auto &[law, entries] :
           {std::make_pair("norton",
                           "set Rate factor = 0.5\nset Exponent = 4\nset "
                           "Stress cap = 3"),
            std::make_pair("maxwell", "set Viscosity = 0.7"),
            std::make_pair("perzyna", "set Yield radius = 0.2")})
        for (const double k : {0., 1e-3, 1., 1e3})
          {
            const Sample  sample(law, entries, E);
            const Tensor2 strain = symmetric(0.7, -0.2, 0.1, 0.3, -0.4, 0.2),
                          stress = E.stress(strain);
            Tensor4       compliance;
            const Tensor4 tangent = step_tangent(
              *sample.law, stress, strain, k, E, sample.point, &compliance);
            const auto tangents =
              sample.law->tangents(stress, strain, E, sample.point);
            const Tensor4 relaxation =
              invert(identity_tensor<3>() - k * tangents.stress);
            for (const Tensor2 &error : {strain, stress / stress.norm()})
              EXPECT_LT((error_relaxation(
                           *sample.law, stress, strain, k, E, sample.point) *
                           error -
                         relaxation * error)
                          .norm(),
                        1e-12)
                << law << k;
            const Tensor4 C = relaxation * E.tensor();
            EXPECT_LT((tangent - C).norm(), 1e-12 * C.norm()) << law << k;
            EXPECT_LT((tangent * compliance - identity_tensor<3>()).norm(),
                      1e-9)
              << law << k;
          }
  }



  TEST(BackwardEuler, TangentsAgainstDifferences)
  {
    RandomTensors random;
    for (const Sample &sample : all_samples())
      {
        double largest = 0.;
        for (const double kr : products)
          for (unsigned int i = 0; i < 5; ++i)
            {
              const Tensor2 strain = random(),
                            old_z  = 0.05 * deviator(random());
              const Tensor2 trial  = sample.stiffness.stress(strain) + old_z;
              const double  k      = sample.step_size(kr, trial, strain);
              const Tensor4 C =
                sample.tangent(sample.stress(strain, old_z, k), strain, k);
              largest         = std::max(largest, asymmetry(C));
              const double  h = 1e-5;
              const Tensor2 d = random();
              const Tensor2 difference =
                (sample.stress(strain + h * d, old_z, k) -
                 sample.stress(strain - h * d, old_z, k)) /
                (2. * h);
              EXPECT_LE((C * d - difference).norm(),
                        2e-5 * (sample.stiffness.stress(d)).norm())
                << sample.name << ", k r = " << kr;
            }
        if (sample.law->has_symmetric_tangents())
          EXPECT_LE(largest, 1e-10) << sample.name;
        else
          EXPECT_GE(largest, 1e-3) << sample.name;
      }
  }



  // The interface's general methods for history variables, against closed forms
  // of laws.
  TEST(BackwardEuler, HistoryByNewtonsMethodAndDifferences)
  {
    RandomTensors random;
    unsigned int  n_laws = 0;
    for (const Sample &sample : all_samples())
      if (const ViscoplasticLaw &law = *sample.law; law.n_history_variables > 0)
        for (const double kr : products)
          {
            ++n_laws;
            SCOPED_TRACE(sample.name);
            const Stiffness &E      = sample.stiffness;
            const LawPoint  &point  = sample.point;
            const Tensor2    strain = random(), stress = random();
            const double     k = sample.step_size(kr, stress, strain);
            const Tensor2    history =
              law.history_after_step(stress, strain, k, E, point);
            LawPoint after = point;
            after.history  = &history;
            EXPECT_LE((history - former_history -
                       k * law.history_rate(stress, strain, E, after))
                        .norm(),
                      1e-13 * (1. + kr));
            EXPECT_LE((law.ViscoplasticLaw::history_after_step(
                         stress, strain, k, E, point) -
                       history)
                        .norm(),
                      1e-12);
            const auto exact = law.step_tangents(stress, strain, k, E, point),
                       differences = law.ViscoplasticLaw::step_tangents(
                         stress, strain, k, E, point);
            EXPECT_LE((differences.stress - exact.stress).norm(),
                      1e-7 * exact.stress.norm());
            EXPECT_LE(differences.strain.norm(), 1e-7 * exact.stress.norm());
          }
    EXPECT_EQ(n_laws, 4 * products.size());
  }



  TEST(BackwardEuler, TangentAtTheYieldStress)
  {
    const Sample sample("perzyna", "set Yield radius = 0.5\nset Viscosity = 2");
    RandomTensors random;
    for (const double kr : products)
      {
        const double  k         = kr * 2. / (2. * mu);
        const Tensor2 direction = deviator(random());
        const Tensor2 at_yield = 0.5 / (2. * mu) / direction.norm() * direction;
        const auto    stress   = [&](const double size) {
          return sample.stress(size * at_yield, {}, k);
        };
        const Tensor4 inside =
          sample.tangent(stress(1. - 1e-9), (1. - 1e-9) * at_yield, k);
        const Tensor4 outside =
          sample.tangent(stress(1. + 1e-9), (1. + 1e-9) * at_yield, k);
        EXPECT_EQ(inside, isotropic.tensor());
        EXPECT_LE(
          (outside * direction - 2. * mu / (1. + kr) * direction).norm(), 1e-7);
        // On the yield surface the tangent is one of the two.
        const Tensor4 on =
          sample.tangent(0.5 / direction.norm() * direction, at_yield, k);
        EXPECT_LE(std::min((on - inside).norm(), (on - outside).norm()), 1e-7);
      }
  }



  TEST(BackwardEuler, DefiniteTangents)
  {
    RandomTensors random;
    unsigned int  n_changed = 0;
    for (const Sample &sample : all_samples())
      for (const double kr : products)
        {
          const Tensor2 strain = random(), old_z = 0.05 * deviator(random());
          const Tensor2 trial = sample.stiffness.stress(strain) + old_z;
          const double  k     = sample.step_size(kr, trial, strain);
          const Tensor4 C =
            sample.tangent(sample.stress(strain, old_z, k), strain, k);
          const Tensor4 definite = definite_tangent(C, sample.stiffness);
          EXPECT_LE(asymmetry(definite), 1e-14) << sample.name;
          EXPECT_GT(spectrum(definite).values[0], 0.) << sample.name;
          // It is the symmetric part of C if that is positive definite.
          Tensor4 symmetric_part;
          for (unsigned int i = 0; i < 6; ++i)
            for (unsigned int j = 0; j < 6; ++j)
              symmetric_part.access_raw_entry(6 * i + j) =
                0.5 *
                (C.access_raw_entry(6 * i + j) + C.access_raw_entry(6 * j + i));
          if (spectrum(symmetric_part).values[0] > 1e-6)
            EXPECT_LE((definite - symmetric_part).norm(), 1e-14) << sample.name;
          else
            ++n_changed;
        }
    EXPECT_GT(n_changed, 0u); // both cases occur
  }
} // namespace
