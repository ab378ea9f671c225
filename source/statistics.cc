// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>

#include <viscoplastic_contact/statistics.h>

#include <iomanip>

namespace Viscoplastic
{
  using namespace dealii;

  Statistics::Statistics(const std::string &file_name)
    : name(file_name)
    , file(file_name)
  {
    AssertThrow(file, ExcMessage("The file '" + name + "' cannot be written."));
  }



  void
  Statistics::add(const std::string &column, const double value)
  {
    row.emplace_back(column, value);
  }



  void
  Statistics::end_row()
  {
    if (columns.empty())
      {
        for (const auto &entry : row)
          {
            file << (columns.empty() ? "" : ",") << entry.first;
            columns.push_back(entry.first);
          }
        file << '\n';
      }
    AssertDimension(columns.size(), row.size());
    file << std::setprecision(12);
    for (unsigned int i = 0; i < row.size(); ++i)
      {
        Assert(columns[i] == row[i].first, ExcInternalError());
        file << (i == 0 ? "" : ",") << row[i].second;
      }
    file << std::endl;
    AssertThrow(file,
                ExcMessage("Writing to '" + name +
                           "' failed; is the disk full?"));
    row.clear();
  }
} // namespace Viscoplastic
