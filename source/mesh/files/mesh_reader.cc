// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/files/mesh_reader.h>

#include <cctype>
#include <cmath>
#include <cstdlib>

namespace Viscoplastic
{
  namespace
  {
    bool
    is_space(const char c)
    {
      return std::isspace(static_cast<unsigned char>(c)) != 0;
    }
  } // namespace



  MeshReader::MeshReader(std::string text, const unsigned int dim)
    : dim(dim)
    , text(std::move(text))
  {}



  bool
  MeshReader::at_end()
  {
    for (; position < text.size() && is_space(text[position]); ++position)
      if (text[position] == '\n')
        ++line;
    return position == text.size();
  }



  std::string
  MeshReader::word(const std::string &what)
  {
    if (at_end())
      fail("the file ends where " + what + " should be");
    const std::size_t begin = position;
    while (position < text.size() && !is_space(text[position]))
      ++position;
    return text.substr(begin, position - begin);
  }



  long
  MeshReader::integer(const std::string &what)
  {
    // Above all ids and node numbers in use; differences cannot overflow.
    constexpr long    largest = 1000000000000;
    const std::string text    = word(what);
    char             *end     = nullptr;
    // Out of range, strtol() returns one end of the range.
    const long value = std::strtol(text.c_str(), &end, 10);
    if (*end != '\0' || value < -largest || value > largest)
      fail("expected " + what + ", found " + quoted(text));
    return value;
  }



  double
  MeshReader::number(const std::string &what)
  {
    const std::string text  = word(what);
    char             *end   = nullptr;
    const double      value = std::strtod(text.c_str(), &end);
    if (*end != '\0' || !std::isfinite(value))
      fail("expected " + what + ", found " + quoted(text));
    return value;
  }



  unsigned long
  MeshReader::count(const std::string &what)
  {
    const long value = integer(what);
    if (value < 0 || static_cast<unsigned long>(value) > text.size() - position)
      fail(what + " is " + std::to_string(value) +
           ", which the rest of the file cannot hold");
    return value;
  }



  void
  MeshReader::add_element(const Shape             &shape,
                          const long               id,
                          const std::vector<long> &node_numbers)
  {
    const unsigned int dimension = shape.dimension;
    if (shape.order > 1)
      fail("this element is a " + shape.name + " of " +
           (shape.order == 2 ? "second" : "third") +
           " order, with nodes between its corners; make the mesh of first "
           "order (in Gmsh, set Mesh.ElementOrder = 1)");
    if (shape.n_nodes != 1u << dimension)
      fail("this element is a " + shape.name +
           "; only quadrilaterals and hexahedra with nodes at their corners "
           "are supported (in Gmsh, set Mesh.RecombineAll = 1 and "
           "Mesh.SubdivisionAlgorithm = 1, in 3D 2)");
    has_dimension[dimension] = true;
    if (dimension + 1 < dim || dimension > dim)
      return;
    if (id < 0 || id > largest_id)
      fail("the id " + std::to_string(id) + " is not between 0 and " +
           std::to_string(largest_id));

    MeshFile::Element element;
    element.id   = id;
    element.line = line;
    for (std::size_t n = 0; n < node_numbers.size(); ++n)
      {
        const auto index = node_indices.find(node_numbers[n]);
        if (index == node_indices.end())
          fail("there is no node " + std::to_string(node_numbers[n]));
        element.nodes[n] = index->second;
      }
    (dimension == dim ? mesh.cells : mesh.faces).push_back(element);
  }



  const MeshReader::Shape &
  MeshReader::shape(const std::map<std::string, Shape> &shapes)
  {
    const std::string type  = word("a type of elements");
    const auto        found = shapes.find(type);
    if (found == shapes.end())
      fail("elements of type " + quoted(type) + " are not supported");
    return found->second;
  }
} // namespace Viscoplastic
