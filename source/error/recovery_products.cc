// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/recovery_estimator.h>

// Products of the recovered errors of a state and of a dual solution.

namespace Viscoplastic
{
  template <int dim>
  void
  RecoveryEstimator<dim>::renew(
    const Part                               &part,
    const DistributedVector                  &w,
    const std::vector<SymmetricTensor<4, 3>> *tangents,
    OfDual                                   &dual) const
  {
    const unsigned int n_samples = local.stress_space.n_samples;
    for (const unsigned int c : part.cells)
      {
        std::array<double, n_points> dilatation;
        const auto                   eps = strains(c, w, dilatation.data());
        const auto                   e   = defects(c, eps);
        for (unsigned int q = 0; q < n_points; ++q)
          {
            const std::size_t i         = c * n_points + q;
            const Stiffness  &stiffness = local.cells[c].stiffness;
            const auto        C = [&](const SymmetricTensor<2, 3> &strain) {
              return tangents == nullptr ?
                              stiffness.stress(strain) :
                              (*tangents)[c * n_samples + (n_samples == 1 ? 0 : q)] *
                         strain;
            };
            dual.stress[i] = C(e[q]);
            if (!dual.dilatation.empty())
              {
                dual.dilatation[i] = dilatation[q] / 3.;
                dual.of_dilatation[i] =
                  dual.dilatation[i] * C(unit_symmetric_tensor<3>());
              }
            if (!dual.strain.empty())
              dual.strain[i] = eps[q];
          }
      }
  }



  template <int dim>
  Vector<double>
  RecoveryEstimator<dim>::multiply(
    const DistributedVector                  &u,
    const IrreversibleStress                 &z,
    const DistributedVector                  &w,
    const std::vector<SymmetricTensor<4, 3>> *tangents,
    const Linearization                      &law,
    OfDual                                   &dual) const
  {
    const unsigned int  n_samples = local.stress_space.n_samples;
    const bool          dilates   = local.stress_space.mean_dilatation;
    const bool          is_first  = dual.curved.empty();
    std::vector<double> products(local.cells.size());
    double              in_doubt = 0.;
    if (is_first)
      {
        const std::size_t n = nodes.size() * n_points;
        dual.stress.resize(n);
        dual.dilatation.resize(dilates ? n : 0);
        dual.of_dilatation.resize(dilates ? n : 0);
        dual.strain.resize(law.remainder ? n : 0);
        dual.curved.resize(parts.size());
        dual.left.resize(parts.size());
      }
    AssertDimension(dual.strain.size(),
                    law.remainder ? nodes.size() * n_points : 0);

    // The volumetric strain at which the elastic pressure cancels that of z.
    // In plane strain without the component zz, which no strain has.
    SymmetricTensor<2, 3> unit = unit_symmetric_tensor<3>();
    if (dim == 2 && !local.has_hoops && !local.stress_space.space.axial)
      unit[2][2] = 0.;
    const auto swelling = [&](const unsigned int           c,
                              const SymmetricTensor<2, 3> &stress) {
      return -trace(stress) /
             (3. * local.cells[c].stiffness.bulk_modulus() * trace(unit)) *
             unit;
    };
    Strains                      means = mean_strains(u);
    IrreversibleStress           of_cells;
    const SymmetricTensor<2, 3> *mean_z =
      dilates && n_samples > 1 ? local.mean_irreversible_stress(z, of_cells) :
                                 nullptr;
    for (unsigned int c = 0; mean_z != nullptr && c < means.size(); ++c)
      means[c] -= swelling(c, mean_z[c]);
    for (unsigned int p = 0; p < parts.size(); ++p)
      {
        const Part &part = parts[p];
        recover(part, means);
        std::vector<bool> left = curved_ends(part, means);
        if (is_first)
          {
            const Strains of_w = mean_strains(w);
            recover(part, of_w);
            dual.curved[p] = curved_ends(part, of_w);
          }
        for (std::size_t i = 0; i < left.size(); ++i)
          left[i] = left[i] && dual.curved[p][i];
        if (Utilities::MPI::max(is_first || left != dual.left[p] ? 1 : 0,
                                local.stress_space.space.communicator) == 1)
          {
            const Strains of_w = mean_strains(w);
            recover(part, of_w);
            extrapolate(part, of_w, left);
            renew(part, w, tangents, dual);
            dual.left[p] = left;
            recover(part, means);
          }
        extrapolate(part, means, left);
        for (const unsigned int c : part.cells)
          {
            const auto &weights = local.shapes[local.cells[c].shape].weights;
            std::array<double, n_points> dilatation;
            const auto                   eps = strains(c, u, dilatation.data());
            auto                         e   = defects(c, eps);
            for (unsigned int q = 0; q < n_points; ++q)
              {
                const unsigned int s = n_samples == 1 ? 0 : q;
                if (mean_z != nullptr)
                  e[q] += swelling(c, z[c * n_samples + s]);
                const std::size_t i       = c * n_points + q;
                double            product = e[q] * dual.stress[i];
                // The part of the error in the step: the share of the deviator,
                // but all of the volumetric part, since creep preserves volume.
                const SymmetricTensor<2, 3> of_step =
                  e[q] - (1. - law.share) * deviator(e[q]);
                if (dilates)
                  {
                    product -= dilatation[q] / 3. * trace(dual.stress[i]) +
                               of_step * dual.of_dilatation[i] / law.share;
                    if (n_samples > 1 && !z.empty())
                      product -= trace(z[c * n_samples + s]) *
                                 dual.dilatation[i] / law.share;
                  }
                if (law.remainder)
                  {
                    const auto [stress, is_in_doubt] = law.remainder(
                      c, s, n_samples == 1 ? means[c] : eps[q], -1. * of_step);
                    const double beyond = stress * dual.strain[i] / law.share;
                    product -= beyond;
                    if (is_in_doubt)
                      in_doubt -= weights[q] * beyond;
                  }
                products[c] += weights[q] * product;
              }
          }
      }
    dual.in_doubt =
      Utilities::MPI::sum(in_doubt, local.stress_space.space.communicator);
    return local.by_active_index(products);
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(RecoveryEstimator, multiply);
} // namespace Viscoplastic
