// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/quantity_histories.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace Viscoplastic
{
  namespace
  {
    /// Quantities of the same kind have the same unit.
    std::string
    sort_of_quantity(const std::string &quantity)
    {
      const auto begins = [&](const std::string &start) {
        return quantity.compare(0, start.size(), start) == 0;
      };
      if (begins("friction_force") || begins("contact_force") ||
          begins("reaction_"))
        return "force";
      if (begins("point") || quantity == "max_displacement")
        return "displacement";
      if (quantity == "max_von_mises" || quantity == "mean_von_mises")
        return "stress";
      return quantity == "friction_dissipation" ||
                 quantity == "viscous_dissipation" ||
                 quantity == "stored_energy" || quantity == "external_work" ?
               "energy" :
               "";
    }



    /// The columns of each quantity: its components, or itself.
    std::vector<std::pair<std::string, std::vector<std::string>>>
    quantities_of(const Table &run)
    {
      std::vector<std::pair<std::string, std::vector<std::string>>> result;
      for (const std::string &column : run.names)
        {
          std::string       name = column;
          const std::size_t n    = name.size();
          if (n > 2 && name[n - 2] == '_' && name[n - 1] >= 'x')
            name.resize(n - 2);
          if (sort_of_quantity(name).empty())
            continue;
          if (result.empty() || result.back().first != name)
            result.push_back({name, {}});
          result.back().second.push_back(column);
        }
      return result;
    }



    /// The value of a column at a time, between its rows linear.
    double
    value_at(const Table &run, const std::string &column, const double t)
    {
      if (!run.has(column))
        return 0.;
      const std::vector<double> &times  = run.columns.at("t"),
                                &values = run.columns.at(column);
      const std::size_t after =
        std::lower_bound(times.begin(), times.end(), t) - times.begin();
      if (after == 0)
        return values.front();
      if (after == times.size())
        return values.back();
      const double share =
        (t - times[after - 1]) / (times[after] - times[after - 1]);
      return (1. - share) * values[after - 1] + share * values[after];
    }


    /// A run with a sign.
    struct Term
    {
      const Table *run;
      double       sign;
    };

    /// For each quantity of @p run the largest size of the sum of it and the
    /// @p others over the largest size of the quantity.
    std::vector<QuantityChange>
    differences(const Table &run, const std::vector<Term> &others)
    {
      const std::vector<double>    &times = run.columns.at("t");
      std::vector<QuantityChange>   result;
      std::vector<double>           sizes;
      std::map<std::string, double> largest;
      for (const auto &[name, columns] : quantities_of(run))
        {
          double size = 0., change = 0.;
          for (std::size_t i = 0; i < times.size(); ++i)
            {
              double square = 0., difference = 0.;
              for (const std::string &column : columns)
                {
                  const double value = run.columns.at(column)[i];
                  double       sum   = value;
                  for (const Term &term : others)
                    sum += term.sign * value_at(*term.run, column, times[i]);
                  square += value * value;
                  difference += sum * sum;
                }
              size   = std::max(size, std::sqrt(square));
              change = std::max(change, std::sqrt(difference));
            }
          // Under another contact law the normal force is a reaction or data.
          if (name == "contact_force" &&
              std::any_of(others.begin(), others.end(), [&](const Term &term) {
                return !term.run->has(columns[0]);
              }))
            change = 0.;
          result.push_back({name, change, 0.});
          sizes.push_back(size);
          double &most = largest[sort_of_quantity(name)];
          most         = std::max(most, size);
        }
      for (std::size_t q = 0; q < result.size(); ++q)
        {
          // Energies are parts of one balance: beside all of it a dissipation
          // can be negligible.
          const std::string sort = sort_of_quantity(result[q].quantity);
          const double      size = sort == "energy" ?
                                     largest.at(sort) :
                                     std::max(sizes[q], 1e-3 * largest.at(sort));
          result[q].change       = size > 0. ? result[q].change / size : 0.;
        }
      return result;
    }
  } // namespace



  std::vector<QuantityChange>
  changes_between(const Table &run, const Table &other)
  {
    return differences(run, {{&other, -1.}});
  }



  std::vector<QuantityChange>
  interactions(const Table &run,
               const Table &first,
               const Table &second,
               const Table &both)
  {
    return differences(run, {{&first, -1.}, {&second, -1.}, {&both, 1.}});
  }
} // namespace Viscoplastic
