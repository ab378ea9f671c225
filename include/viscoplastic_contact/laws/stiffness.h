// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/exceptions.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/lac/full_matrix.h>

#include <array>
#include <cmath>
#include <memory>

namespace Viscoplastic
{
  using namespace dealii;

  /// Eigenvalues in ascending order, and the eigentensors, orthonormal in the
  /// scalar product a : b.
  struct Spectrum
  {
    std::array<double, 6>                values;
    std::array<SymmetricTensor<2, 3>, 6> modes;
  };

  /// The spectrum of a tensor T with a : T : b = b : T : a.
  Spectrum
  spectrum(const SymmetricTensor<4, 3> &tensor);



  /// The elastic tensor E of one cell, stress = E strain.
  ///
  /// Stress and strain are always symmetric tensors of three dimensions. A
  /// plane-strain computation passes eps_zz = eps_xz = eps_yz = 0 and keeps
  /// sigma_zz, so everything that works on stresses is written once.
  ///
  /// An isotropic tensor is stored as two moduli; copies of an anisotropic one
  /// share its data. Functions called for each cell in each step are inline.
  class Stiffness
  {
  public:
    /// E eps = 2 mu dev eps + K tr(eps) I.
    Stiffness(const double shear_modulus, const double bulk_modulus);

    /// The same by other moduli. Young's modulus (unit of stress)
    /// must be positive and finite, Poisson's ratio inside (-1, 1/2): this is
    /// what makes E elliptic. Throws the exceptions below otherwise.
    static Stiffness
    isotropic(const double youngs_modulus, const double poissons_ratio);

    /// A general elastic tensor: the 6 x 6 matrix in Voigt's order xx, yy, zz,
    /// yz, xz, xy with engineering shear strains. Throws ExcMessage unless it
    /// is symmetric and positive definite, naming the smallest eigenvalue. This
    /// is the eigenvalue of E as a map of symmetric tensors, which a rotation
    /// of the axes does not change, not that of the matrix.
    static Stiffness
    anisotropic(const FullMatrix<double> &voigt_matrix);

    bool
    is_isotropic() const;

    /// E strain.
    SymmetricTensor<2, 3>
    stress(const SymmetricTensor<2, 3> &strain) const;

    /// E T, the derivatives of the stress of strains with the derivatives T.
    SymmetricTensor<4, 3>
    stress(const SymmetricTensor<4, 3> &strain) const;

    /// E^-1 stress.
    SymmetricTensor<2, 3>
    strain(const SymmetricTensor<2, 3> &stress) const;

    /// E^-1 stress : stress.
    double
    complementary_square(const SymmetricTensor<2, 3> &stress) const;

    /// Return the sum of weights[i] (E^-1 stress[i] : stress[i]) over @p n
    /// points.
    double
    complementary_square(const unsigned int           n,
                         const double                *weights,
                         const SymmetricTensor<2, 3> *stress) const;

    /// The shear modulus mu, in the unit of stress; Voigt's average if
    /// anisotropic.
    double
    shear_modulus() const;

    /// The bulk modulus K = lambda + 2 mu/3, or Voigt's average.
    double
    bulk_modulus() const;

    /// The largest eigenvalue of P E P, where P takes the deviator; 2 mu if
    /// isotropic. It relates the viscosity of deviatoric flow to its relaxation
    /// rate.
    double
    largest_deviatoric_eigenvalue() const;

    /// 1 over the largest eigenvalue of P E^-1 P; 2 mu if isotropic. It bounds
    /// energies below: strain : E strain >= this |dev strain|^2, whatever the
    /// volumetric strain is.
    double
    smallest_deviatoric_eigenvalue() const;

    /// Poisson's ratio (3 K - 2 mu)/(6 K + 2 mu).
    double
    poissons_ratio() const;

    /// E itself, for linearizations; stress() is the cheaper way to apply it.
    SymmetricTensor<4, 3>
    tensor() const;

    DeclException1(ExcYoungsModulus,
                   double,
                   << "Young's modulus is " << arg1
                   << "; it must be positive and finite.");
    DeclException1(ExcPoissonsRatio,
                   double,
                   << "Poisson's ratio is " << arg1
                   << "; it must be larger than -1 and smaller than 0.5.");

  private:
    struct Anisotropic
    {
      SymmetricTensor<4, 3> stiffness, compliance;
      double                largest_deviatoric, smallest_deviatoric;
    };

    // Not inline, so that the isotropic case is short enough for inlining.
    SymmetricTensor<2, 3>
    anisotropic_stress(const SymmetricTensor<2, 3> &strain) const;
    SymmetricTensor<2, 3>
    anisotropic_strain(const SymmetricTensor<2, 3> &stress) const;
    double
    anisotropic_square(const unsigned int           n,
                       const double                *weights,
                       const SymmetricTensor<2, 3> *stress) const;

