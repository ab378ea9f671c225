// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>

#include <viscoplastic_contact/stiffness.h>

#include <functional>
#include <memory>
#include <string>

namespace Viscoplastic
{
  using namespace dealii;

  /// Where and when a law is evaluated (in 2D, z = 0).
  struct LawPoint
  {
    Point<3> x;
    double   t = 0;
  };

  /**
   * The function G of the constitutive equation (1.1),
   *
   *     sigma' = E eps(u') + G(t, sigma, eps(u)),
   *
   * also the rate of the irreversible stress z = sigma - E eps(u). A law knows
   * no mesh and has no state: all its functions are const and depend on their
   * arguments only, so cells can be visited in any order and by several
   * threads. G must be Lipschitz in stress and strain, (2.8).
   *
   * A new law is one file in source/laws and one line in the list of
   * source/viscoplastic_law.cc.
   */
  class ViscoplasticLaw
  {
  public:
    virtual ~ViscoplasticLaw() = default;

    /// G, stress per time.
    virtual SymmetricTensor<2, 3>
    rate(const SymmetricTensor<2, 3> &stress,
         const SymmetricTensor<2, 3> &strain,
         const Stiffness             &stiffness,
         const LawPoint              &point) const = 0;

    /// The partial derivatives of G.
    struct Tangents
    {
      /// dG/dsigma, 1/time.
      SymmetricTensor<4, 3> stress;
      /// dG/deps, stress/time.
      SymmetricTensor<4, 3> strain;
    };

    /**
     * The derivatives of rate(). Where G has a kink, one of the one-sided
     * derivatives, as a semismooth Newton method needs it.
     */
    virtual Tangents
    tangents(const SymmetricTensor<2, 3> &stress,
             const SymmetricTensor<2, 3> &strain,
             const Stiffness             &stiffness,
             const LawPoint              &point) const = 0;

    /**
     * The rate r, 1/time, at which stress relaxes at fixed strain: at least
     * the largest eigenvalue of -dG/dsigma at this stress. Forward Euler is
     * stable for time steps up to 2/r. A law whose rate may jump to a larger
     * value within one step returns the larger one.
     */
    virtual double
    relaxation_rate(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> &strain,
                    const Stiffness             &stiffness,
                    const LawPoint              &point) const = 0;

    /**
     * Whether the flow preserves volume. Such a flow locks volumetrically on
     * quadrilaterals and hexahedra whatever Poisson's ratio is, so mean
     * dilatation is the default then.
     */
    virtual bool
    deviatoric_flow() const = 0;
  };



  /// What the registry knows of a law.
  struct LawDescription
  {
    /// The value of the entry `Law`, and the name of the law's subsection.
    std::string name;

    /// The manual entry: formula, meaning, units, reference.
    std::string help;

    /// Declares the entries of the law; called inside its subsection.
    std::function<void(ParameterHandler &)> declare;

    /**
     * Reads and checks these entries; called inside the law's subsection.
     */
    std::function<std::unique_ptr<ViscoplasticLaw>(ParameterHandler &)> make;
  };

  /**
   * The allowed values of the entry `Law` as for Patterns::Selection:
   * `elastic` and the registered laws, separated by `|`.
   */
  std::string
  viscoplastic_law_names();

  /// The manual entries of `elastic` and all registered laws, one paragraph
  /// each.
  std::string
  viscoplastic_law_help();

  /// Declares one subsection per law inside the current subsection.
  void
  declare_viscoplastic_law_parameters(ParameterHandler &prm);

  /**
   * The law of this name, with the parameters of its subsection of the
   * current subsection. Null for `elastic`: a body without viscosity has no
   * law object and no irreversible stress. Throws ExcMessage for an unknown
   * name and for parameters outside their range.
   */
  std::unique_ptr<ViscoplasticLaw>
  make_viscoplastic_law(const std::string &name, ParameterHandler &prm);

  /**
   * The value of a number in the current subsection, which must be finite and
   * positive. Throws ExcMessage naming law, entry, value and range.
   */
  double
  get_positive(const ParameterHandler &prm,
               const std::string      &law,
               const std::string      &entry);

  /// As get_positive(), but zero is allowed, too.
  double
  get_non_negative(const ParameterHandler &prm,
                   const std::string      &law,
                   const std::string      &entry);
} // namespace Viscoplastic
