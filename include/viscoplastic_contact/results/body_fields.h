// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A field of the body with one value a cell, by active cell index; zero on
  /// cells of other ranks.
  struct CellField
  {
    std::string    name;
    Vector<double> values;
  };


  /**
   * The fields of `Output/Additional fields' that the body has, of cell means,
   * in the order of that entry's choices. Nothing is computed for what is not
   * asked for. Collective, and the same names on all ranks.
   */
  template <int dim>
  std::vector<CellField>
  additional_fields(const FlowLaws<dim> &laws, const State<dim> &state);
} // namespace Viscoplastic
