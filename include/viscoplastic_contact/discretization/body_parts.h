// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/admissible_space.h>

#include <set>
#include <vector>

namespace Viscoplastic
{
  /// The parts of the present body, joined by faces. Without stages and
  /// contact between bodies it is one.
  struct BodyParts
  {
    unsigned int n = 1;
    /// The parts that each boundary node belongs to, by its position in the
    /// list of boundary nodes.
    std::vector<std::set<unsigned int>> of_node;
    /// The part of each cell of the coarse mesh, by
    /// CellId::get_coarse_cell_id(); empty where there is one.
    std::vector<unsigned int> of_cell;
  };

  template <int dim>
  BodyParts
  find_parts(const AdmissibleSpace<dim> &space);
} // namespace Viscoplastic
