// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/data_out_base.h>

#include <viscoplastic_contact/results/unit_labels.h>

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

// Grids with fields in the form in which files have them.

namespace Viscoplastic
{
  /// The name of the files of an output without extension.
  inline std::string
  record_name(const std::string &series, const unsigned int n)
  {
    return series + '_' + Utilities::int_to_string(n, 5);
  }



  /// The vertices of deal.II's cells in the order of ParaView.
  constexpr std::array<unsigned int, 8> paraview_order{
    {0, 1, 3, 2, 4, 5, 7, 6}};



  /// A field in single precision: a vector or number at each point, or a number
  /// for each cell. Its name in files is followed by the label of its unit,
  /// since deal.II has no place for units.
  struct OutputField
  {
    std::string        name, label;
    bool               is_vector, is_of_cells;
    std::vector<float> values;
  };



  /// Cells with fields, of which vectors come first. It contains copies of all
  /// data, so that a thread can write it while the run continues.
  template <int cell_dim, int dim>
  struct OutputGrid
  {
    static constexpr unsigned int n_vertices =
      GeometryInfo<cell_dim>::vertices_per_cell;

    std::vector<Point<dim>> points;
    /// The points of the cells, in the order of deal.II.
    std::vector<unsigned int> vertices;
    std::vector<OutputField>  fields;

    std::size_t
    n_cells() const
    {
      return vertices.size() / n_vertices;
    }

    /// Add a field without values.
    void
    add_field(const Scene<dim>  &scene,
              const FieldColumn &field,
              const bool         is_of_cells)
    {
      fields.push_back({field.name,
                        scene.parameters.units.label(field.quantity, dim),
                        field.rank == 1,
                        is_of_cells,
                        {}});
    }

    /// Add a vertex of the next cell with a point of its own.
    void
    add_vertex(const Point<dim> &point)
    {
      vertices.push_back(points.size());
      points.push_back(point);
    }

    /// Return the n-th part of a VTU file in the format of deal.II, empty after
    /// the last one: the mesh, the fields, of which each is a part, and the
    /// end. The patches of DataOutBase would take more memory than the matrix.
    std::string
    vtu_part(const unsigned int n) const
    {
      std::ostringstream text;
      if (n_cells() == 0)
        {
          const auto &[names, vectors] = names_and_vectors();
          if (n == 0)
            DataOutBase::write_vtu(
              std::vector<DataOutBase::Patch<cell_dim, dim>>(),
              names,
              vectors,
              flags(),
              text);
        }
      else if (n == 0)
        write_mesh(text);
      else if (n <= fields.size())
        write(fields[n - 1], text);
      else if (n == fields.size() + 1)
        {
          text << "  </PointData>\n </Piece>\n";
          DataOutBase::write_vtu_footer(text);
        }
      return text.str();
    }

    /// Return the text of the PVTU file for these VTU files.
    std::string
    pvtu_record(const std::vector<std::string> &pieces) const
    {
      const auto &[names, vectors] = names_and_vectors();
      std::ostringstream text;
      DataOutBase::write_pvtu_record(text, pieces, names, vectors, flags());
      return text.str();
    }

  private:
    /// Stronger compression takes ten times as long and saves a tenth.
    static DataOutBase::VtkFlags
    flags()
    {
      DataOutBase::VtkFlags flags;
      flags.compression_level = DataOutBase::VtkFlags::best_speed;
      return flags;
    }

    /// The names of all components, and the ranges of those of vectors.
    auto
    names_and_vectors() const
    {
      using Interpretation =
        DataComponentInterpretation::DataComponentInterpretation;
      std::vector<std::string> names;
      std::vector<
        std::tuple<unsigned int, unsigned int, std::string, Interpretation>>
        vectors;
      for (const OutputField &field : fields)
        {
          const std::string name = field.name + field.label;
          if (field.is_vector)
            vectors.emplace_back(
              names.size(),
              names.size() + dim - 1,
              name,
              DataComponentInterpretation::component_is_part_of_vector);
          names.insert(names.end(), field.is_vector ? dim : 1, name);
        }
      return std::make_pair(names, vectors);
    }

    void
    write_mesh(std::ostream &out) const
    {
      DataOutBase::write_vtu_header(out, flags());
      out << "<Piece NumberOfPoints=\"" << vertices.size()
          << "\" NumberOfCells=\"" << n_cells() << "\" >\n  <Points>\n"
          << values_at_vertices<3>("",
                                   [&](const std::size_t  i,
                                       const unsigned int d) {
                                     return points[vertices[i]][d];
                                   })
          << "  </Points>\n\n";
      std::vector<std::int32_t> corners, ends;
      for (std::size_t c = 0; c < n_cells(); ++c)
        {
          for (const unsigned int v : paraview_order)
            if (v < n_vertices)
              corners.push_back(c * n_vertices + v);
          ends.push_back((c + 1) * n_vertices);
        }
      // Lines, quadrilaterals, hexahedra.
      constexpr std::uint8_t type = cell_dim == 1 ? 3 : cell_dim == 2 ? 9 : 12;
      const std::vector<std::uint8_t> types(n_cells(), type);
      out << "  <Cells>\n"
          << data_array("type=\"Int32\" Name=\"connectivity\"", corners)
          << data_array("type=\"Int32\" Name=\"offsets\"", ends)
          << data_array("type=\"UInt8\" Name=\"types\"", types)
          << "  </Cells>\n  <PointData Scalars=\"scalars\">\n";
    }

