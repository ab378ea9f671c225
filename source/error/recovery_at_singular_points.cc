// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/recovery_estimator.h>

// Errors at singular points that recovery by nodal means misses.

namespace Viscoplastic
{
  template <int dim>
  std::optional<typename RecoveryEstimator<dim>::Patch>
  RecoveryEstimator<dim>::patch(const unsigned int c,
                                const unsigned int vertex) const
  {
    if (across[c][opposite(vertex)] == numbers::invalid_unsigned_int)
      return {};
    const unsigned int node    = nodes[c][opposite(vertex)];
    const double       density = energy_density(c, recovered(node)),
                 energy        = density * sums.local_element(node + 2);
    return Patch{density,
                 energy,
                 std::max(0., sums.local_element(node) - energy),
                 sums.local_element(node + 1)};
  }



  template <int dim>
  void
  RecoveryEstimator<dim>::raise_at_singular_points(
    const Part          &part,
    const Strains       &means,
    std::vector<double> &squares) const
  {
    // Strains that grow more slowly than r^(-1/4) are recovered well enough.
    const double     least_growth = std::sqrt(2.);
    constexpr double nearly       = 1. - 1e-6; // equal but for rounding
    const auto       node         = [this](NodalVector       &field,
                             const unsigned int c,
                             const unsigned int v,
                             const unsigned int i) -> double               &{
      return field.local_element(nodes[c][v] + i);
    };
    std::vector<double> densities(local.cells.size());
    sums = 0.;
    for (const unsigned int c : part.cells)
      {
        densities[c] = energy_density(c, means[c]);
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            node(sums, c, v, 0) += densities[c] * local.stress_space.volume(c);
            node(sums, c, v, 1) += squares[c];
            node(sums, c, v, 2) += local.stress_space.volume(c);
          }
      }
    sums.compress(VectorOperation::add);
    sums.update_ghost_values();

    // A vertex is singular if, in the adjacent cell of the largest energy
    // density, strains grow most toward this vertex, and is_curved(): bending
    // and holes are not singular.
    maxima = 0.;
    for (const unsigned int c : part.cells)
      {
        std::array<double, n_vertices> growth{};
        for (unsigned int v = 0; v < n_vertices; ++v)
          if (const auto around = patch(c, v);
              around && densities[c] > least_growth * around->density &&
              is_curved(c, v, means))
            growth[v] = densities[c] / around->density;
        const double largest = *std::max_element(growth.begin(), growth.end());
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            const auto raise = [&](const unsigned int i) {
              node(maxima, c, v, i) =
                std::max(node(maxima, c, v, i), densities[c]);
            };
            raise(0);
            if (largest > 0. && growth[v] >= nearly * largest)
              raise(1);
          }
      }
    maxima.compress(VectorOperation::max);
    maxima.update_ghost_values();
    const auto is_singular = [&](const unsigned int c, const unsigned int v) {
      const double largest = node(maxima, c, v, 0);
      return largest > 0. && node(maxima, c, v, 1) >= nearly * largest;
    };

    std::vector<std::tuple<unsigned int, unsigned int, Patch>> cells;
    for (const unsigned int c : part.cells)
      for (unsigned int v = 0; v < n_vertices; ++v)
        if (is_singular(c, v))
          if (const auto around = patch(c, v))
            cells.emplace_back(c, v, *around);
    sums = 0.;
    for (const auto &[c, v, around] : cells)
      {
        node(sums, c, v, 0) += densities[c] * local.stress_space.volume(c);
        node(sums, c, v, 1) += around.energy;
      }
    sums.compress(VectorOperation::add);
    sums.update_ghost_values();
    const std::vector<double> before = squares;
    for (const auto &[c, v, around] : cells)
      {
        const double q = std::min(node(sums, c, v, 0) / node(sums, c, v, 1),
                                  part.largest_share);
        squares[c]     = std::max(squares[c],
                              q / (1. - q) *
                                (around.variation + around.error - before[c]));
      }
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(RecoveryEstimator, raise_at_singular_points);
} // namespace Viscoplastic
