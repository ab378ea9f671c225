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
    const unsigned int node = nodes[c][opposite(vertex)];
    const double       energy =
      energy_density(c, recovered(node)) * sums.local_element(node + 2);
    return Patch{energy,
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
    // A vertex is singular if, in the adjacent cell of the largest energy
    // density, strains grow most toward this vertex, and is_curved(): bending
    // and holes are not singular.
    std::vector<double> densities(local.cells.size());
    const auto          raise =
      [&](const unsigned int c, const unsigned int v, const unsigned int i) {
        node(maxima, c, v, i) = std::max(node(maxima, c, v, i), densities[c]);
      };
    sums   = 0.;
    maxima = 0.;
    for (const unsigned int c : part.cells)
      {
        const double volume = local.stress_space.volume(c);
        densities[c]        = energy_density(c, means[c]);
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            node(sums, c, v, 0) += densities[c] * volume;
            node(sums, c, v, 1) += squares[c];
            node(sums, c, v, 2) += volume;
            raise(c, v, 0);
          }
      }
    sums.compress(VectorOperation::add);
    sums.update_ghost_values();
    maxima.compress(VectorOperation::max);
    maxima.update_ghost_values();
    // The growth of the density toward a vertex; zero where it is not singular.
    const auto growth = [&](const unsigned int c, const unsigned int v) {
      if (across[c][opposite(v)] == numbers::invalid_unsigned_int)
        return 0.;
      const double around = energy_density(c, recovered(nodes[c][opposite(v)]));
      return densities[c] > least_growth * around && is_curved(c, v, means) ?
               densities[c] / around :
               0.;
    };
    std::vector<std::pair<unsigned int, unsigned int>> grows;
    for (const unsigned int c : part.cells)
      for (unsigned int v = 0; v < n_vertices; ++v)
        if (densities[c] >= nearly * node(maxima, c, v, 0))
          if (const double here = growth(c, v); here > 0.)
            {
              double largest = here;
              for (unsigned int w = 0; w < n_vertices; ++w)
                largest = std::max(largest, growth(c, w));
              if (here >= nearly * largest)
                grows.emplace_back(c, v);
            }
    maxima.zero_out_ghost_values();
    for (const auto &[c, v] : grows)
      raise(c, v, 1);
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
