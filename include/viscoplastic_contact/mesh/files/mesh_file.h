// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <array>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// The contents of a mesh file: nodes, and elements of the highest dimension
  /// (cells) and of one less (faces), with their ids.
  struct MeshFile
  {
    /// A quadrilateral or hexahedron; a line or quadrilateral as a face.
    struct Element
    {
      /// The indices of the nodes in the order of a walk around the element; in
      /// 3D around the lower and then around the upper face. Only the first 2,
      /// 4 or 8 are used.
      std::array<unsigned int, 8> nodes{};
      unsigned int                id = 0;
      /// The line of the file, for error messages.
      unsigned int line = 0;
    };

    std::vector<Point<3>> nodes;
    std::vector<Element>  cells, faces;
  };
} // namespace Viscoplastic
