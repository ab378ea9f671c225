// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/results/run_record.h>

#include <nlohmann/json.hpp>

#include <ctime>
#include <filesystem>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    nlohmann::ordered_json
    record_of_errors(const ErrorSummary &errors,
                     const std::string  &name_of_size)
    {
      return {{"t", errors.t},
              {"space", errors.largest.space},
              {"history", errors.largest.history},
              {"time", errors.largest.time},
              {"friction", errors.largest.friction},
              {"transfer", errors.largest.transfer},
              {"algebraic", errors.largest.algebraic},
              {"initial", errors.largest.initial},
              {"total", errors.largest.total()},
              {name_of_size, errors.size},
              {"relative", errors.relative()}};
    }



    template <int dim>
    nlohmann::ordered_json
    record_of_costs(const RunEnd<dim> &end)
    {
      const SolverDemand  &demand   = end.solver_demand;
      const BulkSolverKind solver   = choose_bulk_solver(demand);
      const SolverCost     expected = expected_cost(solver, demand);
      return {{"seconds", end.bill.seconds},
              {"friction_seconds", end.bill.friction()},
              {"memory_before_MB", end.first_memory},
              {"peak_memory_MB", end.peak_memory},
              {"solver", to_string(solver)},
              {"solver_demand",
               {{"choice", name_of(demand.choice)},
                {"dimension", demand.dim},
                {"ranks", demand.n_ranks},
                {"poissons_ratio", demand.max_poissons_ratio},
                {"solves", demand.n_solves},
                {"solves_per_step", demand.solves_per_step},
                {"dofs", demand.n_dofs},
                {"face_dofs", demand.n_face_dofs},
                {"first_dofs", demand.n_first_dofs},
                {"friction", demand.has_friction}}},
              {"expected",
               {{"set_up", expected.set_up},
                {"step", expected.step},
                {"memory_MB", 1e-6 * expected_memory(solver, demand)}}}};
    }



    /// Return the processor model of this rank, as Linux names it.
    std::string
    processor()
    {
      std::ifstream file("/proc/cpuinfo");
      for (std::string line; std::getline(file, line);)
        if (const auto colon = line.find(": ");
            line.rfind("model name", 0) == 0 && colon != std::string::npos)
          return line.substr(colon + 2);
      return "unknown";
    }
  } // namespace



  template <int dim>
  void
  write_record(const Scene<dim>  &scene,
               const std::string &path,
               const unsigned int n_ranks,
               const RunEnd<dim> *end)
  {
    std::ostringstream parameters;
    scene.parameters.print(parameters);
    replace_file(path + "parameters.prm", parameters.str());

    const std::time_t now = std::time(nullptr);
    char              date[32];
    std::strftime(date, sizeof(date), "%FT%TZ", std::gmtime(&now));
    nlohmann::ordered_json record{{"program", "viscoplastic_contact"},
                                  {"version", program_version},
                                  {"git_revision", git_revision},
                                  {"dealii_version", DEAL_II_PACKAGE_VERSION},
                                  {"n_mpi_ranks", n_ranks},
                                  {"dimension", dim},
                                  {"effects", scene.effects()},
                                  {"changed_defaults",
                                   scene.changed_defaults()}};
    const Units           &units = scene.parameters.units;
    if (units.are_declared())
      record["units"] = {{"length", units.length.name},
                         {"time", units.time.name},
                         {"stress", units.stress.name}};
    for (const auto &[place, name] : scene.names.names)
      record["names"][place.text()] = name;
    // parameters.prm has these entries as they were written.
    if (const auto entries = scene.parameters.entries_with_units();
        !entries.empty())
      record["entries_with_units"] = entries;
    const auto &libraries = scene.parameters.shared_libraries;
    if (!libraries.empty())
      record["shared_libraries"] = libraries;
    for (const auto &table : tables_in_use())
      record["tables"].push_back({{"section", table->section},
                                  {"file", table->file},
                                  {"crc32", table->checksum}});
    if (end != nullptr)
      {
        const RunSummary<dim> &summary = end->summary;
        if (summary.errors)
          record["estimated_error"] =
            record_of_errors(*summary.errors, "largest_energy_norm");
        if (!summary.quantity.empty())
          {
            auto &errors = record["estimated_error_of_quantity"] =
              record_of_errors(summary.quantity_errors, "largest_value");
            errors["quantity"] = summary.quantity;
          }
        if (summary.jump_position)
          for (unsigned int d = 0; d < dim; ++d)
            record["prescribed_jump"].push_back((*summary.jump_position)[d]);
        if (!summary.doubtful_steps.empty())
          record["doubtful_steps"] = summary.doubtful_steps;
        if (!end->remarks.empty())
          record["remarks"] = end->remarks;
        record["costs"] = record_of_costs(*end);
      }
    record["processor"] = processor();
    record["date"]      = date;
    replace_file(path + "run.json", json_text(record));
  }



  std::string
  results_directory(const Parameters &parameters)
  {
    std::string path = parameters.output.directory;
    if (path.empty())
      path = "output/" + std::filesystem::path(parameters.file).stem().string();
    return path.back() == '/' ? path : path + '/';
  }



  void
  make_results_directory(const std::string &path)
  {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error)
      refuse(
        "The results directory '" + path +
        "' cannot be written; change 'Output/Directory' or its permissions.");
  }



  VISCOPLASTIC_INSTANTIATE(write_record);
} // namespace Viscoplastic
