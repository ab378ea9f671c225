// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/parameters/parameter_text.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;
  namespace fs = std::filesystem;

  namespace
  {
    // Limits that end recursive includes and reading from devices.
    const std::size_t  max_characters = 10'000'000;
    const unsigned int max_files      = 1000;
    const int          max_depth      = 50;



    /// Return the text of a file with blanks for tabs.
    std::string
    content(const std::string &file, const std::string &called)
    {
      std::error_code error;
      std::ifstream   input(file, std::ios::binary);
      std::string     text(max_characters, '\0');
      input.read(text.data(), static_cast<std::streamsize>(text.size()));
      text.resize(static_cast<std::size_t>(input.gcount()));
      const std::string fault =
        !fs::exists(file, error)        ? "does not exist" :
        fs::is_directory(file, error)   ? "is a directory" :
        input.bad() || !input.is_open() ? "cannot be read" :
        text.find('\0') != std::string::npos ?
                                          "is binary, not a parameter file" :
        input ? "is too long for a parameter file" :
                "";
      if (!fault.empty())
        refuse(called + " '" + excerpt(file, 200) + "' " + fault + '.');
      // Some editors begin a file with a byte order mark.
      if (text.compare(0, 3, "\xEF\xBB\xBF") == 0)
        text.erase(0, 3);
      std::replace(text.begin(), text.end(), '\t', ' ');
      return text;
    }



    /// Return `Boundary 3' for `Boundary 03'.
    std::string
    with_plain_id(const std::string &name, const std::string &origin)
    {
      const std::string kind = name.substr(0, name.find(' '));
      if (kind == name ||
          (kind != "Boundary" && kind != "Material" && kind != "Table"))
        return name;
      const std::string id = Utilities::trim(name.substr(kind.size()));
      if (!Patterns::Integer(0, largest_id).match(id))
        refuse(origin + ": '" + excerpt(id) + "' in the subsection '" +
               excerpt(name) +
               "' is no id; it must be a whole number from 0 to " +
               std::to_string(largest_id) + ".");
      return kind + ' ' + std::to_string(std::stoul(id));
    }



    /// A file or an assignment on the command line that is being read.
    struct Source
    {
      std::string                name;
      std::vector<ParameterLine> open;
      /// The line numbers of entries that have been set, by path.
      std::map<std::string, unsigned int> set;
    };



    struct Reader
    {
      std::vector<ParameterLine> lines;
      /// The open subsections, each followed by `/'.
      std::string section;
      /// Files that are being read, each included by the one before it.
      std::vector<fs::path> open_files;
      unsigned int          n_files = 0;

      /// Read a file; @p caller precedes its name in messages.
      void
      read_file(const std::string &file, const std::string &caller)
      {
        std::istringstream input(content(file, caller));
        std::error_code    error;
        open_files.push_back(fs::weakly_canonical(file, error));
        if (std::find(open_files.begin(),
                      open_files.end() - 1,
                      open_files.back()) != open_files.end() - 1)
          refuse(caller + " '" + file + "' includes itself.");
        if (++n_files > max_files)
          refuse(caller + " '" + file + "' is one of more than " +
                 std::to_string(max_files) + ".");
        read(input, file, 1);
        open_files.pop_back();
      }

      void
      read_assignment(const std::string &text)
      {
        const std::string where  = "--set '" + excerpt(text) + "'";
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos)
          refuse(where +
                 ": there is no `='; it must be 'Section/Entry=value'.");
        // Otherwise the record of the run could not be read again.
        AssertThrow(text.find_first_of("#\n\r") == std::string::npos &&
                      text.back() != '\\',
                    ExcMessage(
                      where +
                      ": a value cannot contain `#' or line breaks, nor end "
                      "with a backslash."));
        std::istringstream names(text.substr(0, equals) + '/');
        std::string        name, opening, assignment, closing;
        while (std::getline(names, name, '/'))
          {
            if (Utilities::trim(name).empty())
              refuse(where +
                     ": a name is empty; it must be 'Section/Entry=value'.");
            if (!assignment.empty())
              {
                opening += "subsection " + assignment + " #\n";
                closing += "end\n";
              }
            assignment = name;
          }
        std::istringstream input(opening + "set " + assignment +
                                 text.substr(equals) + '\n' + closing);
        read(input, where, 0);
      }

      /// Read lines, counted from @p first, or not counted if that is 0.
      void
      read(std::istream &input, const std::string &name, unsigned int first)
      {
        Source      source{name, {}, {}};
        std::string physical, logical;
        for (unsigned int next = first; std::getline(input, physical);)
          {
            next += first > 0 ? 1 : 0;
            physical             = Utilities::trim(physical);
            const bool continues = !physical.empty() && physical.back() == '\\';
            if (continues)
              physical.pop_back();
            logical += physical;
            if (continues && input.peek() != std::char_traits<char>::eof())
              continue;
            const std::string text =
              Utilities::trim(logical.substr(0, logical.find('#')));
            if (!text.empty())
              take({name, first, text, section}, source);
            first = next;
            logical.clear();
          }
        if (!source.open.empty())
          refuse(source.open.back().origin() + ": the subsection '" +
                 excerpt(source.open.back().name) + "' has no `end'.");
      }

      void
      take(ParameterLine line, Source &source)
      {
        const std::string word = line.text.substr(0, line.text.find(' '));
        const std::string rest = Utilities::trim(line.text.substr(word.size()));
        const std::size_t equals = rest.find('=');
        if ((word == "include" || word == "INCLUDE") && !rest.empty())
          return read_file(
            (fs::path(source.name).parent_path() / rest).string(),
            line.origin() + ": the included file");
        if ((word == "subsection" || word == "SUBSECTION") && !rest.empty())
          {
            if (std::count(section.begin(), section.end(), '/') >= max_depth)
              refuse(line.origin() + ": more than " +
                     std::to_string(max_depth) +
                     " subsections are inside each other; are there as many "
                     "lines `end' as lines `subsection'?");
            line.name =
              section.empty() ? with_plain_id(rest, line.origin()) : rest;
            line.text       = "subsection " + line.name;
            line.is_opening = true;
            section += line.name + '/';
            source.open.push_back(line);
          }
        else if (word == "end" || word == "END")
          {
            if (source.open.empty())
              refuse(
                line.origin() +
                ": there is no open subsection that this `end' could close.");
            section = source.open.back().section;
            source.open.pop_back();
          }
        else if ((word == "set" || word == "SET") &&
                 equals != std::string::npos)
          {
            line.name              = Utilities::trim(rest.substr(0, equals));
            line.value             = Utilities::trim(rest.substr(equals + 1));
            const std::string path = line.path();
            const auto [earlier, is_new] =
              source.set.emplace(path, line.number);
            if (!is_new)
              refuse("'" + excerpt(path) + "' is set twice in '" + source.name +
                     "', in lines " + std::to_string(earlier->second) +
                     " and " + std::to_string(line.number) +
                     "; keep one of them, or move one to a file of its own to "
                     "override the other.");
            // ParameterHandler takes braces for alternatives of several runs.
            if (line.value.find('{') != std::string::npos)
              refuse(line.origin() + ": '" + excerpt(path) + "' is '" +
                     excerpt(line.value) + "'; a value cannot contain `{'.");
          }
        lines.push_back(std::move(line));
      }
    };
  } // namespace



  std::string
  ParameterLine::locate(const std::string &file) const
  {
    const fs::path given(file);
    const fs::path beside =
      number == 0 ? given : fs::path(source).parent_path() / given;
    std::error_code error;
    const fs::path  found = fs::exists(beside, error) ? beside : given;
    if (!fs::exists(found, error))
      refuse(origin() + ": '" + path() + "' is '" + excerpt(value) +
             "', but there is no such file" +
             (value == file ? "" : " as '" + excerpt(file) + "'") +
             (beside == given ? "." :
                                ", neither beside '" + source +
                                  "' nor in the working directory."));
    return fs::absolute(found).lexically_normal().string();
  }



  const ParameterLine *
  last_line(const std::vector<ParameterLine> &lines, const std::string &path)
  {
    const auto line =
      std::find_if(lines.rbegin(), lines.rend(), [&path](const auto &one) {
        return !one.is_opening && one.path() == path;
      });
    return line == lines.rend() ? nullptr : &*line;
  }



  std::vector<ParameterLine>
  read_parameter_lines(const std::vector<std::string> &files,
                       const std::vector<std::string> &assignments)
  {
    Reader reader;
    for (const std::string &file : files)
      reader.read_file(file, "The parameter file");
    for (const std::string &text : assignments)
      reader.read_assignment(text);
    return std::move(reader.lines);
  }
} // namespace Viscoplastic
