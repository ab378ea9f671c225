// SPDX-License-Identifier: LGPL-2.1-or-later
#include "folder.h"
#include <viscoplastic_contact/results/statistics.h>

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace
{
  using namespace Viscoplastic;

  /// A table of a scene with units goes on by the names of its columns.
  TEST(Statistics, TablesWithUnitsGoOn)
  {
    const Testing::Folder folder;
    const std::string     file = folder.add("statistics.csv", "");
    {
      Statistics table(file, [](const std::string &column) {
        return column == "t" ? " [day]" : "";
      });
      for (const int n : {0, 1})
        {
          table.add("step", n);
          table.add("t", 2. * n);
          table.end_row();
        }
    }
    {
      Statistics table(file, /* last_step = */ 1);
      table.add("step", 2);
      table.add("t", 5.);
      table.end_row();
      table.add("step", 3);
      table.add("k", 5.);
      EXPECT_THROW(table.end_row(), std::exception); // another column
    }
    std::ifstream     in(file);
    std::stringstream text;
    text << in.rdbuf();
    EXPECT_EQ(text.str().substr(0, 24), "step,t [day]\n0,0\n1,2\n2,5");
  }
} // namespace
