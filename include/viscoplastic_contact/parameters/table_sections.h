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

  /// Read the tables with these numbers, whose sections have been parsed, and
  /// set the entries `File' in the handler to absolute paths. Throws ExcMessage
  /// with the line of the parameter file, and that of the table, if a table is
  /// invalid.
  Tables
  read_tables(ParameterHandler                 &prm,
              const std::set<unsigned int>     &numbers,
              const std::vector<ParameterLine> &lines);
} // namespace Viscoplastic
