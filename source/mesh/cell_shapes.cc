// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/cell_shapes.h>

#include <cmath>

namespace Viscoplastic
{
  template <int dim>
  std::pair<unsigned int, bool>
  CellShapes<dim>::add(
    const typename DoFHandler<dim>::active_cell_iterator &cell)
  {
    // Vertices relative to the first one, divided by the diameter and rounded,
    // are equal for translated cells despite rounding errors.
    constexpr double                   resolution = 1ll << 36;
    std::array<std::int64_t, key_size> key{};
    int                                exponent;
    const double                       diameter = cell->diameter();
    key[0]         = std::llround(std::frexp(diameter, &exponent) * resolution);
    key[1]         = exponent;
    unsigned int i = 2;
    for (unsigned int v = 1; v < cell->n_vertices(); ++v)
      for (unsigned int d = 0; d < dim; ++d)
        key[i++] = std::llround((cell->vertex(v)[d] - cell->vertex(0)[d]) /
                                diameter * resolution);
    if (is_of_ring)
      key.back() = std::llround(cell->vertex(0)[0] / diameter * resolution);
    const auto [entry, is_new] = number_of.emplace(key, number_of.size());
    return {entry->second, is_new};
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(CellShapes);
} // namespace Viscoplastic
