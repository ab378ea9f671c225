// SPDX-License-Identifier: LGPL-2.1-or-later

// The stress of backward Euler at one sample against closed forms and
// bisection.

#include "law_samples.h"
#include "refusals.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  /// Return the zero of an increasing function between 0 and @p right.
  double
  bisect(const std::function<double(double)> &f, double right)
  {
    double left = 0.;
    for (unsigned int i = 0; i < 200; ++i)
      {
        const double middle             = 0.5 * (left + right);
        (f(middle) < 0. ? left : right) = middle;
      }
    return left;
  }



  /// The stress with the deviator of the trial stress shortened.
  void
  expect_shortened(const Sample  &sample,
                   const Tensor2 &strain,
                   const Tensor2 &old_z,
                   const double   k,
                   const double   length)
  {
    const Tensor2 trial    = isotropic.stress(strain) + old_z;
    const Tensor2 expected = trace(trial) / 3. * unit_symmetric_tensor<3>() +
                             length / deviator(trial).norm() * deviator(trial);
    EXPECT_LE((sample.stress(strain, old_z, k) - expected).norm(),
              1e-10 * trial.norm())
      << sample.name << ", k = " << k;
  }



  TEST(BackwardEuler, MaxwellAndZenerByHand)
  {
    const Sample  maxwell("maxwell", "set Viscosity = 0.5");
    const Sample  zener("zener",
                       "set Long-term Young's modulus = 0.5\nset Long-term "
                        "Poisson's ratio = 0.1\nset Relaxation time = 0.7");
    const auto    soft = Stiffness::isotropic(0.5, 0.1);
    RandomTensors random;
    for (const double kr : products)
      {
        const Tensor2 strain = random(), old_z = random();
        const Tensor2 trial = isotropic.stress(strain) + old_z;
        const double  r     = mu / 0.5;
        expect_shortened(
          maxwell, strain, old_z, kr / r, deviator(trial).norm() / (1. + kr));
        EXPECT_LE((zener.stress(strain, old_z, 0.7 * kr) -
                   (trial + kr * soft.stress(strain)) / (1. + kr))
                    .norm(),
                  1e-12);
      }
  }



  TEST(BackwardEuler, PerzynaByHand)
  {
    const Sample sample("perzyna", "set Yield radius = 0.5\nset Viscosity = 2");
    RandomTensors random;
    for (const double kr : products)
      for (const double size : {0.1, 0.9999999, 1.0000001, 1.1, 30.})
        {
          // |dev of the trial stress| = size times the yield radius.
          const Tensor2 strain = random();
          Tensor2       old_z  = random();
          const Tensor2 trial  = isotropic.stress(strain) + old_z;
          const double  length = 0.5 * size;
          old_z += (length / deviator(trial).norm() - 1.) * deviator(trial);
          const double k = kr * 2. / (2. * mu);
          expect_shortened(sample,
                           strain,
                           old_z,
                           k,
                           size < 1. ? length :
                                       (length + kr * 0.5) / (1. + kr));
          if (size < 1.)
            {
              EXPECT_EQ(sample.z(strain, old_z, k), old_z);
            }
        }
  }



  TEST(BackwardEuler, BesideTheYieldSurfaceFromInside)
  {
    // Strains are large, the trial stress is beyond the yield surface by 1e-10
    // of them, and Newton's method begins inside, from where its step leads to
    // the trial stress.
    const Sample sample("perzyna", "set Yield radius = 0.5\nset Viscosity = 2");
    RandomTensors random;
    const double  kr = 100., k = kr * 2. / (2. * mu);
    for (unsigned int i = 0; i < 20; ++i)
      {
        const Tensor2 strain = 100. * random();
        Tensor2       old_z  = random() - isotropic.stress(strain);
        const Tensor2 trial  = isotropic.stress(strain) + old_z;
        const Tensor2 normal = deviator(trial) / deviator(trial).norm();
        const double  excess = 5e-8;
        old_z += (0.5 + excess) * normal - deviator(trial);
        const Tensor2 start = old_z - 1.01 * excess * normal;
        const Tensor2 z     = implicit_irreversible_stress(
          *sample.law, strain, old_z, k, isotropic, sample.point, start);
        const Tensor2 stress = isotropic.stress(strain) + z;
        // Strains of size 100 have rounding errors of 1e-14.
        EXPECT_NEAR(deviator(stress).norm() - 0.5,
                    excess / (1. + kr),
                    0.01 * excess);
      }
  }



  TEST(BackwardEuler, HardeningByHand)
  {
    // Strains and stresses are multiples of one deviator.
    RandomTensors random;
    for (const double H : {0.08, 0.8, 8.})
      {
        const Sample sample("perzyna",
                            "set Yield radius = 0.1\nset Viscosity = "
                            "2\nset Hardening modulus = " +
                              std::to_string(H));
        const double h = H * from_tensor / (2. * mu);
        for (const double kr : products)
          {
            const Tensor2 strain  = random();
            const Tensor2 elastic = 2. * mu * deviator(strain);
            const Tensor2 old_z   = -0.05 * elastic;
            const double  a = kr / (1. + h), k = a * 2. / (2. * mu);
            expect_shortened(sample,
                             strain,
                             old_z,
                             k,
                             (0.95 * elastic.norm() +
                              a * (0.1 + h * elastic.norm())) /
                               (1. + a + a * h));
          }
      }
  }



  TEST(BackwardEuler, NortonAndParsedByBisection)
  {
    struct Case
    {
      Sample                                sample;
      std::function<double(double, double)> f; // of von Mises stress and p
    };
    const auto power = [](const double n, const double cap) {
      return [=](const double q, const double) {
        return q <= cap ? std::pow(q, n) :
                          std::pow(cap, n) * (1. + n * (q / cap - 1.));
      };
    };
    std::vector<Case> cases;
    cases.push_back(
      {{"norton",
        "set Rate factor = 1\nset Exponent = 3\nset Stress cap = 0.8"},
       power(3., 0.8)});
    cases.push_back(
      {{"norton",
        "set Rate factor = 1\nset Exponent = 10\nset Stress cap = 100"},
       power(10., 100.)});
    cases.push_back(
      {{"parsed", "set Strain rate = max(0, sigma_eq - max(0, 0.2 + 0.5*p))"},
       [](const double q, const double p) {
         return std::max(0., q - std::max(0., 0.2 + 0.5 * p));
       }});
    cases.push_back({{"parsed", "set Strain rate = sigma_eq^2*exp(-2*p)"},
                     [](const double q, const double p) {
                       return q * q * std::exp(-2. * p);
                     }});

    RandomTensors random;
    for (const Case &c : cases)
      for (const double kr : products)
        for (unsigned int i = 0; i < 5; ++i)
          {
            const Tensor2 strain = random(), old_z = 0.5 * deviator(random());
            const Tensor2 trial = isotropic.stress(strain) + old_z;
            const double  p     = -trace(trial) / 3.;
            const double  q     = von_mises(trial);
            // Scale k by about the relaxation rate at the trial stress.
            const double k = kr * q / (3. * mu * std::max(c.f(q, p), 1e-3));
            expect_shortened(c.sample,
                             strain,
                             old_z,
                             k,
                             from_tensor *
                               bisect(
                                 [&](const double x) {
                                   return x + 3. * mu * k * c.f(x, p) - q;
                                 },
                                 q));
          }
  }



  TEST(BackwardEuler, StressesSolveTheirEquation)
  {
    RandomTensors random;
    for (const Sample &sample : all_samples())
      for (const double kr : products)
        for (unsigned int i = 0; i < 5; ++i)
          {
            const Tensor2 strain = random(), old_z = 0.05 * deviator(random());
            const Tensor2 trial = sample.stiffness.stress(strain) + old_z;
            const double  k     = sample.step_size(kr, trial, strain);
            const Tensor2 z     = sample.z(strain, old_z, k);
            const Tensor2 G =
              sample.law->step_rate(sample.stiffness.stress(strain) + z,
                                    strain,
                                    k,
                                    sample.stiffness,
                                    sample.point);
            // Up to an error of z of 1e-12, which r multiplies.
            EXPECT_LE((z - old_z - k * G).norm(), 1e-10 * (1. + kr))
              << sample.name << ", k r = " << kr;
          }
  }



  /// A law that counts how often it is asked for its rate.
  struct Counting : public ViscoplasticLaw
  {
    explicit Counting(const ViscoplasticLaw &law)
      : ViscoplasticLaw({})
      , law(law)
    {}

    Tensor2
    rate(const Tensor2   &stress,
         const Tensor2   &strain,
         const Stiffness &stiffness,
         const LawPoint  &point) const override
    {
      ++n_calls;
      return law.rate(stress, strain, stiffness, point);
    }

    Tangents
    tangents(const Tensor2   &stress,
             const Tensor2   &strain,
             const Stiffness &stiffness,
             const LawPoint  &point) const override
    {
      return law.tangents(stress, strain, stiffness, point);
    }

    double
    relaxation_rate(const Tensor2   &stress,
                    const Tensor2   &strain,
                    const Stiffness &stiffness,
                    const LawPoint  &point) const override
    {
      return law.relaxation_rate(stress, strain, stiffness, point);
    }

    bool
    deviatoric_flow() const override
    {
      return true;
    }

    const ViscoplasticLaw &law;
    mutable unsigned int   n_calls = 0;
  };



  TEST(BackwardEuler, JumpsEndInTime)
  {
    // The flow rate jumps at the stress 1, where no solution may exist.
    const Sample   sample("parsed", "set Strain rate = if(sigma_eq > 1, 1, 0)");
    const Counting law(*sample.law);
    const double   k = 1e-3 / (3. * mu);
    for (const unsigned int i : {1, 61})
      {
        Tensor2 strain, z;
        strain[0][1] = (1. + 1e-5 * i) / (2. * mu * std::sqrt(3.));
        law.n_calls  = 0;
        try
          {
            implicit_irreversible_stress(
              law, strain, z, k, sample.stiffness, sample.point, z);
          }
        catch (const ExceptionBase &)
          {} // no solution exists
        EXPECT_LT(law.n_calls, 200000u) << i;
      }
  }



  TEST(BackwardEuler, SaysWhereThereIsNoStress)
  {
    // A constant flow rate has no solution for trial stresses below 3 mu k.
    const Sample  sample("parsed", "set Strain rate = 1");
    const Tensor2 none;
    Tensor2       strain;
    strain[0][1] = 0.1;
    EXPECT_NE(message_of([&] { sample.z(strain, none, 1.); })
                .find("The stress of backward Euler at x = (0 0 0), t = 0 "
                      "cannot be found for the time step 1: its law of flow "
                      "may soften or jump there; take shorter steps."),
              std::string::npos)
      << message_of([&] { sample.z(strain, none, 1.); });
    // Above 3 mu k there is a solution.
    expect_shortened(sample,
                     strain,
                     none,
                     0.1,
                     deviator(isotropic.stress(strain)).norm() -
                       from_tensor * 3. * mu * 0.1);
  }
} // namespace
