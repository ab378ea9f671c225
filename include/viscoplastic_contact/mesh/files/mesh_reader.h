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

    /// Up to the end of this line, without blanks at its ends.
    std::string
    rest_of_line();

    /// The same of the line after this one; false if there is none.
    bool
    next_line(std::string &result);

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

    /// The same of a word that was read before.
    long
    to_integer(const std::string &word, const std::string &what) const;
    double
    to_number(const std::string &word, const std::string &what) const;

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


  /// The nodes of the faces of a cell, as indices into Element::nodes, in the
  /// order in which ABAQUS numbers faces.
  std::vector<std::vector<unsigned int>>
  faces_of_cell(const unsigned int dim);


  // One function a format.

  /// Gmsh, version 2 and 4: the id is that of the physical group.
  void
  read_msh(MeshReader &reader);

  /// AVS UCD: the id is the material.
  void
  read_ucd(MeshReader &reader);

  /// VTK's old format: the id is the cell data MaterialID, gmsh:physical or
  /// CellEntityIds.
  void
  read_vtk(MeshReader &reader);

  /// ABAQUS: ids are the numbers at the end of names of surfaces, materials and
  /// sets of elements.
  void
  read_abaqus(MeshReader &reader);
} // namespace Viscoplastic
