// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/json_text.h>
#include <viscoplastic_contact/results/run_record.h>
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



    std::string
    with_chance(const double value,
                const double chance,
                const char  *unit,
                const char  *between = " +- ")
    {
      return digits(value, 2) + between + digits(chance, 1) + unit;
    }



    /// What the scene pays for the effect, of the seconds that it takes.
    std::string
    share_of_time(const EffectResult &result, const char *between = " +- ")
    {
      const RunCost &with = result.with, &without = result.without;
      return with_chance(100. * (1. - without.seconds / with.seconds),
                         100. * (with.seconds_chance + without.seconds_chance) /
                           with.seconds,
                         " %",
                         between);
    }



    std::string
    seconds_of(const EffectResult &result)
    {
      return digits(result.with.seconds - result.without.seconds, 2) + " s";
    }



    std::string
    memory_of(const EffectResult &result)
    {
      const RunCost &with = result.with, &without = result.without;
      return with_chance(with.memory - without.memory,
                         with.memory_chance + without.memory_chance,
                         " MB");
    }



    /// Whether there is a change to tell of.
    bool
    has_changes(const EffectResult &result)
    {
      return result.failure.empty() &&
             result.verdict != EffectVerdict::never_acted &&
             result.verdict != EffectVerdict::only_watches;
    }



    const std::vector<std::string> effects_header{"effect",
                                                  "instead",
                                                  "verdict",
                                                  "changes most",
                                                  "by",
                                                  "error there",
                                                  "energy norm",
                                                  "time",
                                                  "",
                                                  "memory",
                                                  "cells"};



    std::vector<std::string>
    cells_of(const EffectResult &result)
    {
      std::vector<std::string> cells{result.variant.effect,
                                     result.variant.instead,
                                     to_string(result.verdict)};
      if (!result.failure.empty())
        cells.resize(effects_header.size(), "-");
      else
        {
          const bool tells = has_changes(result);
          for (const std::string &cell :
               {tells ? result.decisive.quantity : "nothing",
                tells ? percent(result.decisive.change) : "",
                tells ? percent(result.decisive.error) : "",
                percent(result.change_of("energy_norm")),
                share_of_time(result),
                seconds_of(result),
                memory_of(result),
                digits(result.cells, 9)})
            cells.push_back(cell);
        }
      return cells;
    }



    /// The words of a text in lines of at most @p width characters, where no
    /// word is longer.
    std::vector<std::string>
    lines_of(const std::string &text, const std::size_t width)
    {
      std::istringstream       words(text);
      std::vector<std::string> lines{""};
      std::string              word;
      while (words >> word)
        if (lines.back().empty())
          lines.back() = word;
        else if (lines.back().size() + 1 + word.size() <= width)
          lines.back() += ' ' + word;
        else
          lines.push_back("  " + word);
      return lines;
    }



    /// A row of the table for the console: of effect, verdict, quantity, its
    /// change and error, and the time.
    void
    print_cells(std::ostream &out, const std::vector<std::string> &cells)
    {
      constexpr std::size_t width = 34;
      const auto            first = lines_of(cells[0], width);
      out << "  " << std::left << std::setw(width) << first[0] << ' '
          << std::setw(13) << cells[1] << ' ' << std::setw(20) << cells[2]
          << std::right << ' ' << std::setw(7) << cells[3] << ' '
          << std::setw(7) << cells[4] << ' ' << std::setw(12) << cells[5]
          << '\n';
      for (std::size_t i = 1; i < first.size(); ++i)
        out << "  " << first[i] << '\n';
    }



    /// The verdict in a column of the console.
    std::string
    in_short(const EffectVerdict verdict)
    {
      switch (verdict)
        {
          case EffectVerdict::below_the_error:
            return "below error";
          case EffectVerdict::as_large_as_the_error:
            return "as the error";
          case EffectVerdict::cannot_be_left_out:
            return "is needed";
          default:
            return to_string(verdict);
        }
    }



    void
    print_row(std::ostream &out, const EffectResult &result)
    {
      const bool failed = !result.failure.empty(), tells = has_changes(result);
      print_cells(out,
                  {result.variant.effect + ": " + result.variant.instead,
                   in_short(result.verdict),
                   tells ? result.decisive.quantity : "",
                   tells ? percent(result.decisive.change) : "",
                   tells ? percent(result.decisive.error) : "",
                   failed ? "" : share_of_time(result, "+-")});
    }



    /// Whether two effects interact, in numbers.
    std::string
    in_words(const EffectInteraction &interaction)
    {
      const std::string &quantity = interaction.largest.quantity;
      std::ostringstream text;
      text << "Without " << interaction.first.variant.effect << " ("
           << interaction.first.variant.instead << ") " << quantity
           << " changes by " << percent(interaction.first.change_of(quantity))
           << ", without " << interaction.second.variant.effect << " ("
           << interaction.second.variant.instead << ") by "
           << percent(interaction.second.change_of(quantity))
           << ", without both by "
           << percent(interaction.joint.change_of(quantity))
           << ". This differs from the sum of both changes by up to "
           << percent(interaction.largest.change)
           << ", where the error of this quantity is "
           << percent(interaction.largest.error) << ": they "
           << (interaction.is_clear() ?
                 "interact." :
                 "add up, as far as this discretization can tell.");
      return text.str();
    }



    /// The name of a kind of effects, as a heading and in the files.
    std::string
    to_string(const EffectKind kind)
    {
      return kind == EffectKind::problem        ? "problem" :
             kind == EffectKind::discretization ? "discretization" :
                                                  "observation";
    }



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
              "difference to a run with twice the mesh width and time steps "
              "(in the energy norm: the error bar). Energy norm: of the "
              "difference of the displacements at the ends of the phases of "
              "time. Time and memory: what the scene takes less what it takes "
              "without the effect, +- the difference between two runs of the "
              "same.\n\n";
      if (std::filesystem::exists(study.directory + "effects.png"))
        text << "![What effects change and cost](effects.png)\n\n";
      const EffectResult *last = nullptr;
      for (const EffectResult &result : study.results)
        {
          if (last == nullptr || last->variant.kind != result.variant.kind)
            text << (last == nullptr ? "" : "\n") << "## Of the "
                 << to_string(result.variant.kind) << "\n\n"
                 << table_head(effects_header);
          text << table_row(cells_of(result));
          last = &result;
        }
      for (const EffectResult &result : study.results)
        if (!result.failure.empty())
          text << "\nWithout " << result.variant.effect << " ("
               << result.variant.instead << "): " << result.failure << '\n';
      if (study.interaction)
        text << "\n## The two largest at once\n\n"
             << in_words(*study.interaction) << '\n';
      if (!study.left_out.empty())
        text << '\n' << study.left_out << '\n';
      text << "\n*" << origin.program << ", " << origin.machine << ", "
           << origin.n_ranks << " MPI rank(s), " << origin.date << "*\n";
      return text.str();
    }



    nlohmann::ordered_json
    json_of(const RunCost &cost)
    {
      return {{"seconds", cost.seconds},
              {"seconds_chance", cost.seconds_chance},
              {"memory_MB", cost.memory},
              {"memory_chance_MB", cost.memory_chance}};
    }



    nlohmann::ordered_json
    json_of(const EffectResult &result)
    {
      nlohmann::ordered_json json{{"effect", result.variant.effect},
                                  {"instead", result.variant.instead},
                                  {"overrides", result.variant.overrides},
                                  {"kind", to_string(result.variant.kind)},
                                  {"verdict", to_string(result.verdict)},
                                  {"level", result.level},
                                  {"cells", result.cells},
                                  {"with", json_of(result.with)},
                                  {"without", json_of(result.without)},
                                  {"decisive", result.decisive.quantity},
                                  {"failure", result.failure},
                                  {"changes", nlohmann::json::object()}};
      for (const QuantityChange &quantity : result.changes)
        json["changes"][quantity.quantity] = {{"change", quantity.change},
                                              {"error", quantity.error}};
      return json;
    }



    nlohmann::ordered_json
    json_of(const EffectInteraction &interaction)
    {
      return {{"first", json_of(interaction.first)},
              {"second", json_of(interaction.second)},
              {"joint", json_of(interaction.joint)},
              {"quantity", interaction.largest.quantity},
              {"interaction", interaction.largest.change},
              {"error", interaction.largest.error},
              {"interact", interaction.is_clear()},
              {"words", in_words(interaction)}};
    }



    /// A row for each quantity of each simplification.
    std::string
    csv(const EffectsStudy &study)
    {
      std::ostringstream text;
      text << "effect,instead,kind,verdict,level,cells,quantity,change,error,"
              "seconds_with,seconds_without,memory_with_MB,memory_without_MB\n"
           << std::setprecision(12);
      for (const EffectResult &result : study.results)
        for (const QuantityChange &quantity : result.changes)
          text << '"' << result.variant.effect << "\",\""
               << result.variant.instead << "\","
               << to_string(result.variant.kind) << ",\""
               << to_string(result.verdict) << "\"," << result.level << ','
               << result.cells << ',' << quantity.quantity << ','
               << quantity.change << ',' << quantity.error << ','
               << result.with.seconds << ',' << result.without.seconds << ','
               << result.with.memory << ',' << result.without.memory << '\n';
      return text.str();
    }
  } // namespace



  std::string
  in_words(const EffectsStudy &study)
  {
    std::ostringstream text;
    print_cells(
      text, {"without: instead", "", "changes most", "by", "error", "costs"});
    for (const EffectResult &result : study.results)
      print_row(text, result);
    const auto add = [&text](const std::string &sentence) {
      for (const std::string &line : lines_of(sentence, 96))
        text << line << '\n';
    };
    for (const EffectResult &result : study.results)
      if (!result.failure.empty())
        add("Without " + result.variant.effect + " (" + result.variant.instead +
            "): " + result.failure);
    if (study.interaction)
      add(in_words(*study.interaction));
    if (!study.left_out.empty())
      add(study.left_out);
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
      {"left_out", study.left_out},
      {"effects", results}};
    if (study.interaction)
      json["interaction"] = json_of(*study.interaction);
    make_results_directory(study.directory);
    replace_file(study.directory + "effects.csv", csv(study));
    replace_file(study.directory + "effects.json", json_text(json));
    replace_file(study.directory + "effects.md", markdown(study, origin));
  }
} // namespace Viscoplastic
