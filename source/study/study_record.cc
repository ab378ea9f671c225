// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/json_text.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/parameters/choices.h>
#include <viscoplastic_contact/results/run_phases.h>
#include <viscoplastic_contact/study/study_record.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;

  const std::vector<std::string> field_errors{"error_energy",
                                              "error_h1",
                                              "error_stress",
                                              "error_multiplier"};

  const std::vector<std::string> estimate_parts{"estimate_space",
                                                "estimate_time",
                                                "estimate_algebraic",
                                                "estimate_initial",
                                                "estimate_total"};

  namespace
  {
    /// Whether a column is a quantity of interest, with or without _x, _y, _z.
    bool
    is_quantity(std::string name)
    {
      const std::size_t n = name.size();
      if (n > 2 && name[n - 2] == '_' && name[n - 1] >= 'x')
        name.resize(n - 2);
      for (const char *prefix : {"reaction_", "point"})
        {
          const std::string start = prefix;
          if (name.compare(0, start.size(), start) == 0 &&
              name.size() > start.size() &&
              name.find_first_not_of("0123456789", start.size()) ==
                std::string::npos)
            return true;
        }
      static const std::vector<std::string> names{"friction_force",
                                                  "contact_force",
                                                  "contact_area",
                                                  "slip_area",
                                                  "friction_dissipation",
                                                  "viscous_dissipation",
                                                  "max_displacement",
                                                  "stored_energy"};
      return std::find(names.begin(), names.end(), name) != names.end();
    }



    double
    largest(const Table &table, const std::string &name)
    {
      if (!table.has(name))
        return not_a_number;
      double result = 0.;
      for (const double value : table.columns.at(name))
        result = std::max(result, std::abs(value)); // NaN does not win
      return result;
    }



    double
    relative(const double value, const double size)
    {
      return size > 0. ? value / size : not_a_number;
    }



    nlohmann::ordered_json
    to_json(const SolverDemand &demand)
    {
      return {{"choice", static_cast<int>(demand.choice)},
              {"dimension", demand.dim},
              {"ranks", demand.n_ranks},
              {"poissons_ratio", demand.max_poissons_ratio},
              {"solves", demand.n_solves},
              {"solves_per_step", demand.solves_per_step},
              {"dofs", demand.n_dofs},
              {"face_dofs", demand.n_face_dofs},
              {"first_dofs", demand.n_first_dofs}};
    }



    SolverDemand
    read_solver_demand(const nlohmann::ordered_json &json)
    {
      SolverDemand demand;
      demand.choice = static_cast<LinearSolver>(json.at("choice").get<int>());
      json.at("dimension").get_to(demand.dim);
      json.at("ranks").get_to(demand.n_ranks);
      json.at("poissons_ratio").get_to(demand.max_poissons_ratio);
      json.at("solves").get_to(demand.n_solves);
      json.at("solves_per_step").get_to(demand.solves_per_step);
      json.at("dofs").get_to(demand.n_dofs);
      json.at("face_dofs").get_to(demand.n_face_dofs);
      json.at("first_dofs").get_to(demand.n_first_dofs);
      return demand;
    }
  } // namespace



  std::string
  to_string(const MeshStrategy strategy)
  {
    return strategy == MeshStrategy::uniform  ? "uniform" :
           strategy == MeshStrategy::adaptive ? "adaptive" :
                                                "tolerance";
  }



  MeshStrategy
  to_mesh_strategy(const std::string &name)
  {
    for (const auto strategy : {MeshStrategy::uniform,
                                MeshStrategy::adaptive,
                                MeshStrategy::tolerance})
      if (name == to_string(strategy))
        return strategy;
    AssertThrow(false,
                ExcMessage("'" + name +
                           "' is no strategy; it is uniform, adaptive or "
                           "tolerance."));
    return {};
  }



  unsigned int
  MethodVariant::order() const
  {
    return order_of(scheme == name_of(TimeScheme::heun) ?
                      TimeScheme::heun :
                      TimeScheme::forward_euler);
  }



  Table
  read_table(const std::string &file)
  {
    std::istringstream in(read_file_if_any(file).value_or(""));
    std::string        line, item;
    Table              table;
    AssertThrow(std::getline(in, line),
                ExcMessage("There is no table in '" + file + "'."));
    std::istringstream header(line);
    while (std::getline(header, item, ','))
      table.names.push_back(without_label(item));
    while (std::getline(in, line))
      {
        std::istringstream row(line);
        for (const std::string &name : table.names)
          {
            AssertThrow(std::getline(row, item, ','),
                        ExcMessage("A row of '" + file + "' is too short."));
            double value = not_a_number;
            try
              {
                value = std::stod(item);
              }
            catch (const std::exception &)
              {} // not a number
            table.columns[name].push_back(value);
          }
      }
    AssertThrow(!table.columns.empty(),
                ExcMessage("There is no row in '" + file + "'."));
    return table;
  }



  double
  RunRecord::number(const std::string &column) const
  {
    const auto found = numbers.find(column);
    return found == numbers.end() ? not_a_number : found->second;
  }



  double
  RunRecord::step_measure() const
  {
    return number(numbers.count("step_tolerance") > 0 ? "step_tolerance" : "k");
  }



  double
  RunRecord::quantity(const std::string &column) const
  {
    for (const auto &[name, value] : quantities)
      if (name == column)
        return value;
    return not_a_number;
  }



  RunRecord
  make_record(const RunKey          &key,
              const Table           &statistics,
              const RunMeasurements &measurements,
              const bool             is_difference,
              const std::string     &quantity)
  {
    RunRecord record;
    record.key         = key;
    auto       &number = record.numbers;
    const auto &column = [&](const std::string &name) {
      return statistics.has(name) ? statistics.columns.at(name) :
                                    std::vector<double>();
    };
    const auto sum = [&](const std::string &name) {
      const auto values = column(name);
      return std::accumulate(values.begin(), values.end(), 0.);
    };
    const double n_rows = column("step").size(); // with the initial state
    number["steps"]     = n_rows - 1.;
    number["k"]         = largest(statistics, "k");
    for (const std::string name : {"cells", "dofs"})
      {
        const double first = column(name).front();
        number[name] =
          n_rows > 1. ? (sum(name) - first) / (n_rows - 1.) : first;
      }
    // A table knows all of a run that was resumed, the timer the last part.
    double total = column("wall_total").back(), rest = total;
    for (const RunPhase &phase : run_phases)
      {
        const std::string wall    = "wall_" + phase.name;
        const auto        timed   = measurements.seconds.find(phase.name);
        const double      seconds = statistics.has(wall) ? sum(wall) :
                                    timed == measurements.seconds.end() ?
                                                           0. :
                                                           timed->second;
        number[phase.study_column] += seconds;
        rest -= seconds;
        if (!phase.is_cost)
          total -= seconds;
      }
    record.solver_demand        = measurements.solver_demand;
    record.solver_demand.n_dofs = std::llround(number["dofs"]);
    number["seconds_total"]     = total;
    number["seconds_rest"]      = rest;
    number["peak_memory_MB"]    = measurements.peak_memory;
    number["first_memory_MB"]   = measurements.first_memory;
    for (const std::string name : {"contact_iterations", "linear_iterations"})
      number[name] = sum(name);

    double limit = std::numeric_limits<double>::infinity();
    for (const double value : column("step_limit"))
      if (value > 0.)
        limit = std::min(limit, value);
    number["step_limit"] = limit;

    // Norms of a reference are known at the ends of phases only, where loads
    // may have gone; those of the run itself are known always.
    const std::map<std::string, std::string> own_norms{
      {"error_energy", "energy_norm"}, {"error_stress", "stress_norm"}};
    for (const std::string &name : field_errors)
      {
        double     size = largest(statistics, "exact" + name.substr(5));
        const auto own  = own_norms.find(name);
        if (is_difference && own != own_norms.end() &&
            largest(statistics, own->second) > size)
          size = largest(statistics, own->second);
        number[name] = relative(largest(statistics, name), size);
      }
    if (is_difference)
      number["is_difference"] = 1.;
    for (const std::string &name : estimate_parts)
      number[name] =
        relative(largest(statistics, name), largest(statistics, "energy_norm"));
    number["effectivity"] = relative(largest(statistics, "estimate_total"),
                                     largest(statistics, "error_energy"));
    number["effectivity_recovery"] =
      relative(largest(statistics, "estimate_recovery"),
               largest(statistics, "error_energy"));
    if (!quantity.empty())
      number["estimate_quantity"] =
        relative(largest(statistics, "quantity_total"),
                 largest(statistics, quantity));

    for (const std::string &name : statistics.names)
      if (is_quantity(name))
        record.quantities.emplace_back(name,
                                       statistics.columns.at(name).back());
    return record;
  }



  std::string
  to_json(const RunRecord &record)
  {
    const MethodVariant   &variant = record.key.variant;
    nlohmann::ordered_json json{{"run", record.name},
                                {"strategy", to_string(variant.strategy)},
                                {"scheme", variant.scheme},
                                {"history", variant.history},
                                {"mesh_level", record.key.mesh_level},
                                {"time_level", record.key.time_level},
                                {"timing", record.key.is_timing},
                                {"stamp", record.stamp},
                                {"solver_demand",
                                 to_json(record.solver_demand)},
                                {"numbers", record.numbers},
                                {"quantities", nlohmann::json::object()}};
    for (const auto &[name, value] : record.quantities)
      json["quantities"][name] = value;
    return json_text(json);
  }



  RunRecord
  from_json(const std::string &text, const std::string &file)
  {
    using Json        = nlohmann::ordered_json;
    const auto number = [](const Json &value) {
      return value.is_null() ? not_a_number : value.get<double>();
    };
    RunRecord record;
    try
      {
        const Json json = Json::parse(text);
        json.at("run").get_to(record.name);
        record.key.variant.strategy =
          to_mesh_strategy(json.at("strategy").get<std::string>());
        json.at("scheme").get_to(record.key.variant.scheme);
        json.at("history").get_to(record.key.variant.history);
        json.at("mesh_level").get_to(record.key.mesh_level);
        json.at("time_level").get_to(record.key.time_level);
        json.at("timing").get_to(record.key.is_timing);
        json.at("stamp").get_to(record.stamp);
        record.solver_demand = read_solver_demand(json.at("solver_demand"));
        for (const auto &[name, value] :
             json.at("numbers").get_ref<const Json::object_t &>())
          record.numbers[name] = number(value);
        for (const auto &[name, value] :
             json.at("quantities").get_ref<const Json::object_t &>())
          record.quantities.emplace_back(name, number(value));
      }
    catch (const std::exception &exception)
      {
        AssertThrow(false,
                    ExcMessage("'" + file +
                               "' is no record of a finished run: " +
                               reason(exception)));
      }
    return record;
  }
} // namespace Viscoplastic
