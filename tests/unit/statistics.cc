// SPDX-License-Identifier: LGPL-2.1-or-later
#include "folder.h"
#include <viscoplastic_contact/results/statistics.h>

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace
{
  using namespace Viscoplastic;

  TableRow
  row_of(const int step, const std::string &column, const double value)
  {
    TableRow row;
    row.add("step", step);
    row.add(column, value, Quantity::time);
    return row;
  }



  /// A table with units is continued by the names of its columns.
  TEST(Statistics, TablesWithUnitsGoOn)
  {
    const Testing::Folder folder;
    const std::string     file = folder.add("statistics.csv", "");
    {
      TableFile table(file, Units("m", "day", "MPa"), 2);
      for (const int n : {0, 1})
        table.write(row_of(n, "t", 2. * n));
    }
    {
      TableFile table(file, Units("m", "day", "MPa"), 2, /* last_step = */ 1);
      table.write(row_of(2, "t", 5.));
      EXPECT_THROW(table.write(row_of(3, "k", 5.)), std::exception);
    }
    std::ifstream     in(file);
    std::stringstream text;
    text << in.rdbuf();
    EXPECT_EQ(text.str().substr(0, 24), "step,t [day]\n0,0\n1,2\n2,5");
  }
} // namespace