    double                             mu;
    double                             bulk;
    std::shared_ptr<const Anisotropic> anisotropic_data;
  };



  /// The von Mises stress sqrt(3/2) |dev stress|; it is the axial stress under
  /// uniaxial tension.
  inline double
  von_mises(const SymmetricTensor<2, 3> &stress)
  {
    return std::sqrt(1.5) * deviator(stress).norm();
  }



  inline Stiffness::Stiffness(const double shear_modulus,
                              const double bulk_modulus)
    : mu(shear_modulus)
    , bulk(bulk_modulus)
  {}



  inline Stiffness
  Stiffness::isotropic(const double youngs_modulus, const double poissons_ratio)
  {
    // Written so that NaN is refused, too.
    AssertThrow(youngs_modulus > 0 && std::isfinite(youngs_modulus),
                ExcYoungsModulus(youngs_modulus));
    AssertThrow(poissons_ratio > -1 && poissons_ratio < 0.5,
                ExcPoissonsRatio(poissons_ratio));

    return Stiffness(youngs_modulus / (2 * (1 + poissons_ratio)),
                     youngs_modulus / (3 * (1 - 2 * poissons_ratio)));
  }



  inline bool
  Stiffness::is_isotropic() const
  {
    return anisotropic_data == nullptr;
  }



  DEAL_II_ALWAYS_INLINE inline SymmetricTensor<2, 3>
  Stiffness::stress(const SymmetricTensor<2, 3> &strain) const
  {
    if (anisotropic_data)
      return anisotropic_stress(strain);

    SymmetricTensor<2, 3> result   = 2 * mu * strain;
    const double          pressure = (bulk - 2. / 3. * mu) * trace(strain);
    for (unsigned int i = 0; i < 3; ++i)
      result[i][i] += pressure;
    return result;
  }



  DEAL_II_ALWAYS_INLINE inline SymmetricTensor<2, 3>
  Stiffness::strain(const SymmetricTensor<2, 3> &stress) const
  {
    if (anisotropic_data)
      return anisotropic_strain(stress);

    // The deviator is formed first: with 1/(9K) - 1/(6 mu) in one factor, the
    // small strain of a nearly incompressible body under high pressure would
    // be the difference of large numbers.
    SymmetricTensor<2, 3> result      = deviator(stress) / (2 * mu);
    const double          dilatation3 = trace(stress) / (9 * bulk);
    for (unsigned int i = 0; i < 3; ++i)
      result[i][i] += dilatation3;
    return result;
  }



  DEAL_II_ALWAYS_INLINE inline double
  Stiffness::complementary_square(const SymmetricTensor<2, 3> &stress) const
  {
    if (anisotropic_data)
      return anisotropic_strain(stress) * stress;
    const double pressure = trace(stress) * trace(stress) / 9.; // squared
    return (stress * stress - 3. * pressure) / (2. * mu) + pressure / bulk;
  }



  DEAL_II_ALWAYS_INLINE inline double
  Stiffness::complementary_square(const unsigned int           n,
                                  const double                *weights,
                                  const SymmetricTensor<2, 3> *stress) const
  {
    if (anisotropic_data)
      return anisotropic_square(n, weights, stress);
    double squares = 0., pressures = 0.;
    for (unsigned int i = 0; i < n; ++i)
      {
        // By components, of which the compiler makes half as many instructions
        // as of the operators.
        const double *x       = stress[i].begin_raw();
        const double  shear   = x[3] * x[3] + x[4] * x[4] + x[5] * x[5],
                     pressure = x[0] + x[1] + x[2];
        squares +=
          weights[i] * (2. * shear + x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        pressures += weights[i] * (pressure * pressure);
      }
    return (squares - pressures / 3.) / (2. * mu) + pressures / (9. * bulk);
  }



  inline double
  Stiffness::shear_modulus() const
  {
    return mu;
  }



  inline double
  Stiffness::bulk_modulus() const
  {
    return bulk;
  }



  inline double
  Stiffness::largest_deviatoric_eigenvalue() const
  {
    return anisotropic_data ? anisotropic_data->largest_deviatoric : 2 * mu;
  }



  inline double
  Stiffness::smallest_deviatoric_eigenvalue() const
  {
    return anisotropic_data ? anisotropic_data->smallest_deviatoric : 2 * mu;
  }



  inline double
  Stiffness::poissons_ratio() const
  {
    return (3 * bulk - 2 * mu) / (6 * bulk + 2 * mu);
  }
} // namespace Viscoplastic
