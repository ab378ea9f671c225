// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tensors.h"
#include <viscoplastic_contact/laws/backward_euler.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace Viscoplastic::Testing
{
  using namespace dealii;

  // mu = 0.4, K = 2/3.
  constexpr double       mu        = 0.4;
  inline const Stiffness isotropic = Stiffness::isotropic(1., 0.25);
  inline const double from_tensor  = std::sqrt(2. / 3.); // |dev| over von Mises



  /// An elastic tensor with soft shears in one plane.
  inline Stiffness
  anisotropic()
  {
    FullMatrix<double> C(6, 6);
    for (unsigned int i = 0; i < 3; ++i)
      {
        for (unsigned int j = 0; j < 3; ++j)
          C(i, j) = i == j ? 1.2 + 0.3 * i : 0.4;
        C(i + 3, i + 3) = 0.2 + 0.1 * i;
      }
    C(0, 5) = C(5, 0) = 0.15;
    return Stiffness::anisotropic(C);
  }



  /// A law in a body.
  struct Sample
  {
    Sample(const std::string &name,
           const std::string &entries,
           const Stiffness   &stiffness = isotropic)
      : name(name + ", " + entries)
      , stiffness(stiffness)
    {
      ParameterHandler prm;
      declare_viscoplastic_law_parameters(prm);
      prm.parse_input_from_string("subsection " + name + "\n" + entries +
                                  "\nend\n");
      law   = make_viscoplastic_law(name, prm);
      point = law->point(Point<3>(), 0.);
    }

    Tensor2
    z(const Tensor2 &strain, const Tensor2 &old_z, const double k) const
    {
      return implicit_irreversible_stress(
        *law, strain, old_z, k, stiffness, point, old_z);
    }

    Tensor2
    stress(const Tensor2 &strain, const Tensor2 &old_z, const double k) const
    {
      return stiffness.stress(strain) + z(strain, old_z, k);
    }

    /// kr divided by r at this stress, but by 0.1 at least.
    double
    step_size(const double   kr,
              const Tensor2 &stress,
              const Tensor2 &strain) const
    {
      return kr /
             std::max(0.1,
                      law->relaxation_rate(stress, strain, stiffness, point));
    }

    Tensor4
    tangent(const Tensor2 &stress, const Tensor2 &strain, const double k) const
    {
      return algorithmic_tangent(*law, stress, strain, k, stiffness, point);
    }

    std::string                      name;
    Stiffness                        stiffness;
    std::unique_ptr<ViscoplasticLaw> law;
    LawPoint                         point;
  };

  /// The history at the old time, for laws with history variables.
  inline const Tensor2 former_history =
    symmetric(0.3, -0.2, -0.1, 0.15, -0.25, 0.05);

  /// The products k r in tests.
  inline const std::array<double, 6> products = {
    {0.01, 0.1, 1., 10., 100., 1000.}};



  inline std::vector<Sample>
  all_samples()
  {
    std::vector<Sample> samples;
    for (const Stiffness &E : {isotropic, anisotropic()})
      {
        const auto add = [&](const char *name, const char *entries) {
          samples.emplace_back(name, entries, E);
          samples.back().point.history = &former_history;
        };
        add("maxwell", "set Viscosity = 0.5");
        add("zener",
            "set Long-term Young's modulus = 0.3\nset Long-term Poisson's "
            "ratio = 0.1\nset Relaxation time = 0.7");
        add("perzyna", "set Yield radius = 0.3\nset Viscosity = 2");
        add("norton",
            "set Rate factor = 1\nset Exponent = 3\nset Stress cap = 0.8");
        add("norton",
            "set Rate factor = 1\nset Exponent = 10\nset Stress cap = 1.5");
        add("perzyna",
            "set Yield radius = 0.2\nset Viscosity = 2\nset Hardening "
            "modulus = 0.3");
        add("perzyna",
            "set Yield radius = 0.2\nset Viscosity = 2\nset Hardening "
            "modulus = 10");
        add("burgers",
            "set Maxwell viscosity = 3\nset Kelvin modulus = 0.4\nset Kelvin "
            "viscosity = 0.7");
        add("lubby2",
            "set Maxwell viscosity = 3\nset Maxwell viscosity exponent = "
            "-0.5\nset Kelvin modulus = 0.4\nset Kelvin modulus exponent = "
            "-0.9\nset Kelvin viscosity = 0.7\nset Kelvin viscosity exponent "
            "= -0.6\nset Stress cap = 3");
        add("parsed",
            "set Strain rate = max(0, sigma_eq - max(0, 0.2 + 0.5*p))");
        add("parsed",
            "set Strain rate = sigma_eq*exp(-eps_eq)*(1 + tanh(2*p))");
      }
    return samples;
  }
} // namespace Viscoplastic::Testing
