// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/mesh/files/mesh_reader.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <unordered_set>

namespace Viscoplastic
{
  namespace
  {
    /// A line that begins with a star: `*ELEMENT, TYPE=CPS4, ELSET=SOFT'.
    struct Keyword
    {
      std::string                        name;
      std::map<std::string, std::string> parameters;

      std::string
      operator[](const std::string &parameter) const
      {
        const auto found = parameters.find(parameter);
        return found == parameters.end() ? "" : found->second;
      }
    };



    Keyword
    parse_keyword(const std::string &line)
    {
      Keyword result;
      for (const std::string &part :
           Utilities::split_string_list(line.substr(1), ','))
        {
          const std::size_t equals = part.find('=');
          if (result.name.empty())
            result.name = part;
          else if (equals == std::string::npos)
            result.parameters[part];
          else
            result.parameters[Utilities::trim(part.substr(0, equals))] =
              Utilities::trim(part.substr(equals + 1));
        }
      return result;
    }



    /// The number at the end of a name.
    std::optional<long>
    number_of(const std::string &name)
    {
      const std::size_t last  = name.find_last_not_of("0123456789");
      const std::size_t begin = last == std::string::npos ? 0 : last + 1;
      if (begin == name.size() || name.size() - begin > 9)
        return {};
      return std::stol(name.substr(begin));
    }



    /// What a set consists of, as the file says it: copies of the elements of
    /// sets in sets may need far more memory than the file.
    struct ElementSet
    {
      struct Range
      {
        long first, last, step;
      };

      void
      add(const long number)
      {
        if (!ranges.empty() && ranges.back().step == 1 &&
            ranges.back().last + 1 == number)
          ++ranges.back().last;
        else
          ranges.push_back({number, number, 1});
      }

      std::vector<Range>       ranges;
      std::vector<std::string> sets;
    };



    /// Elements, by number or by name of a set, that get an id: themselves, or
    /// one of their faces.
    struct Selection
    {
      std::string  elements;
      long         id;
      unsigned int line;
      std::size_t  face = numbers::invalid_unsigned_int;
    };



    /// The elements of the file and what it says about them later.
    class Model
    {
    public:
      Model(MeshReader &reader)
        : reader(reader)
      {}

      void
      begin(const Keyword &keyword)
      {
        if (!pending.empty())
          reader.fail("the element before ends with a comma");
        if (keyword.name == "ASSEMBLY")
          in_assembly = true;
        const auto material = number_of(keyword["MATERIAL"]);
        if (keyword.name == "SOLID SECTION" && material)
          sections.push_back({keyword["ELSET"], *material, reader.line});
        // Names that begin with _ are ABAQUS's own.
        const std::string name   = keyword["ELSET"];
        const auto        number = number_of(name);
        if (keyword.name == "ELSET" && number && name[0] != '_')
          numbered_sets.push_back({name, *number, reader.line});
      }

      void
      data(const Keyword &keyword, const std::string &line)
      {
        // Without what follows a comma at the end.
        const std::vector<std::string> fields =
          Utilities::split_string_list(line, ',');
        // Those of an assembly are points of reference.
        if (keyword.name == "NODE" && !in_assembly)
          add_node(fields);
        else if (keyword.name == "ELEMENT" && !in_assembly)
          {
            pending.insert(pending.end(), fields.begin(), fields.end());
            if (line.back() != ',') // else it goes on in the next line
              add_element(keyword);
          }
        else if (keyword.name == "ELSET")
          add_to_set(keyword, fields);
        else if (keyword.name == "SURFACE" && keyword["TYPE"] != "NODE")
          add_to_surface(keyword, fields);
        else if (keyword.name == "INSTANCE")
          reader.fail("an instance that is moved is not supported");
      }

      /// When all is known: the ids.
      void
      finish()
      {
        if (!pending.empty())
          reader.fail("the file ends within an element");
        if (reader.mesh.cells.empty()) // a mesh of another dimension
          return;
        // Sections, which are meant to say it, come last.
        for (const auto *selections : {&numbered_sets, &sections})
          for (const Selection &selection : *selections)
            for (const long number : elements_of(selection))
              if (MeshFile::Element *element = find(number))
                element->id = selection.id;
        for (const Selection &selection : surfaces)
          for (const long number : elements_of(selection))
            {
              const auto faces = faces_of_cell(reader.dim);
              const auto found = cells.find(number);
              if (found == cells.end())
                reader.fail("the element " + std::to_string(number) +
                            " of a surface is no cell");
              if (selection.face >= faces.size())
                reader.fail("a cell has no face " +
                            std::to_string(selection.face + 1));
              MeshFile::Element face;
              for (std::size_t n = 0; n < faces[selection.face].size(); ++n)
                face.nodes[n] = reader.mesh.cells[found->second]
                                  .nodes[faces[selection.face][n]];
              face.id   = selection.id;
              face.line = selection.line;
              reader.mesh.faces.push_back(face);
            }
      }

    private:
      void
      add_node(const std::vector<std::string> &fields)
      {
        Point<3> x;
        if (fields.size() < 3 || fields.size() > 4)
          reader.fail("expected the number of a node and its coordinates");
        for (std::size_t d = 0; d + 1 < fields.size(); ++d)
          x[d] = reader.to_number(fields[d + 1], "a coordinate");
        reader.add_node(reader.to_integer(fields[0], "the number of a node"),
                        x);
      }

