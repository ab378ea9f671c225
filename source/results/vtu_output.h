// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/data_out_base.h>

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/results/unit_labels.h>

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

// Data that Output writes as VTU: the body, and faces of its boundary.

namespace Viscoplastic
{
  /// The name of the files of an output without extension.
  inline std::string
  record_name(const std::string &series, const unsigned int n)
  {
    return series + '_' + Utilities::int_to_string(n, 5);
  }



  /// The data of the body at one time, before they are copied.
  template <int dim>
  struct BodyData
  {
    using Cell = typename DoFHandler<dim>::active_cell_iterator;

    const AdmissibleSpace<dim> &space;
    /// The owned cells that are present in this stage.
    std::vector<Cell> cells;
    /// Cartesian fields on relevant dofs.
    std::vector<std::pair<FieldColumn, const DistributedVector *>> vectors;
    /// Cell means in the order of `cells`.
    std::vector<std::pair<FieldColumn, std::vector<float>>> means;
  };



  /// Stronger compression takes ten times as long and saves a tenth.
  inline DataOutBase::VtkFlags
  vtk_flags()
  {
    DataOutBase::VtkFlags flags;
    flags.compression_level = DataOutBase::VtkFlags::best_speed;
    return flags;
  }



  /// First and last component of a vector field, its name and its kind.
  using VectorRange =
    std::tuple<unsigned int,
               unsigned int,
               std::string,
               DataComponentInterpretation::DataComponentInterpretation>;



  /// Patches with nodal data, in the form that DataOutBase writes. They contain
  /// copies of all data, so that a thread can write them while the run
  /// continues.
  template <int patch_dim, int dim>
  struct PatchOutput
  {
    std::vector<DataOutBase::Patch<patch_dim, dim>> patches;
    std::vector<std::string>                        names;
    std::vector<VectorRange>                        vectors;

    void
    add_field(const Scene<dim> &scene, const FieldColumn &field)
    {
      const bool        is_vector = field.rank == 1;
      const std::string name =
        field.name + scene.parameters.units.label(field.quantity, dim);
      if (is_vector)
        vectors.emplace_back(
          names.size(),
          names.size() + dim - 1,
          name,
          DataComponentInterpretation::component_is_part_of_vector);
      names.insert(names.end(), is_vector ? dim : 1, name);
    }

    /// Return the n-th part of a VTU file; empty after the last one.
    std::string
    vtu_part(const unsigned int n)
    {
      std::ostringstream text;
      if (n == 0)
        DataOutBase::write_vtu(patches, names, vectors, vtk_flags(), text);
      return text.str();
    }

    /// Add a patch with room for all fields.
    DataOutBase::Patch<patch_dim, dim> &
    add_patch()
    {
      auto &patch          = patches.emplace_back();
      patch.patch_index    = patches.size() - 1;
      patch.reference_cell = ReferenceCells::get_hypercube<patch_dim>();
      patch.data.reinit(names.size(),
                        GeometryInfo<patch_dim>::vertices_per_cell);
      return patch;
    }
  };



  /// The body, with a patch for each cell in the order of @p body, which a
  /// restart does not change. Names of fields include units, since deal.II has
  /// no place for units. Files are written field by field, since patches of all
  /// fields would take more memory than the matrix.
  template <int dim>
  class BodyOutput : public PatchOutput<dim, dim>
  {
  public:
    BodyOutput(const Scene<dim> &scene, const BodyData<dim> &body)
      : vertices(body.space.relevant.n_elements() / dim)
    {
      for (const auto &[column, field] : body.vectors)
        {
          this->add_field(scene, column);
          nodal.emplace_back(field->begin(),
                             field->begin() + vertices.size() * dim);
        }
      for (const auto &[column, values] : body.means)
        {
          this->add_field(scene, column);
          means.push_back(values);
        }
      nodes.reserve(body.cells.size() * n_vertices);
      for (const auto &cell : body.cells)
        for (const unsigned int v : cell->vertex_indices())
          {
            nodes.push_back(body.space.relevant.index_within_set(
                              cell->vertex_dof_index(v, 0)) /
                            dim);
            vertices[nodes.back()] = cell->vertex(v);
          }
    }

