// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/parameters/parameter_text.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    // Nobody writes more by hand; these end recursions and devices.
    const std::size_t  max_characters = 10'000'000;
    const unsigned int max_files      = 1000;
    const unsigned int max_depth      = 50;



    std::string
    position(const std::string &file, const unsigned int line)
    {
      return "'" + file + "', line " + std::to_string(line);
    }



    /// `Boundary  03' as `Boundary 3'.
    std::string
    without_leading_zeros(const std::string &name)
    {
      const std::size_t last = name.find_last_not_of("0123456789");
      if (last == std::string::npos || last + 1 == name.size() ||
          name[last] != ' ')
        return name;
      const std::size_t first =
        std::min(name.find_first_not_of('0', last + 1), name.size() - 1);
      return Utilities::trim(name.substr(0, last)) + ' ' + name.substr(first);
    }



    /// If the line begins with the keyword and a blank, what follows.
    bool
    begins_with(const std::string &line,
                const std::string &keyword,
                std::string       &rest)
    {
      const std::string word = line.substr(0, line.find(' '));
      std::string       upper(keyword);
      std::transform(upper.begin(), upper.end(), upper.begin(), [](char c) {
        return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      });
      if (word != keyword && word != upper)
        return false;
      rest = Utilities::trim(line.substr(word.size()));
      return true;
    }



    class Reader
    {
    public:
      std::vector<ParameterStatement> statements;

      /// @p shown is how messages call the file.
      void
      read(const std::string &shown, const std::string &includer);

    private:
      using Section = ParameterStatement::Section;

      std::string
      content(const std::string &file, const std::string &includer) const;

      /// Files that are being read, each included by the one before it.
      std::vector<std::filesystem::path> open_files;
      std::vector<Section>               sections;
      unsigned int                       n_files = 0;
    };



    std::string
    Reader::content(const std::string &file, const std::string &includer) const
    {
      const std::string name =
        (includer.empty() ? "The parameter file '" :
                            includer + ": the included file '") +
        excerpt(file, 200) + "' ";
      std::error_code error;
      AssertThrow(std::filesystem::exists(file, error),
                  ExcMessage(name + "does not exist."));
      AssertThrow(!std::filesystem::is_directory(file, error),
                  ExcMessage(name + "is a directory."));
      std::ifstream input(file, std::ios::binary);
      AssertThrow(input,
                  ExcMessage(name + "cannot be opened; is it readable?"));
      std::string text(max_characters + 1, '\0');
      input.read(text.data(), static_cast<std::streamsize>(text.size()));
      AssertThrow(!input.bad(), ExcMessage(name + "cannot be read."));
      text.resize(static_cast<std::size_t>(input.gcount()));
      AssertThrow(text.size() <= max_characters,
                  ExcMessage(name + "is too long for a parameter file."));
      AssertThrow(text.find('\0') == std::string::npos,
                  ExcMessage(name + "is binary, not a parameter file."));
      // Some editors begin a file with a byte order mark.
      if (text.compare(0, 3, "\xEF\xBB\xBF") == 0)
        text.erase(0, 3);
      std::replace(text.begin(), text.end(), '\t', ' ');
      text.shrink_to_fit();
      return text;
    }



    void
    Reader::read(const std::string &file, const std::string &includer)
    {
      std::istringstream input(content(file, includer));

      std::error_code             error;
      const std::filesystem::path canonical =
        std::filesystem::weakly_canonical(file, error);
      AssertThrow(std::find(open_files.begin(), open_files.end(), canonical) ==
                    open_files.end(),
                  ExcMessage(includer + ": the file '" + file +
                             "' includes itself."));
      AssertThrow(++n_files <= max_files,
                  ExcMessage(includer + ": more than " +
                             std::to_string(max_files) +
                             " files are included."));
      open_files.push_back(canonical);

      const std::size_t                   n_outer_sections = sections.size();
      std::map<std::string, unsigned int> lines; // by entry
      std::string                         physical, line, rest;
      unsigned int                        number = 0, first_number = 1;
      while (std::getline(input, physical))
        {
          ++number;
          physical             = Utilities::trim(physical);
          const bool continues = !physical.empty() && physical.back() == '\\';
          if (continues)
            physical.pop_back();
          line += physical;
          if (continues &&
              input.peek() != std::istringstream::traits_type::eof())
            continue;
          const std::string statement =
            Utilities::trim(line.substr(0, line.find('#')));
          const std::string where = position(file, first_number);
          line.clear();

          if (statement.empty())
            {}
          else if (begins_with(statement, "subsection", rest))
            {
              AssertThrow(!rest.empty(),
                          ExcMessage(where +
                                     ": `subsection' needs a name after it."));
              AssertThrow(sections.size() < max_depth,
                          ExcMessage(where + ": more than " +
                                     std::to_string(max_depth) +
                                     " subsections are inside each other; are "
                                     "there as many lines `end' as lines "
                                     "`subsection'?"));
              sections.push_back({without_leading_zeros(rest), first_number});
              statements.push_back({file, first_number, sections, "", ""});
            }
          else if (begins_with(statement, "end", rest))
            {
              AssertThrow(rest.empty(),
                          ExcMessage(where +
                                     ": `end' stands alone on its "
                                     "line, but '" +
                                     excerpt(rest) + "' follows."));
              AssertThrow(sections.size() > n_outer_sections,
                          ExcMessage(where + ": there is no open subsection "
                                             "that this `end' could close."));
              sections.pop_back();
            }
          else if (begins_with(statement, "set", rest))
            {
              const std::size_t equals = rest.find('=');
              AssertThrow(equals != std::string::npos,
                          ExcMessage(where + ": '" + excerpt(statement) +
                                     "' has no `='; it must be `set Entry = "
                                     "value'."));
              ParameterStatement set{file,
                                     first_number,
                                     sections,
                                     Utilities::trim(rest.substr(0, equals)),
                                     Utilities::trim(rest.substr(equals + 1))};
              AssertThrow(!set.entry.empty(),
                          ExcMessage(where + ": '" + excerpt(statement) +
                                     "' has no name before `='; it must be "
                                     "`set Entry = value'."));
              const auto [earlier, is_new] =
                lines.emplace(set.path(), first_number);
              AssertThrow(is_new,
                          ExcMessage("'" + excerpt(set.path()) +
                                     "' is set twice in '" + file +
                                     "', in lines " +
                                     std::to_string(earlier->second) + " and " +
                                     std::to_string(first_number) +
                                     "; keep one of them, or move one to a "
                                     "file of its own to override the other."));
              statements.push_back(std::move(set));
            }
          else if (begins_with(statement, "include", rest))
            {
              AssertThrow(!rest.empty(),
                          ExcMessage(where +
                                     ": `include' needs a file after it."));
              std::filesystem::path included(rest);
              if (included.is_relative())
                included = std::filesystem::path(file).parent_path() / included;
              read(included.string(), where);
            }
          else
            AssertThrow(false,
                        ExcMessage(where + ": '" + excerpt(statement) +
                                   "' is no statement; a line is `set Entry = "
                                   "value', `subsection Name', `end', "
                                   "`include file', or a comment after `#'."));
          first_number = number + 1;
        }
      AssertThrow(
        sections.size() == n_outer_sections,
        ExcMessage(position(file, sections.back().line) + ": the subsection '" +
                   excerpt(sections.back().name) + "' has no `end'."));
      open_files.pop_back();
    }
  } // namespace



  std::string
  ParameterStatement::path() const
  {
    std::string result;
    for (const Section &section : sections)
      result += section.name + '/';
    if (entry.empty())
      result.pop_back();
    return result + entry;
  }



  std::string
  ParameterStatement::origin() const
  {
    if (file.empty())
      return "--set '" + excerpt(path() + '=' + value) + "'";
    return position(file, line);
  }



  std::vector<ParameterStatement>
  read_parameter_text(const std::string &file)
  {
    Reader reader;
    reader.read(file, "");
    return std::move(reader.statements);
  }



  ParameterStatement
  read_override(const std::string &text)
  {
    const std::string where  = "--set '" + excerpt(text) + "': ";
    const std::size_t equals = text.find('=');
    AssertThrow(equals != std::string::npos,
                ExcMessage(where + "there is no `='; it must be "
                                   "'Section/Entry=value'."));
    ParameterStatement statement;
    statement.value = Utilities::trim(text.substr(equals + 1));
    // The record of the run must be readable again.
    AssertThrow(statement.value.find_first_of("#\n\r") == std::string::npos &&
                  (statement.value.empty() || statement.value.back() != '\\'),
                ExcMessage(where + "a value cannot contain `#' or line breaks, "
                                   "nor end with a backslash."));
    std::string path = text.substr(0, equals);
    for (std::size_t slash = path.find('/'); slash != std::string::npos;
         slash             = path.find('/'))
      {
                    statement.sections.push_back(
          {without_leading_zeros(Utilities::trim(path.substr(0, slash))), 0});
                    path.erase(0, slash + 1);
      }
    statement.entry  = Utilities::trim(path);
    bool is_complete = !statement.entry.empty();
    for (const auto &section : statement.sections)
      is_complete = is_complete && !section.name.empty();
    AssertThrow(is_complete,
                ExcMessage(where + "a name is empty; it must be "
                                   "'Section/Entry=value'."));
    return statement;
  }
} // namespace Viscoplastic