    void
    write(const OutputField &field, std::ostream &out) const
    {
      const std::string name = "Name=\"" + field.name + field.label + '"';
      if (field.is_vector)
        out << values_at_vertices<3>(
          name + ' ', [&](const std::size_t i, const unsigned int d) {
            return field.values[vertices[i] * dim + d];
          });
      else
        out << values_at_vertices<1>(
          name, [&](const std::size_t i, const unsigned int) {
            return field
              .values[field.is_of_cells ? i / n_vertices : vertices[i]];
          });
    }

    /// Return an element with value(vertex, component) at the vertices of all
    /// cells; components beyond the dimension are zero.
    template <unsigned int n_components, typename Function>
    std::string
    values_at_vertices(const std::string &name, const Function &value) const
    {
      std::vector<float> values;
      values.reserve(vertices.size() * n_components);
      for (std::size_t i = 0; i < vertices.size(); ++i)
        for (unsigned int c = 0; c < n_components; ++c)
          values.push_back(c < dim ? static_cast<float>(value(i, c)) : 0.f);
      return data_array("type=\"Float32\" " + name +
                          (n_components == 3 ? "NumberOfComponents=\"3\"" : ""),
                        values);
    }

    /// Return an element with compressed numbers.
    template <typename Number>
    static std::string
    data_array(const std::string &attributes, const std::vector<Number> &values)
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
      return "    <DataArray " + attributes + " format=\"binary\">\n" +
             Utilities::encode_base64(header) +
             Utilities::encode_base64(bytes) + "\n    </DataArray>\n";
    }
  };



  /// Return the surface of a plane section (x, y) = (r, z) that is rotated by
  /// @p degrees about the y axis, towards viewers who look along -z. Each of
  /// the @p edges, a cell of @p section and its face number in deal.II, sweeps
  /// a surface; if these do not close, the section itself is at both ends.
  /// Vectors are rotated; components of tensors remain those of the section.
  inline OutputGrid<2, 3>
  revolved(const OutputGrid<2, 2>                                  &section,
           const std::vector<std::pair<std::size_t, unsigned int>> &edges,
           const double                                             degrees)
  {
    OutputGrid<2, 3> result;
    for (const OutputField &field : section.fields)
      result.fields.push_back(
        {field.name, field.label, field.is_vector, field.is_of_cells, {}});

    // A corner: a vertex of the cell of the section, and the angle.
    using Corner   = std::pair<unsigned int, double>;
    const auto add = [&](const std::size_t            cell,
                         const std::array<Corner, 4> &corners) {
      for (const auto &[v, angle] : corners)
        {
          const double cosine = std::cos(angle), sine = -std::sin(angle);
          const auto   rotated =
            [&, sine = sine, cosine = cosine](const auto &x) {
              return Point<3>(cosine * x[0], x[1], sine * x[0]);
            };
          const unsigned int point = section.vertices[4 * cell + v];
          result.add_vertex(rotated(section.points[point]));
          for (std::size_t f = 0; f < section.fields.size(); ++f)
            if (section.fields[f].is_vector)
              {
                const Point<3> vector =
                  rotated(&section.fields[f].values[2 * point]);
                for (unsigned int d = 0; d < 3; ++d)
                  result.fields[f].values.push_back(vector[d]);
              }
        }
      for (std::size_t f = 0; f < section.fields.size(); ++f)
        if (section.fields[f].is_of_cells)
          result.fields[f].values.push_back(section.fields[f].values[cell]);
    };
    const double       whole     = degrees * (numbers::PI / 180.);
    const unsigned int n_sectors = std::ceil(degrees / 10. - 1e-9);
    for (const auto &[cell, face] : edges)
      for (unsigned int s = 0; s < n_sectors; ++s)
        {
          const double begin = s * whole / n_sectors,
                       end   = (s + 1) * whole / n_sectors;
          const unsigned int v =
                               GeometryInfo<2>::face_to_cell_vertices(face, 0),
                             w =
                               GeometryInfo<2>::face_to_cell_vertices(face, 1);
          add(cell, {{{v, begin}, {w, begin}, {v, end}, {w, end}}});
        }
    if (degrees < 360.)
      for (const double angle : {0., whole})
        for (std::size_t cell = 0; cell < section.n_cells(); ++cell)
          add(cell, {{{0, angle}, {1, angle}, {2, angle}, {3, angle}}});
    return result;
  }
} // namespace Viscoplastic