      void
      add_element(const Keyword &keyword)
      {
        std::vector<long> nodes;
        for (const std::string &field : pending)
          nodes.push_back(
            reader.to_integer(field, "the number of an element or node"));
        pending.clear();
        const long number = nodes[0];
        nodes.erase(nodes.begin());

        // The number of nodes tells shapes apart, except in solids.
        const std::string type = keyword["TYPE"];
        MeshReader::Shape shape{type,
                                2,
                                static_cast<unsigned int>(nodes.size())};
        if (type.find("AX") != std::string::npos)
          reader.fail("this element is a " + type +
                      ", which is axisymmetric; bodies in 2D are in plane "
                      "strain");
        if (type.find("C3D") != std::string::npos)
          shape.dimension = 3;
        else if (nodes.size() <= 2)
          shape.dimension = nodes.size() == 2 ? 1 : 0;
        const auto n_cells = reader.mesh.cells.size(),
                   n_faces = reader.mesh.faces.size();
        reader.add_element(shape,
                           number_of(keyword["ELSET"]).value_or(0),
                           nodes);
        if (reader.mesh.cells.size() > n_cells)
          cells[number] = n_cells;
        else if (reader.mesh.faces.size() > n_faces)
          faces[number] = n_faces;
        if (!numbers.insert(number).second)
          reader.fail("the element " + std::to_string(number) +
                      " is there twice");
        if (!keyword["ELSET"].empty())
          sets[keyword["ELSET"]].add(number);
      }

      void
      add_to_set(const Keyword &keyword, const std::vector<std::string> &fields)
      {
        const std::string name = keyword["ELSET"];
        ElementSet       &set  = sets[name];
        if (keyword.parameters.count("GENERATE") == 0)
          {
            for (const std::string &field : fields)
              {
                const std::string other = without_instance(field);
                if (other == name)
                  reader.fail("the set " + MeshReader::quoted(name) +
                              " contains itself");
                if (sets.count(other) == 1)
                  set.sets.push_back(other);
                else
                  set.add(element_number(other));
              }
            return;
          }
        if (fields.size() < 2 || fields.size() > 3)
          reader.fail("expected the first and last element of a set");
        const long first = reader.to_integer(fields[0], "an element"),
                   last  = reader.to_integer(fields[1], "an element"),
                   step  = fields.size() == 2 ?
                             1 :
                             reader.to_integer(fields[2], "a step");
        if (step < 1 || last < first ||
            static_cast<std::size_t>((last - first) / step) >= numbers.size())
          reader.fail("this range of elements is not in the mesh");
        set.ranges.push_back({first, last, step});
      }

      void
      add_to_surface(const Keyword                  &keyword,
                     const std::vector<std::string> &fields)
      {
        const auto id = number_of(keyword["NAME"]);
        if (!id) // used for something else
          return;
        // Faces are S1, S2, ...; Cubit calls those of 2D cells E1, E2, ...
        if (fields.size() != 2 || fields[1].size() != 2 ||
            (fields[1][0] != 'S' && fields[1][0] != 'E') ||
            fields[1][1] < '1' || fields[1][1] > '6')
          reader.fail("expected elements and one of their faces S1, S2, ...");
        surfaces.push_back({fields[0],
                            *id,
                            reader.line,
                            static_cast<std::size_t>(fields[1][1] - '1')});
      }

      /// Within an assembly, the name of an instance may come before a dot.
      static std::string
      without_instance(const std::string &name)
      {
        return name.substr(name.rfind('.') + 1);
      }

      long
      element_number(const std::string &word) const
      {
        const long number = reader.to_integer(word, "an element or set");
        if (numbers.count(number) == 0)
          reader.fail("there is no element " + std::to_string(number));
        return number;
      }

      /// Each once.
      std::set<long>
      elements_of(const Selection &selection) const
      {
        const std::string name = without_instance(selection.elements);
        reader.line            = selection.line;
        if (sets.count(name) == 0)
          return {element_number(name)};
        std::set<long>           result;
        std::set<std::string>    found{name};
        std::vector<std::string> open{name};
        while (!open.empty())
          {
            const ElementSet &set = sets.at(open.back());
            open.pop_back();
            for (const ElementSet::Range &range : set.ranges)
              for (long n = range.first; n <= range.last; n += range.step)
                result.insert(result.end(), n);
            for (const std::string &other : set.sets)
              if (found.insert(other).second)
                open.push_back(other);
          }
        return result;
      }

      /// The cell or face; null for other elements.
      MeshFile::Element *
      find(const long number)
      {
        if (const auto cell = cells.find(number); cell != cells.end())
          return &reader.mesh.cells[cell->second];
        if (const auto face = faces.find(number); face != faces.end())
          return &reader.mesh.faces[face->second];
        return nullptr;
      }

      MeshReader                           &reader;
      bool                                  in_assembly = false;
      std::vector<std::string>              pending;
      std::unordered_set<long>              numbers;
      std::unordered_map<long, std::size_t> cells, faces;
      std::map<std::string, ElementSet>     sets;
      std::vector<Selection>                numbered_sets, sections, surfaces;
    };
  } // namespace



  void
  read_abaqus(MeshReader &reader)
  {
    Model   model(reader);
    Keyword keyword;
    for (std::string line = reader.rest_of_line();;)
      {
        // Names do not distinguish between lower and upper case.
        std::transform(line.begin(), line.end(), line.begin(), ::toupper);
        line.erase(std::remove(line.begin(), line.end(), '"'), line.end());
        const bool is_comment = line.empty() || line.compare(0, 2, "**") == 0;
        if (!is_comment && line[0] == '*')
          model.begin(keyword = parse_keyword(line));
        else if (!is_comment)
          model.data(keyword, line);
        if (!reader.next_line(line))
          break;
      }
    model.finish();
  }
} // namespace Viscoplastic
