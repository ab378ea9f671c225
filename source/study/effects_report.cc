// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/json_text.h>
#include <viscoplastic_contact/results/output.h>
#include <viscoplastic_contact/study/effects_report.h>
#include <viscoplastic_contact/study/markdown_table.h>
#include <viscoplastic_contact/study/study_report.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    std::string
    percent(const double value)
    {
      return std::isfinite(value) ? digits(100. * value, 2) + " %" : "-";
    }



    /// "friction_force by 3 %, its error here is 0.2 %"
    std::string
    change_in_words(const EffectResult &result)
    {
      if (!result.failure.empty() ||
          result.verdict == EffectVerdict::never_acted)
        return "nothing";
      return result.decisive.quantity + " by " +
             percent(result.decisive.change);
    }



    /// What the scene pays for the effect, of what it takes with it.
    std::string
    cost_in_words(const EffectResult &result)
    {
      if (!result.failure.empty())
        return "-";
      const double share = 1. - result.seconds_without / result.seconds_with;
      return digits(result.seconds_with - result.seconds_without, 2) + " s (" +
             digits(100. * share, 2) + " %), " +
             digits(result.memory_with - result.memory_without, 2) + " MB";
    }



    std::vector<std::string>
    cells_of(const EffectResult &result)
    {
      const bool failed = !result.failure.empty();
      return {result.variant.effect,
              result.variant.instead,
              to_string(result.verdict),
              change_in_words(result),
              failed ? "-" : percent(result.decisive.error),
              failed ? "-" : percent(result.energy_distance),
              cost_in_words(result),
              failed ? "-" : digits(result.cells, 9)};
    }



    const std::vector<std::string> effects_header{"effect",
                                                  "instead",
                                                  "verdict",
                                                  "changes most",
                                                  "error there",
                                                  "energy norm",
                                                  "costs",
                                                  "cells"};



    std::string
    markdown(const EffectsStudy &study, const Origin &origin)
    {
      const std::filesystem::path scene = study.scene.file;
      std::ostringstream          text;
      text << "# Effects of " << scene.stem().string() << "\n\n"
           << "What each effect changes, beside the error of the "
              "discretization, and what it costs. Changes are the largest of "
              "all times over the largest value; the quantity is that whose "
              "change is the largest in proportion to its error, which is the "
              "difference to a run with twice the mesh width and time steps. "
              "Energy norm: of the difference of the displacements at the ends "
              "of the phases of time.\n\n";
      if (std::filesystem::exists(study.directory + "effects.png"))
        text << "![What effects change and cost](effects.png)\n\n";
      for (const bool is_physical : {true, false})
        {
          bool is_first = true;
          for (const EffectResult &result : study.results)
            if (result.variant.is_physical == is_physical)
              {
                if (is_first)
                  text << (is_physical ? "## The problem\n\n" :
                                         "\n## The discretization\n\n")
                       << table_head(effects_header);
                is_first = false;
                text << table_row(cells_of(result));
              }
        }
      for (const EffectResult &result : study.results)
        if (!result.failure.empty())
          text << "\nWithout " << result.variant.effect << " ("
               << result.variant.instead << "): " << result.failure << '\n';
      if (study.together && study.together->failure.empty())
        text << "\n## The two largest at once\n\n"
             << table_head(effects_header)
             << table_row(cells_of(*study.together));
      if (!study.left_out.empty())
        text << '\n' << study.left_out << '\n';
      text << "\n*" << origin.program << ", " << origin.machine << ", "
           << origin.n_ranks << " MPI rank(s), " << origin.date << "*\n";
      return text.str();
    }



    nlohmann::ordered_json
    json_of(const EffectResult &result)
    {
      nlohmann::ordered_json json{{"effect", result.variant.effect},
                                  {"instead", result.variant.instead},
                                  {"overrides", result.variant.overrides},
                                  {"physical", result.variant.is_physical},
                                  {"verdict", to_string(result.verdict)},
                                  {"level", result.level},
                                  {"cells", result.cells},
                                  {"seconds_with", result.seconds_with},
                                  {"seconds_without", result.seconds_without},
                                  {"memory_with_MB", result.memory_with},
                                  {"memory_without_MB", result.memory_without},
                                  {"energy_distance", result.energy_distance},
                                  {"decisive", result.decisive.quantity},
                                  {"failure", result.failure},
                                  {"changes", nlohmann::json::object()}};
      for (const QuantityChange &quantity : result.changes)
        json["changes"][quantity.quantity] = {{"change", quantity.change},
                                              {"error", quantity.error}};
      return json;
    }



    std::string
    csv(const EffectsStudy &study)
    {
      std::ostringstream text;
      text << "effect,instead,physical,verdict,level,cells,quantity,change,"
              "error,energy_distance,seconds_with,seconds_without,"
              "memory_with_MB,memory_without_MB\n"
           << std::setprecision(12);
      for (const EffectResult &result : study.results)
        text << '"' << result.variant.effect << "\",\""
             << result.variant.instead << "\"," << result.variant.is_physical
             << ",\"" << to_string(result.verdict) << "\"," << result.level
             << ',' << result.cells << ',' << result.decisive.quantity << ','
             << result.decisive.change << ',' << result.decisive.error << ','
             << result.energy_distance << ',' << result.seconds_with << ','
             << result.seconds_without << ',' << result.memory_with << ','
             << result.memory_without << '\n';
      return text.str();
    }
  } // namespace



  std::string
  in_words(const EffectsStudy &study)
  {
    std::ostringstream text;
    const auto         add = [&text](const EffectResult &result) {
      text << "  " << result.variant.effect << ", instead "
           << result.variant.instead << ": " << to_string(result.verdict);
      if (!result.failure.empty())
        text << ": " << result.failure;
      else
        {
          if (result.verdict != EffectVerdict::never_acted)
            text << "; changes " << change_in_words(result) << " (error "
                 << percent(result.decisive.error) << ")";
          text << "; costs " << cost_in_words(result);
        }
      text << '\n';
    };
    for (const EffectResult &result : study.results)
      add(result);
    if (study.together)
      {
        text << "The two largest at once:\n";
        add(*study.together);
      }
    if (!study.left_out.empty())
      text << study.left_out << '\n';
    return text.str();
  }



  void
  write_effects(const EffectsStudy &study, const bool is_finished)
  {
    const Origin           origin  = Viscoplastic::origin();
    nlohmann::ordered_json results = nlohmann::ordered_json::array();
    for (const EffectResult &result : study.results)
      results.push_back(json_of(result));
    nlohmann::ordered_json json{
      {"scene", std::filesystem::path(study.scene.file).stem().string()},
      {"version", origin.program},
      {"ranks", origin.n_ranks},
      {"machine", origin.machine},
      {"date", origin.date},
      {"finished", is_finished},
      {"effects", results}};
    if (study.together)
      json["together"] = json_of(*study.together);
    make_results_directory(study.directory);
    replace_file(study.directory + "effects.csv", csv(study));
    replace_file(study.directory + "effects.json", json_text(json));
    replace_file(study.directory + "effects.md", markdown(study, origin));
  }
} // namespace Viscoplastic
