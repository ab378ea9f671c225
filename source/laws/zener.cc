// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/laws/pointwise_law.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace Viscoplastic
{
  LawDescription
  zener_description();

  namespace
  {
    enum Parameter
    {
      youngs_modulus,
      poissons_ratio,
      relaxation_time,
      shear_modulus, // of E_inf, added by prepare()
      bulk_modulus
    };

    /// Return E_inf, which may be zero.
    Stiffness
    long_term(const LawPoint &point)
    {
      return Stiffness(point.parameters[shear_modulus],
                       point.parameters[bulk_modulus]);
    }



    /// The stiffness B = E - E_inf of the spring that relaxes. Where E_inf = E,
    /// B is not exactly zero, since equal moduli may come from different
    /// formulas.
    class SecondSpring
    {
    public:
      SecondSpring(const Stiffness &E, const LawPoint &point)
        : tolerance(1e-10 * (2 * E.shear_modulus() + 3 * E.bulk_modulus()))
        , isotropic(E.is_isotropic())
      {
        const Stiffness E_inf = long_term(point);
        if (isotropic)
          {
            mu   = E.shear_modulus() - E_inf.shear_modulus();
            bulk = E.bulk_modulus() - E_inf.bulk_modulus();
          }
        else
          {
            const SymmetricTensor<4, 3> B = E.tensor() - E_inf.tensor();
            // Eigenvectors take twenty times longer than a factorization.
            if (!factorize(B))
              modes = spectrum(B);
          }
      }

      /// The smallest eigenvalue of B, or infinity if B could be factorized,
      /// for which its eigenvalues are not computed.
      double
      smallest_eigenvalue() const
      {
        if (isotropic)
          return std::min(2 * mu, 3 * bulk);
        return modes ? modes->values[0] :
                       std::numeric_limits<double>::infinity();
      }

      bool
      relaxes_in_all_modes() const
      {
        return smallest_eigenvalue() > tolerance;
      }

      /// Return B^-1 q without the modes that do not relax.
      SymmetricTensor<2, 3>
      strain(const SymmetricTensor<2, 3> &q) const
      {
        SymmetricTensor<2, 3> result;
        if (isotropic)
          {
            if (2 * mu > tolerance)
              result += deviator(q) / (2 * mu);
            if (3 * bulk > tolerance)
              result += trace(q) / (9 * bulk) * unit_symmetric_tensor<3>();
          }
        else if (modes)
          {
            for (unsigned int m = 0; m < 6; ++m)
              if (modes->values[m] > tolerance)
                result +=
                  (modes->modes[m] * q) / modes->values[m] * modes->modes[m];
          }
        else
          {
            std::array<double, 6> x;
            for (unsigned int i = 0; i < 6; ++i)
              {
                x[i] = q.access_raw_entry(i);
                for (unsigned int k = 0; k < i; ++k)
                  x[i] -= factor[i][k] * x[k];
                x[i] /= factor[i][i];
              }
            for (unsigned int i = 6; i-- > 0;)
              {
                for (unsigned int k = i + 1; k < 6; ++k)
                  x[i] -= factor[k][i] * x[k];
                x[i] /= factor[i][i];
                // x has engineering shears
                result.access_raw_entry(i) = i < 3 ? x[i] : x[i] / 2;
              }
          }
        return result;
      }

      /// Return the part of a tensor in the modes that do not relax.
      SymmetricTensor<2, 3>
      without_spring(const SymmetricTensor<2, 3> &tensor) const
      {
        SymmetricTensor<2, 3> result;
        if (isotropic)
          {
            if (!(2 * mu > tolerance))
              result += deviator(tensor);
            if (!(3 * bulk > tolerance))
              result += trace(tensor) / 3 * unit_symmetric_tensor<3>();
          }
        else if (modes)
          for (unsigned int m = 0; m < 6; ++m)
            if (!(modes->values[m] > tolerance))
              result += (modes->modes[m] * tensor) * modes->modes[m];
        return result;
      }

      const double tolerance;

    private:
      /// Cholesky's factorization of the matrix of components, which maps
      /// engineering shears. Returns whether all pivots exceed the tolerance.
      bool
      factorize(const SymmetricTensor<4, 3> &B)
      {
        for (unsigned int i = 0; i < 6; ++i)
          for (unsigned int j = 0; j <= i; ++j)
            {
              double entry = B.access_raw_entry(6 * i + j);
              for (unsigned int k = 0; k < j; ++k)
                entry -= factor[i][k] * factor[j][k];
              if (j < i)
                factor[i][j] = entry / factor[j][j];
              else if (entry > tolerance)
                factor[i][i] = std::sqrt(entry);
              else
                return false;
            }
        return true;
      }

      const bool isotropic;
      double     mu, bulk;
      // For anisotropic B: its Cholesky factor or, if B is singular, its modes.
      std::array<std::array<double, 6>, 6> factor;
      std::optional<Spectrum>              modes;
    };



    /// G = -(1/theta) (sigma - E_inf eps): two springs in parallel, one of
    /// stiffness E_inf and one of stiffness B = E - E_inf in series with a
    /// dashpot, which carries the stress q = sigma - E_inf eps. The stored
    /// energy is that of both springs,
    ///
    ///     1/2 E_inf eps : eps + 1/2 B^-1 q : q.
    ///
    /// A mode that does not relax, e.g. the volumetric one where K_inf = K, has
    /// no second spring, and q is what remains of an initial stress in it. With
    /// the part q_N of q in these modes the energy has
    ///
    ///     q_N : eps + 1/2 E^-1 q_N : q_N
    ///
    /// in place of 1/2 B^-1 q_N : q_N, as in the other laws: all of it is
    /// 1/2 E^-1 sigma : sigma if no mode relaxes.
    class Zener final : public PointwiseLaw<Zener>
    {
    public:
      explicit Zener(const LawSection &section)
        : PointwiseLaw(
            {{section,
              "Long-term Young's modulus",
              LawParameter::Range::non_negative},
             {section,
              "Long-term Poisson's ratio",
              LawParameter::Range::poissons_ratio},
             {section, "Relaxation time", LawParameter::Range::positive}})
      {
        for (const auto modulus : {youngs_modulus, poissons_ratio})
          if (parameters[modulus].depends_on_time())
            refuse("'" + parameters[modulus].get_name() +
                   "' depends on t; elastic moduli must be functions of "
                   "position only.");
      }

      void
      check(const Stiffness &stiffness, const LawPoint &point) const override
      {
        const SecondSpring spring(stiffness, point);
        const double       smallest = spring.smallest_eigenvalue();
        if (smallest >= -spring.tolerance)
          return;
        const double E_inf = point.parameters[youngs_modulus];
        const double modulus =
          2. * (1. + stiffness.poissons_ratio()) * stiffness.shear_modulus();
        std::string why = "the smallest eigenvalue of E - E_inf is " +
                          as_text(smallest) + "; it must be zero or positive.";
        if (stiffness.is_isotropic() && modulus < E_inf)
          why = "Young's modulus is " + as_text(modulus) +
                "; it must not be below the long-term one.";
        else if (stiffness.is_isotropic())
          {
            // From mu_inf <= mu and K_inf <= K, rounded inwards to four digits.
            const double least = E_inf / (2. * stiffness.shear_modulus()) - 1.,
                         most  = 0.5 - E_inf / (6. * stiffness.bulk_modulus());
            why = "with this Young's modulus the ratio must be at least " +
                  as_text(std::ceil(1e4 * least - 1e-6) / 1e4) +
                  " and at most " +
                  as_text(std::floor(1e4 * most + 1e-6) / 1e4) + '.';
          }
        refuse("'" + parameters[youngs_modulus].get_name() +
               "' = " + as_text(E_inf) + " with Poisson's ratio " +
               as_text(point.parameters[poissons_ratio]) +
               " makes the body stiffer in the long term than at once, at x "
               "= (" +
               as_text(point.x) + "): " + why);
      }

      SymmetricTensor<2, 3>
      rate(const SymmetricTensor<2, 3> &stress,
           const SymmetricTensor<2, 3> &strain,
           const Stiffness & /*stiffness*/,
           const LawPoint &point) const override
      {
        return (stress - long_term(point).stress(strain)) /
               -point.parameters[relaxation_time];
      }

      Tangents
      tangents(const SymmetricTensor<2, 3> & /*stress*/,
               const SymmetricTensor<2, 3> & /*strain*/,
               const Stiffness & /*stiffness*/,
               const LawPoint &point) const override
      {
        const double theta = point.parameters[relaxation_time];
        return {identity_tensor<3>() / -theta,
                long_term(point).tensor() / theta};
      }

      bool
      has_constant_tangents() const override
      {
        return true;
      }

      bool
      has_symmetric_tangents() const override
      {
        return true;
      }

      double
      relaxation_rate(const SymmetricTensor<2, 3> & /*stress*/,
                      const SymmetricTensor<2, 3> & /*strain*/,
                      const Stiffness & /*stiffness*/,
                      const LawPoint &point) const override
      {
        return 1. / point.parameters[relaxation_time];
      }

      bool
      deviatoric_flow() const override
      {
        return false;
      }

      /// B^-1 q, the strain of the second spring, plus the part of eps + E^-1
      /// q_N in the modes without a second spring.
      SymmetricTensor<2, 3>
      driving_strain(const SymmetricTensor<2, 3> &stress,
                     const SymmetricTensor<2, 3> &strain,
                     const Stiffness             &stiffness,
                     const LawPoint              &point) const override
      {
        const SecondSpring          spring(stiffness, point);
        const SymmetricTensor<2, 3> q =
          stress - long_term(point).stress(strain);
        SymmetricTensor<2, 3> result = spring.strain(q);
        if (!spring.relaxes_in_all_modes())
          result += spring.without_spring(
            strain + stiffness.strain(spring.without_spring(q)));
        return result;
      }

      bool
      has_own_energy() const override
      {
        return true;
      }

      double
      stored_energy(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> &strain,
                    const Stiffness             &stiffness,
                    const LawPoint              &point) const override
      {
        const SecondSpring          spring(stiffness, point);
        const SymmetricTensor<2, 3> elastic = long_term(point).stress(strain);
        const SymmetricTensor<2, 3> q       = stress - elastic;
        double energy = 0.5 * (elastic * strain + q * spring.strain(q));
        if (!spring.relaxes_in_all_modes())
          {
            const SymmetricTensor<2, 3> q_N = spring.without_spring(q);
            energy += q_N * (strain + 0.5 * stiffness.strain(q_N));
          }
        return energy;
      }

    private:
      void
      prepare(LawPoint &point) const override
      {
        const double modulus = point.parameters[youngs_modulus];
        if (modulus == 0.)
          return;
        const Stiffness E_inf =
          Stiffness::isotropic(modulus, point.parameters[poissons_ratio]);
        point.parameters[shear_modulus] = E_inf.shear_modulus();
        point.parameters[bulk_modulus]  = E_inf.bulk_modulus();
      }
    };
  } // namespace



  LawDescription
  zener_description()
  {
    return {
      "zener",
      "G = -(1/theta) (sigma - E_inf eps), the standard linear solid: "
      "the elastic tensor E at once, the isotropic tensor E_inf in the "
      "long term, pressure included. At fixed strain the stress decays "
      "like exp(-t/theta) to E_inf eps. Bulk and shear modulus must not "
      "exceed those of E; one that equals that of E does not relax. "
      "(Zener, Elasticity and Anelasticity of Metals, 1948, chapter 5.)",
      declare_entries(
        {{"Long-term Young's modulus",
          "0.5",
          "Young's modulus of E_inf, zero or positive, of "
          "position alone. Unit: stress."},
         {"Long-term Poisson's ratio",
          "0.3",
          "Poisson's ratio of E_inf in (-1, 1/2), likewise. "
          "Unit: 1."},
         {"Relaxation time", "1", "theta > 0 at fixed strain. Unit: time."}}),
      make_law<Zener>};
  }
} // namespace Viscoplastic
