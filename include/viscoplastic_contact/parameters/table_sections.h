// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <viscoplastic_contact/base/table.h>

#include <set>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  struct ParameterLine;

  void
  declare_tables(ParameterHandler &prm, const std::set<unsigned int> &numbers);

  /// The tables of these numbers, which have been parsed from the lines, and in
  /// the handler the names of their files as they can be found from anywhere.
  /// Throws ExcMessage with the line of the parameter file, and that of the
  /// table, where a table is not as it has to be.
  Tables
  read_tables(ParameterHandler                 &prm,
              const std::set<unsigned int>     &numbers,
              const std::vector<ParameterLine> &lines);
} // namespace Viscoplastic
