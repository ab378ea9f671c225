// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/files/mesh_file.h>

#include <map>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace Viscoplastic
{
  /// Reads the text of a mesh file word by word and builds the mesh. All errors
  /// are std::runtime_error with a message that begins with the line.
  class MeshReader
  {
  public:
    /// A type of elements that a file may have.
    struct Shape
    {
      std::string  name;
      unsigned int dimension, n_nodes;
      /// The polynomial degree; 1 if all nodes are corners.
      unsigned int order = 1;
    };


    MeshReader(std::string text, const unsigned int dim);

    // The text

    /// Skip white space, and return whether the end of the file is reached.
    bool
    at_end();

    /// Return the next word. If there is none, the message says that @p what is
    /// missing; the same holds for the functions below.
    std::string
    word(const std::string &what);

    /// Read the next word, which must be this one.
    void
    expect(const std::string &keyword)
    {
      const std::string found = word(keyword);
      if (found != keyword)
        fail("expected " + keyword + ", found " + quoted(found));
    }

    /// Read a whole number of magnitude 1e12 at most.
    long
    integer(const std::string &what);

    /// Read a finite number.
    double
    number(const std::string &what);

    /// Read the number of items that follow and refuse more than the rest of
    /// the file could hold.
    unsigned long
    count(const std::string &what);

    /// Read a type of elements, one of the keys of @p shapes.
    const Shape &
    shape(const std::map<std::string, Shape> &shapes);

    std::vector<long>
    node_numbers(const unsigned int n)
    {
      std::vector<long> result(n);
      for (long &number : result)
        number = integer("the number of a node");
      return result;
    }

    Point<3>
    coordinates()
    {
      Point<3> x;
      for (unsigned int d = 0; d < 3; ++d)
        x[d] = number("a coordinate");
      return x;
    }

    /// Throw the message, with the current line in front.
    [[noreturn]] void
    fail(const std::string &message) const
    {
      throw std::runtime_error("line " + std::to_string(line) + ": " + message);
    }

    /// Return a word of the file as a message can show it.
    static std::string
    quoted(const std::string &word)
    {
      return "'" + excerpt(word, 40) + "'";
    }

    // The mesh

    /// Add a node; its number must be new.
    void
    add_node(const long number, const Point<3> &x)
    {
      if (!node_indices.emplace(number, mesh.nodes.size()).second)
        fail("the node " + std::to_string(number) + " is there twice");
      mesh.nodes.push_back(x);
    }

    /// Add a cell or face and ignore elements of lower dimensions. Only lines,
    /// quadrilaterals and hexahedra with nodes at their corners are accepted.
    void
    add_element(const Shape             &shape,
                const long               id,
                const std::vector<long> &node_numbers);

    const unsigned int dim;
    MeshFile           mesh;
    /// The line of the word that was read last, counted from 1.
    unsigned int        line = 1;
    std::array<bool, 4> has_dimension{};

  private:
    std::string                            text;
    std::size_t                            position = 0;
    std::unordered_map<long, unsigned int> node_indices;
  };


  /// Read a file of Gmsh, version 2 or 4: the id is that of the physical group.
  void
  read_msh(MeshReader &reader);
} // namespace Viscoplastic
