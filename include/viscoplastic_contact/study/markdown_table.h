// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/price_list.h>

#include <cmath>
#include <string>
#include <vector>

namespace Viscoplastic
{
  // Lines of tables in study.md.

  inline std::string
  table_row(const std::vector<std::string> &cells)
  {
    std::string row = "|";
    for (const std::string &cell : cells)
      row += ' ' + cell + " |";
    return row + '\n';
  }

  inline std::string
  table_head(const std::vector<std::string> &cells)
  {
    return table_row(cells) +
           table_row(std::vector<std::string>(cells.size(), "---"));
  }

  inline std::string
  number_or_dash(const double value, const unsigned int n = 3)
  {
    return std::isfinite(value) ? digits(value, n) : "-";
  }
} // namespace Viscoplastic
