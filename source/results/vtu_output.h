// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/numerics/data_out.h>

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/results/unit_labels.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

// What Output writes as VTU: the body by DataOut, and faces of its boundary.

namespace Viscoplastic
{
  /// The name of an output without its ending.
  inline std::string
  record_name(const std::string &series, const unsigned int n)
  {
    return series + '_' + Utilities::int_to_string(n, 5);
  }



  /// What is written of the body at one time, before it is copied.
  template <int dim>
  struct BodyData
  {
    using Cell = typename DoFHandler<dim>::active_cell_iterator;

    const AdmissibleSpace<dim> &space;
    /// Those of the present stage that this rank owns.
    std::vector<Cell> cells;
    /// Cartesian fields on `relevant`, with their names.
    std::vector<std::pair<std::string, const DistributedVector *>> vectors;
    /// Values by the index of active cells.
    std::vector<std::pair<std::string, Vector<double>>> means;
  };



  /// Files have single precision. What is beyond its range, and would be
  /// infinite there, becomes its largest number: ParaView cannot scale colors
  /// to infinite values. Returns whether this was needed.
  inline bool
  cut_off_infinite(std::vector<float> &values)
  {
    bool result = false;
    for (float &value : values)
      if (std::isinf(value))
        {
          value  = std::copysign(std::numeric_limits<float>::max(), value);
          result = true;
        }
    return result;
  }



  /// The same of patches. Returns the data sets by their indices, and the
  /// number of data sets for the coordinates.
  template <int dim, int spacedim>
  std::set<unsigned int>
  cut_off_infinite(std::vector<DataOutBase::Patch<dim, spacedim>> &patches,
                   const unsigned int                              n_data_sets)
  {
    constexpr float        largest = std::numeric_limits<float>::max();
    std::set<unsigned int> result;
    for (auto &patch : patches)
      {
        for (unsigned int i = 0; i < n_data_sets; ++i)
          for (unsigned int j = 0; j < patch.data.n_cols(); ++j)
            if (float &value = patch.data(i, j); std::isinf(value))
              {
                value = std::copysign(largest, value);
                result.insert(i);
              }
        for (Point<spacedim> &x : patch.vertices)
          for (unsigned int d = 0; d < spacedim; ++d)
            if (std::abs(x[d]) > largest)
              {
                x[d] = std::copysign(largest, x[d]);
                result.insert(n_data_sets);
              }
      }
    return result;
  }



  /// A vector field: its first and last component, its name.
  using VectorRange =
    std::tuple<unsigned int,
               unsigned int,
               std::string,
               DataComponentInterpretation::DataComponentInterpretation>;



  /// Patches with nodal data, in the form that DataOutInterface writes. They
  /// refer to nothing else, so that a thread can write them while the run goes
  /// on.
  template <int patch_dim, int dim>
  class PatchOutput : public DataOutInterface<patch_dim, dim>
  {
  public:
    std::vector<DataOutBase::Patch<patch_dim, dim>> patches;
    std::vector<std::string>                        names;
    std::vector<VectorRange>                        vectors;

  protected:
    const std::vector<DataOutBase::Patch<patch_dim, dim>> &
    get_patches() const override
    {
      return patches;
    }

    std::vector<std::string>
    get_dataset_names() const override
    {
      return names;
    }

    std::vector<VectorRange>
    get_nonscalar_data_ranges() const override
    {
      return vectors;
    }
  };



  /// The body, a patch for each cell in the order of @p body, which a restart
  /// does not change; with the units of @p scene in the names, where deal.II
  /// allows none in those of data.
  template <int dim>
  PatchOutput<dim, dim>
  make_patches(const Scene<dim> &scene, const BodyData<dim> &body)
  {
    struct : DataOut<dim>
    {
      using DataOut<dim>::patches, DataOut<dim>::get_dataset_names,
        DataOut<dim>::get_nonscalar_data_ranges;
    } data_out;
    data_out.attach_dof_handler(body.space.dof_handler);
    for (const auto &[name, field] : body.vectors)
      data_out.add_data_vector(
        *field,
        std::vector<std::string>(dim, name),
        DataOut<dim>::type_dof_data,
        std::vector(dim,
                    DataComponentInterpretation::component_is_part_of_vector));
    for (const auto &[name, means] : body.means)
      data_out.add_data_vector(means, name);
    if (scene.has_stages())
      data_out.set_cell_selection([&scene](const auto &cell) {
        return cell->is_active() && cell->is_locally_owned() &&
               scene.is_present(cell->material_id());
      });
    data_out.build_patches();

    PatchOutput<dim, dim> result;
    result.names   = data_out.get_dataset_names();
    result.vectors = data_out.get_nonscalar_data_ranges();
    for (std::string &name : result.names)
      name += label_of_field(scene, name);
    for (VectorRange &range : result.vectors)
      std::get<2>(range) += label_of_field(scene, std::get<2>(range));

    // DataOut's are in the order of active cells.
    std::vector<std::pair<unsigned int, unsigned int>> order;
    for (const auto &cell : body.cells)
      order.emplace_back(cell->active_cell_index(), order.size());
    AssertDimension(data_out.patches.size(), order.size());
    std::sort(order.begin(), order.end());
    result.patches.swap(data_out.patches);
    for (std::size_t p = 0; p < order.size(); ++p)
      {
        auto &patch       = result.patches[p];
        patch.patch_index = order[p].second;
        // Their numbers are no longer right, and nothing here asks for them.
        std::fill(std::begin(patch.neighbors),
                  std::end(patch.neighbors),
                  numbers::invalid_unsigned_int);
      }
    // Each swap brings one to its place.
    for (std::size_t p = 0; p < order.size(); ++p)
      while (result.patches[p].patch_index != p)
        result.patches[p].swap(result.patches[result.patches[p].patch_index]);
    return result;
  }



  /// What becomes of a plane section (x, y) = (r, z) that turns by @p degrees
  /// about the y axis, towards those who look along -z: @p edges, each a patch
  /// of @p section and the number of its face in cells of deal.II, sweep
  /// surfaces, and where these do not close, the section itself is at both
  /// ends. Vectors turn; components of tensors remain those of the section.
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

    // Corners, by patch and vertex of the section and the angle.
    using Corner   = std::pair<unsigned int, double>;
    const auto add = [&](const DataOutBase::Patch<2, 2> &from,
                         const std::array<Corner, 4>    &corners) {
      DataOutBase::Patch<2, 3> patch;
      patch.patch_index    = result.patches.size();
      patch.reference_cell = ReferenceCells::Quadrilateral;
      patch.data.reinit(result.names.size(), 4);
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
      result.patches.push_back(patch);
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



  /// Stronger compression takes ten times as long and saves a tenth.
  inline DataOutBase::VtkFlags
  vtk_flags()
  {
    DataOutBase::VtkFlags flags;
    flags.compression_level = DataOutBase::VtkFlags::best_speed;
    return flags;
  }
} // namespace Viscoplastic
