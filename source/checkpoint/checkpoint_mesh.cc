// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/checkpoint/checkpoint.h>
#include <viscoplastic_contact/mesh/cell_order.h>

namespace Viscoplastic
{
  namespace
  {
    /// The largest refinement level of p4est and, therefore, of CellId.
    constexpr unsigned int
    max_level(const unsigned int dim)
    {
      return dim == 2 ? 29 : 18;
    }
  } // namespace



  void
  require_sense(const bool condition)
  {
    if (!condition)
      refuse("The checkpoint contradicts itself or the mesh.");
  }



  template <int dim>
  std::string
  pack_mesh(const parallel::distributed::Triangulation<dim> &triangulation)
  {
    std::vector<unsigned int> words;
    for (const auto &cell : owned_cells(triangulation))
      {
        const auto binary = cell->id().template to_binary<dim>();
        words.insert(words.end(), binary.begin(), binary.end());
      }
    BinaryWriter archive;
    archive     &words;
    return archive.bytes();
  }



  template <int dim>
  std::vector<CellId>
  unpack_mesh(const std::string &bytes, const unsigned int n_coarse_cells)
  {
    BinaryReader              archive(bytes);
    std::vector<unsigned int> words;
    archive                  &words;
    CellId::binary_type       binary;
    require_sense(archive.is_at_end() && words.size() % binary.size() == 0);
    std::vector<CellId> cells;
    cells.reserve(words.size() / binary.size());
    for (auto word = words.begin(); word != words.end(); word += binary.size())
      {
        std::copy_n(word, binary.size(), binary.begin());
        // CellId does not check coarse cell, dimension, level and children that
        // it is constructed from.
        require_sense(binary[0] < n_coarse_cells && binary[1] % 4 == dim &&
                      binary[1] / 4 <= max_level(dim));
        cells.emplace_back(binary);
        require_sense(cells.back().template to_binary<dim>() == binary);
      }
    return cells;
  }



  template <int dim>
  void
  restore_mesh(const std::vector<std::string>            &parts,
               parallel::distributed::Triangulation<dim> &triangulation)
  {
    std::vector<CellId> leaves;
    for (const std::string &part : parts)
      {
        const auto cells = unpack_mesh<dim>(part, triangulation.n_cells(0));
        leaves.insert(leaves.end(), cells.begin(), cells.end());
      }
    // CellId orders a cell before its descendants, these before the next cell.
    std::sort(leaves.begin(), leaves.end());

    const MPI_Comm communicator = triangulation.get_communicator();
    for (unsigned int pass = 0; pass < 3 * max_level(dim); ++pass)
      {
        bool differs = false, contradicts = false;
        for (const auto &cell : owned_cells(triangulation))
          {
            // The leaf before `next' is the cell itself, or contains it, or
            // ends where the cell begins.
            const CellId id = cell->id();
            const auto   next =
              std::upper_bound(leaves.begin(), leaves.end(), id);
            if (next != leaves.begin() && *(next - 1) == id)
              continue;
            differs = true;
            if (next != leaves.end() && id.is_ancestor_of(*next))
              cell->set_refine_flag();
            else if (next != leaves.begin() && (next - 1)->is_ancestor_of(id))
              cell->set_coarsen_flag();
            else
              contradicts = true;
          }
        require_sense(!Utilities::MPI::logical_or(contradicts, communicator));
        if (!Utilities::MPI::logical_or(differs, communicator))
          {
            require_sense(triangulation.n_global_active_cells() ==
                          leaves.size());
            return;
          }
        triangulation.execute_coarsening_and_refinement();
      }
    require_sense(false); // neighbors differ by more than one level
  }



  bool
  CoarseMesh::agrees_with(const CoarseMesh &other) const
  {
    if (topology != other.topology || vertices.size() != other.vertices.size())
      return false;
    double size = 0., difference = 0.;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      {
        size = std::max(size, std::abs(vertices[i]));
        difference =
          std::max(difference, std::abs(vertices[i] - other.vertices[i]));
      }
    return difference <= 1e-10 * size;
  }



  template <int dim>
  CoarseMesh
  describe_coarse_mesh(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    // Number vertices in the order in which they appear first in cells, which
    // does not depend on refinement.
    CoarseMesh                            mesh;
    std::map<unsigned int, std::uint32_t> number;
    const auto                            add = [&mesh](const std::uint32_t n) {
      for (unsigned int byte = 0; byte < 4; ++byte)
        mesh.topology.push_back(n >> (8 * byte) & 0xff);
    };
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      {
        add(cell->material_id());
        for (const unsigned int v : cell->vertex_indices())
          {
            const auto [entry, is_new] =
              number.emplace(cell->vertex_index(v), number.size());
            add(entry->second);
            if (is_new)
              for (unsigned int d = 0; d < dim; ++d)
                mesh.vertices.push_back(cell->vertex(v)[d]);
          }
        for (const unsigned int f : cell->face_indices())
          add(cell->face(f)->boundary_id());
      }
    return mesh;
  }



  VISCOPLASTIC_INSTANTIATE(pack_mesh);
  VISCOPLASTIC_INSTANTIATE(unpack_mesh);
  VISCOPLASTIC_INSTANTIATE(restore_mesh);
  VISCOPLASTIC_INSTANTIATE(describe_coarse_mesh);
} // namespace Viscoplastic