    /// Part 0 has the mesh, the next ones have a field each, and the last one
    /// has the end, in the format of deal.II.
    std::string
    vtu_part(const unsigned int n)
    {
      const std::size_t n_cells = nodes.size() / n_vertices;
      if (n_cells == 0)
        return PatchOutput<dim, dim>::vtu_part(n);
      std::ostringstream text;
      if (n == 0)
        {
          DataOutBase::write_vtu_header(text, vtk_flags());
          text << "<Piece NumberOfPoints=\"" << nodes.size()
               << "\" NumberOfCells=\"" << n_cells << "\" >\n  <Points>\n"
               << three_components([&](const unsigned int node,
                                       const unsigned int d) -> float {
                    return vertices[node][d];
                  })
               << "  </Points>\n\n";
          std::vector<std::int32_t> points, ends;
          for (std::size_t c = 0; c < n_cells; ++c)
            {
              for (const unsigned int v : {0, 1, 3, 2, 4, 5, 7, 6})
                if (v < n_vertices)
                  points.push_back(c * n_vertices + v);
              ends.push_back((c + 1) * n_vertices);
            }
          const std::vector<std::uint8_t> types(n_cells, dim == 2 ? 9 : 12);
          text << "  <Cells>\n"
               << data_array("Int32\" Name=\"connectivity", points)
               << data_array("Int32\" Name=\"offsets", ends)
               << data_array("UInt8\" Name=\"types", types)
               << "  </Cells>\n  <PointData Scalars=\"scalars\">\n";
        }
      else if (n <= nodal.size())
        text << three_components(
          [&](const unsigned int node, const unsigned int d) {
            return nodal[n - 1][node * dim + d];
          },
          "Name=\"" + this->names[(n - 1) * dim] + "\" ");
      else if (const std::size_t field = n - 1 - nodal.size();
               field < means.size())
        {
          std::vector<float> values;
          values.reserve(nodes.size());
          for (const float mean : means[field])
            values.insert(values.end(), n_vertices, mean);
          text << data_array("Float32\" Name=\"" +
                               this->names[nodal.size() * dim + field],
                             values);
        }
      else if (field == means.size())
        {
          text << "  </PointData>\n </Piece>\n";
          DataOutBase::write_vtu_footer(text);
        }
      return text.str();
    }

    /// Make the patches of all cells, as revolved() needs them.
    void
    make_patches()
    {
      for (std::size_t c = 0; c < nodes.size() / n_vertices; ++c)
        {
          auto &patch = this->add_patch();
          for (unsigned int v = 0; v < n_vertices; ++v)
            {
              const std::size_t node = nodes[c * n_vertices + v];
              patch.vertices[v]      = vertices[node];
              unsigned int row       = 0;
              for (const auto &values : nodal)
                for (unsigned int d = 0; d < dim; ++d)
                  patch.data(row++, v) = values[node * dim + d];
              for (const auto &values : means)
                patch.data(row++, v) = values[c];
            }
        }
    }

  private:
    static constexpr unsigned int n_vertices =
      GeometryInfo<dim>::vertices_per_cell;

    /// Return an element of this type (and name) with compressed numbers.
    template <typename Number>
    static std::string
    data_array(const std::string &type, const std::vector<Number> &values)
    {
      const std::size_t          n_bytes = values.size() * sizeof(Number);
      uLongf                     size    = compressBound(n_bytes);
      std::vector<unsigned char> bytes(size);
      const int                  status =
        compress2(bytes.data(),
                  &size,
                  reinterpret_cast<const Bytef *>(values.data()),
                  n_bytes,
                  Z_BEST_SPEED);
      AssertThrow(status == Z_OK, ExcInternalError());
      bytes.resize(size);
      // Number of blocks, sizes of a block and of the last one, compressed
      // size.
      const std::array<std::uint32_t, 4> sizes{{1,
                                                std::uint32_t(n_bytes),
                                                std::uint32_t(n_bytes),
                                                std::uint32_t(size)}};
      std::vector<unsigned char>         header(sizeof(sizes));
      std::memcpy(header.data(), sizes.data(), sizeof(sizes));
      return "    <DataArray type=\"" + type + "\" format=\"binary\">\n" +
             Utilities::encode_base64(header) +
             Utilities::encode_base64(bytes) + "\n    </DataArray>\n";
    }

