// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Laws made from texts, and bodies that have them.

#include <deal.II/base/parameter_handler.h>

#include "tensors.h"
#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <iomanip>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

namespace Viscoplastic
{
  // The worked example of doc/adding_a_law.md; not in the registry.
  LawDescription
  garofalo_description();
} // namespace Viscoplastic

namespace Viscoplastic::Testing
{
  using namespace dealii;

  inline std::unique_ptr<ViscoplasticLaw>
  make_law(const std::string &name,
           const std::string &entries = "",
           const unsigned int dim     = 3)
  {
    ParameterHandler prm;
    declare_viscoplastic_law_parameters(prm);
    prm.parse_input_from_string("subsection " + name + "\n" + entries +
                                "\nend\n");
    return make_viscoplastic_law(name, prm, "Material", dim);
  }

  inline std::string
  exact(const double value)
  {
    std::ostringstream out;
    out << std::setprecision(17) << value;
    return out.str();
  }



  /// A law in a body, at one point and time.
  struct FlowingBody
  {
    FlowingBody(std::unique_ptr<ViscoplasticLaw> law_,
                const Stiffness                 &stiffness = Testing::stiffness,
                const Point<3>                  &x         = Point<3>(),
                const double                     t         = 0)
      : law(std::move(law_))
      , stiffness(stiffness)
      , point(law->point(x, t, /* temperature = */ 2.))
    {
      law->check(stiffness, point);
    }

    Tensor2
    rate(const Tensor2 &stress, const Tensor2 &strain = {}) const
    {
      return law->rate(stress, strain, stiffness, point);
    }

    ViscoplasticLaw::Tangents
    tangents(const Tensor2 &stress, const Tensor2 &strain = {}) const
    {
      return law->tangents(stress, strain, stiffness, point);
    }

    double
    relaxation_rate(const Tensor2 &stress = {},
                    const Tensor2 &strain = {}) const
    {
      return law->relaxation_rate(stress, strain, stiffness, point);
    }

    double
    dissipation(const Tensor2 &stress, const Tensor2 &strain) const
    {
      return -rate(stress, strain) *
             law->driving_strain(stress, strain, stiffness, point);
    }

    double
    stored_energy(const Tensor2 &stress, const Tensor2 &strain) const
    {
      return law->stored_energy(stress, strain, stiffness, point);
    }

    std::unique_ptr<ViscoplasticLaw> law;
    Stiffness                        stiffness;
    LawPoint                         point;
  };

  inline std::unique_ptr<ViscoplasticLaw>
  maxwell(const double viscosity)
  {
    return make_law("maxwell", "set Viscosity = " + exact(viscosity));
  }

  inline std::unique_ptr<ViscoplasticLaw>
  perzyna(const double yield_radius,
          const double viscosity,
          const double hardening = 0)
  {
    return make_law("perzyna",
                    "set Yield radius = " + exact(yield_radius) +
                      "\nset Hardening modulus = " + exact(hardening) +
                      "\nset Viscosity = " + exact(viscosity));
  }

  inline std::unique_ptr<ViscoplasticLaw>
  zener(const double youngs_modulus,
        const double poissons_ratio,
        const double relaxation_time)
  {
    return make_law("zener",
                    "set Long-term Young's modulus = " + exact(youngs_modulus) +
                      "\nset Long-term Poisson's ratio = " +
                      exact(poissons_ratio) +
                      "\nset Relaxation time = " + exact(relaxation_time));
  }

  inline std::unique_ptr<ViscoplasticLaw>
  norton(const double rate_factor, const double exponent, const double cap)
  {
    return make_law("norton",
                    "set Rate factor = " + exact(rate_factor) +
                      "\nset Exponent = " + exact(exponent) +
                      "\nset Stress cap = " + exact(cap));
  }

  inline std::unique_ptr<ViscoplasticLaw>
  parsed(const std::string &strain_rate, const std::string &factor = "1")
  {
    return make_law("parsed",
                    "set Strain rate = " + strain_rate +
                      "\nset Factor = " + factor);
  }



  inline std::unique_ptr<ViscoplasticLaw>
  garofalo(const double rate_factor,
           const double stress_scale,
           const double cap)
  {
    const LawDescription law = garofalo_description();
    ParameterHandler     prm;
    law.declare(prm);
    prm.set("Rate factor", exact(rate_factor));
    prm.set("Stress scale", exact(stress_scale));
    prm.set("Stress cap", exact(cap));
    return law.make({prm, "Material/garofalo", 3});
  }



  /// The defect of d/dt (stored energy) + dissipation = sigma : eps' for sigma'
  /// = E eps' + G.
  inline double
  energy_balance_defect(const FlowingBody &body,
                        const Tensor2     &stress,
                        const Tensor2     &strain,
                        const Tensor2     &strain_rate)
  {
    const Tensor2 stress_rate =
      body.stiffness.stress(strain_rate) + body.rate(stress, strain);
    // The energy is quadratic, so that a large step is exact.
    const double h     = 1.;
    const auto   after = [&](const double time) {
      return body.stored_energy(stress + time * stress_rate,
                                strain + time * strain_rate);
    };
    return (after(h) - after(-h)) / (2 * h) + body.dissipation(stress, strain) -
           stress * strain_rate;
  }
} // namespace Viscoplastic::Testing
