// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/mesh/files/mesh_reader.h>

namespace Viscoplastic
{
  void
  read_ucd(MeshReader &reader)
  {
    static const std::map<std::string, MeshReader::Shape> shapes{
      {"pt", {"point", 0, 1}},
      {"line", {"line", 1, 2}},
      {"tri", {"triangle", 2, 3}},
      {"quad", {"quadrilateral", 2, 4}},
      {"tet", {"tetrahedron", 3, 4}},
      {"pyr", {"pyramid", 3, 5}},
      {"prism", {"prism", 3, 6}},
      {"hex", {"hexahedron", 3, 8}}};

    const std::string what  = "the number of nodes";
    std::string       first = reader.word(what);
    while (first[0] == '#')
      {
        reader.rest_of_line();
        first = reader.word(what);
      }
    const long          n_nodes = reader.to_integer(first, what);
    const unsigned long n_cells = reader.count("the number of cells");
    for (unsigned int i = 0; i < 3; ++i)
      reader.integer("a number of data");
    for (long i = 0; i < n_nodes; ++i)
      {
        const long number = reader.integer("the number of a node");
        reader.add_node(number, reader.coordinates());
      }
    for (unsigned long i = 0; i < n_cells; ++i)
      {
        reader.integer("the number of a cell");
        const long               id = reader.integer("the material of a cell");
        const MeshReader::Shape &type = reader.shape(shapes);
        reader.add_element(type, id, reader.node_numbers(type.n_nodes));
      }
    // What follows are data, which are not ours.
  }
} // namespace Viscoplastic
