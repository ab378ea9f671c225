// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/scene/scene.h>

#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A field, or a component of one, in files of results.
  struct FieldColumn
  {
    std::string name;
    /// The rank of the tensor; for fields, not for components, it may also be
    /// principal, three principal values.
    unsigned int                  rank;
    Quantity                      quantity;
    static constexpr unsigned int principal = 3;
  };

  const FieldColumn &
  column_of(const RecordedField field);

  /// The components of the fields of the body, or of the boundary, in the order
  /// of the enumeration: displacement_x, ..., creep_rate, ...
  template <int dim>
  std::vector<FieldColumn>
  columns_of(const std::set<RecordedField> &fields, const bool of_boundary);

  /// The quantity of cell-wise estimates: roots of energies or, for a quantity
  /// of interest, of any unit.
  template <int dim>
  Quantity
  quantity_of_estimator(const Scene<dim> &scene);

} // namespace Viscoplastic
