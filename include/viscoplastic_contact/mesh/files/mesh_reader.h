// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/mesh/files/mesh_file.h>

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

namespace Viscoplastic
{
  /**
   * The text of a mesh file, word by word, and the mesh that comes out of it.
   * All its errors are std::runtime_error that begin with the line.
   */
  class MeshReader
  {
  public:
    /// A kind of elements.
    struct Shape
    {
      std::string  name;
      unsigned int dimension, n_nodes;
    };


    MeshReader(std::string text, const unsigned int dim);

    // The text

    /// Skips blanks and empty lines.
    bool
    at_end();

    /// The next word; @p what is expected, for the message if there is none.
    std::string
    word(const std::string &what);

    void
    expect(const std::string &keyword);

    /// The next word as a whole number, of magnitude 1e12 at most.
    long
    integer(const std::string &what);

    /// As a finite number.
    double
    number(const std::string &what);

    /// As a number of things that the rest of the file can still hold, each
    /// being a word.
    unsigned long
    count(const std::string &what);

    /// The next word as a key of @p shapes.
    const Shape &
    shape(const std::map<std::string, Shape> &shapes);

    std::vector<long>
    node_numbers(const unsigned int n);

    Point<3>
    coordinates();

    [[noreturn]] void
    fail(const std::string &message) const;

    /// A word of the file as it can be shown in a message.
    static std::string
    quoted(const std::string &word);

    // The mesh

    void
    add_node(const long number, const Point<3> &x);

    /// Cells and faces are kept; shapes without nodes at all of their 2^dim
    /// corners, or with more, are refused.
    void
    add_element(const Shape             &shape,
                const long               id,
                const std::vector<long> &node_numbers);

    const unsigned int dim;
    MeshFile           mesh;
    /// Of the last word.
    unsigned int line = 1;
    /// Whether there were elements of a dimension.
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
