// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/mesh/files/mesh_reader.h>

#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    const std::map<std::string, MeshReader::Shape> vtk_shapes{
      {"1", {"point", 0, 1}},
      {"3", {"line", 1, 2}},
      {"5", {"triangle", 2, 3}},
      {"8", {"pixel", 2, 4}},
      {"9", {"quadrilateral", 2, 4}},
      {"10", {"tetrahedron", 3, 4}},
      {"11", {"voxel", 3, 8}},
      {"12", {"hexahedron", 3, 8}},
      {"13", {"wedge", 3, 6}},
      {"14", {"pyramid", 3, 5}},
      {"21", {"line of second order", 1, 3}},
      {"22", {"triangle of second order", 2, 6}},
      {"23", {"quadrilateral of second order", 2, 8}},
      {"24", {"tetrahedron of second order", 3, 10}},
      {"25", {"hexahedron of second order", 3, 20}},
      {"28", {"quadrilateral of second order", 2, 9}},
      {"29", {"hexahedron of second order", 3, 27}}};

    /// Names of the data that hold ids, the best last.
    const std::vector<std::string> id_names{
      "CellEntityIds", // Gmsh's, numbers of its entities
      "gmsh:physical", // meshio's
      "MaterialID"};   // deal.II's



    struct Cell
    {
      std::vector<long> nodes;
      unsigned int      line;
    };



    std::vector<Cell>
    read_cells(MeshReader &reader)
    {
      const unsigned long n    = reader.count("the number of cells");
      const unsigned long m    = reader.count("the size of the list of cells");
      const std::string   what = "the number of nodes of a cell";
      std::vector<Cell>   cells;
      std::string         first = n > 0 ? reader.word(what) : "";
      if (first != "OFFSETS")
        {
          for (unsigned long c = 0; c < n; ++c)
            {
              const long n_nodes =
                c == 0 ? reader.to_integer(first, what) : reader.count(what);
              if (n_nodes < 0 || static_cast<unsigned long>(n_nodes) > m)
                reader.fail("a cell cannot have " + std::to_string(n_nodes) +
                            " nodes");
              const unsigned int line = reader.line;
              cells.push_back({reader.node_numbers(n_nodes), line});
            }
          return cells;
        }
      // Since version 5, what is called their number is that of the offsets.
      reader.word("a type of numbers");
      std::vector<unsigned long> offsets(n);
      for (unsigned long &offset : offsets)
        offset = reader.count("an offset");
      reader.expect("CONNECTIVITY");
      reader.word("a type of numbers");
      for (unsigned long c = 0; c + 1 < n; ++c)
        {
          if (offsets[0] != 0 || offsets[c + 1] < offsets[c] ||
              offsets[c + 1] > m)
            reader.fail("the offsets of the cells are not in order");
          const auto nodes = reader.node_numbers(offsets[c + 1] - offsets[c]);
          cells.push_back({nodes, reader.line});
        }
      return cells;
    }
  } // namespace



  void
  read_vtk(MeshReader &reader)
  {
    for (const char *word : {"#", "vtk", "DataFile", "Version"})
      reader.expect(word);
    reader.number("the version");
    std::string title;
    reader.next_line(title);
    const std::string encoding = reader.word("ASCII");
    if (encoding != "ASCII")
      reader.fail(encoding == "BINARY" ?
                    "it is binary; only text (ASCII) is supported" :
                    "expected ASCII, found " + MeshReader::quoted(encoding));
    reader.expect("DATASET");
    reader.expect("UNSTRUCTURED_GRID");

    std::vector<Cell>                      cells;
    std::vector<const MeshReader::Shape *> shapes;
    std::vector<std::string>               types;
    std::vector<long>                      ids;
    std::size_t                            rank_of_ids  = 0;
    bool                                   in_cell_data = false;

    // The ids from the data of that name, unless there are better ones.
    const auto read_data = [&](const std::string  &name,
                               const unsigned long n_values) {
      std::size_t rank = 0;
      for (std::size_t i = 0; i < id_names.size(); ++i)
        if (name == id_names[i])
          rank = i + 1;
      const bool wanted = in_cell_data && rank > rank_of_ids;
      if (wanted && n_values != cells.size())
        reader.fail("the data " + name + " have " + std::to_string(n_values) +
                    " values for " + std::to_string(cells.size()) + " cells");
      if (wanted)
        {
          rank_of_ids = rank;
          ids.clear();
        }
      for (unsigned long i = 0; i < n_values; ++i)
        if (wanted)
          ids.push_back(reader.integer("an id"));
        else
          reader.word("a value");
    };

    // Words that we have no use for are skipped.
    while (!reader.at_end())
      {
        const std::string keyword = reader.word("a keyword");
        if (keyword == "POINTS")
          {
            const unsigned long n = reader.count("the number of points");
            reader.word("a type of numbers");
            for (unsigned long i = 0; i < n; ++i)
              reader.add_node(i, reader.coordinates());
          }
        else if (keyword == "CELLS")
          cells = read_cells(reader);
        else if (keyword == "CELL_TYPES")
          {
            const unsigned long n = reader.count("the number of cells");
            for (unsigned long i = 0; i < n; ++i)
              {
                shapes.push_back(&reader.shape(vtk_shapes));
              }
          }
        else if (keyword == "CELL_DATA" || keyword == "POINT_DATA")
          in_cell_data = keyword == "CELL_DATA";
        else if (keyword == "SCALARS" && in_cell_data)
          {
            const std::string name = reader.word("a name");
            const std::string type = reader.rest_of_line();
            reader.expect("LOOKUP_TABLE");
            reader.word("a name");
            // The number of components is 1 where not given.
            const auto blank = type.find_last_of(" \t");
            read_data(name,
                      cells.size() *
                        (blank == std::string::npos ?
                           1 :
                           reader.to_integer(type.substr(blank + 1),
                                             "a number of components")));
          }
        else if (keyword == "FIELD")
          {
            reader.word("a name");
            const unsigned long n = reader.count("the number of arrays");
            for (unsigned long i = 0; i < n; ++i)
              {
                const std::string   name = reader.word("a name");
                const unsigned long n_components =
                  reader.count("the number of components");
                const unsigned long n_tuples =
                  reader.count("the number of tuples");
                reader.word("a type of numbers");
                read_data(name, n_components * n_tuples);
              }
          }
      }

    if (shapes.size() != cells.size())
      reader.fail("there are " + std::to_string(cells.size()) +
                  " cells, but types of " + std::to_string(shapes.size()));
    for (std::size_t c = 0; c < cells.size(); ++c)
      {
        reader.line = cells[c].line;
        if (cells[c].nodes.size() != shapes[c]->n_nodes)
          reader.fail("a " + shapes[c]->name + " cannot have " +
                      std::to_string(cells[c].nodes.size()) + " nodes");
        // These are in lexicographic order.
        if (shapes[c]->name == "pixel" || shapes[c]->name == "voxel")
          for (std::size_t n = 2; n < shapes[c]->n_nodes; n += 4)
            std::swap(cells[c].nodes[n], cells[c].nodes[n + 1]);
        reader.add_element(*shapes[c],
                           ids.empty() ? 0 : ids[c],
                           cells[c].nodes);
      }
  }
} // namespace Viscoplastic