    /// Return an element with value(node, component) at the vertices of cells.
    template <typename Function>
    std::string
    three_components(const Function &value, const std::string &name = "") const
    {
      std::vector<float> values;
      values.reserve(nodes.size() * 3);
      for (const unsigned int node : nodes)
        for (unsigned int d = 0; d < 3; ++d)
          values.push_back(d < dim ? value(node, d) : 0.f);
      return data_array("Float32\" " + name + "NumberOfComponents=\"3", values);
    }

    std::vector<unsigned int>       nodes; // of cells
    std::vector<Point<dim>>         vertices;
    std::vector<std::vector<float>> nodal, means;
  };



  /// Return the surface of a plane section (x, y) = (r, z) that is rotated by
  /// @p degrees about the y axis, towards viewers who look along -z. Each of
  /// the @p edges, a patch of @p section and its face number in deal.II, sweeps
  /// a surface; if these do not close, the section itself is at both ends.
  /// Vectors are rotated; components of tensors remain those of the section.
  inline PatchOutput<2, 3>
  revolved(const PatchOutput<2, 2>                                 &section,
           const std::vector<std::pair<std::size_t, unsigned int>> &edges,
           const double                                             degrees)
  {
    PatchOutput<2, 3>         result;
    std::vector<unsigned int> first_of_vectors;
    for (const auto &[first, last, name, interpretation] : section.vectors)
      {
        first_of_vectors.push_back(first);
        const unsigned int row = first + first_of_vectors.size() - 1;
        result.vectors.emplace_back(row, row + 2, name, interpretation);
      }
    const auto is_vector = [&](const unsigned int row) {
      return std::count(first_of_vectors.begin(), first_of_vectors.end(), row);
    };
    for (unsigned int row = 0; row < section.names.size(); ++row)
      result.names.insert(result.names.end(),
                          is_vector(row) > 0 ? 2 : 1,
                          section.names[row]);

    // A corner: a vertex of the patch of the section, and the angle.
    using Corner   = std::pair<unsigned int, double>;
    const auto add = [&](const DataOutBase::Patch<2, 2> &from,
                         const std::array<Corner, 4>    &corners) {
      auto &patch = result.add_patch();
      for (unsigned int i = 0; i < 4; ++i)
        {
          const auto &[v, angle] = corners[i];
          const double cosine = std::cos(angle), sine = -std::sin(angle);
          const double r = from.vertices[v][0];
          patch.vertices[i] =
            Point<3>(cosine * r, from.vertices[v][1], sine * r);
          unsigned int target = 0;
          for (unsigned int row = 0; row < section.names.size(); ++row)
            if (const double value = from.data(row, v); is_vector(row) > 0)
              {
                patch.data(target++, i) = cosine * value;
                patch.data(target++, i) = from.data(++row, v);
                patch.data(target++, i) = sine * value;
              }
            else
              patch.data(target++, i) = value;
        }
    };
    const double       whole     = degrees * (numbers::PI / 180.);
    const unsigned int n_sectors = std::ceil(degrees / 10. - 1e-9);
    for (const auto &[patch, face] : edges)
      for (unsigned int s = 0; s < n_sectors; ++s)
        {
          const double begin = s * whole / n_sectors,
                       end   = (s + 1) * whole / n_sectors;
          const unsigned int v =
                               GeometryInfo<2>::face_to_cell_vertices(face, 0),
                             w =
                               GeometryInfo<2>::face_to_cell_vertices(face, 1);
          add(section.patches[patch],
              {{{v, begin}, {w, begin}, {v, end}, {w, end}}});
        }
    if (degrees < 360.)
      for (const double angle : {0., whole})
        for (const auto &patch : section.patches)
          add(patch, {{{0, angle}, {1, angle}, {2, angle}, {3, angle}}});
    return result;
  }
} // namespace Viscoplastic
