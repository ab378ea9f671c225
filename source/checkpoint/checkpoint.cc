// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/grid/cell_id.h>

#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/checkpoint/checkpoint.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace Viscoplastic
{
  namespace
  {
    /// Levels for which the way down fits into 64 bits; p4est has no more.
    constexpr unsigned int
    max_level(const unsigned int dim)
    {
      return dim == 2 ? 29 : 18;
    }



    /// Where the cell begins along the curve through its coarse cell, and its
    /// length there.
    template <int dim>
    std::uint64_t
    length(const CellAddress &address)
    {
      return std::uint64_t(1) << (dim * (max_level(dim) - address.level));
    }

    template <int dim>
    std::uint64_t
    start(const CellAddress &address)
    {
      return address.children * length<dim>(address);
    }

    template <int dim>
    bool
    is_before(const CellAddress &a, const CellAddress &b)
    {
      return std::make_pair(a.coarse_cell, start<dim>(a)) <
             std::make_pair(b.coarse_cell, start<dim>(b));
    }



    void
    require(const bool condition)
    {
      AssertThrow(condition,
                  ExcMessage("The checkpoint contradicts itself or the mesh."));
    }



    template <int dim>
    std::vector<CellAddress>
    unpack_mesh(const std::string &bytes, const unsigned int n_coarse_cells)
    {
      BinaryReader  archive(bytes);
      std::uint64_t n;
      archive      &n;
      require(n <= bytes.size() / 16);
      std::vector<CellAddress> cells(n);
      for (CellAddress &cell : cells)
        {
          archive &cell.coarse_cell &cell.level &cell.children;
          require(cell.coarse_cell < n_coarse_cells &&
                  cell.level <= max_level(dim) &&
                  cell.children >> (dim * cell.level) == 0);
        }
      require(archive.is_at_end());
      return cells;
    }



    /// The fields of a state that have values at vertices.
    template <typename StateType>
    auto
    nodal_fields(StateType &state)
    {
      return std::array<decltype(&state.u), 3>{
        {&state.u, &state.velocity, &state.initial_u}};
    }
  } // namespace



  template <int dim>
  CellAddress
  CellAddress::of(const typename Triangulation<dim>::cell_iterator &cell)
  {
    const CellId id = cell->id();
    CellAddress  address;
    address.coarse_cell = id.get_coarse_cell_id();
    for (const std::uint8_t child : id.get_child_indices())
      {
        ++address.level;
        address.children = (address.children << dim) | child;
      }
    return address;
  }



  template <int dim>
  std::string
  pack_mesh(const parallel::distributed::Triangulation<dim> &triangulation)
  {
    BinaryWriter archive;
    archive &static_cast<std::uint64_t>(
      triangulation.n_locally_owned_active_cells());
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const CellAddress address = CellAddress::of<dim>(cell);
          archive &address.coarse_cell &address.level &address.children;
        }
    return archive.bytes();
  }



  template <int dim>
  void
  restore_mesh(const std::vector<std::string>            &parts,
               parallel::distributed::Triangulation<dim> &triangulation)
  {
    const unsigned int       n_coarse = triangulation.n_cells(0);
    std::vector<CellAddress> leaves;
    for (const std::string &part : parts)
      {
        const auto cells = unpack_mesh<dim>(part, n_coarse);
        leaves.insert(leaves.end(), cells.begin(), cells.end());
      }
    std::sort(leaves.begin(), leaves.end(), is_before<dim>);

    // They must fill each coarse cell, one after the other.
    std::uint64_t end = length<dim>(CellAddress());
    unsigned int  n   = 0;
    for (const CellAddress &leaf : leaves)
      {
        if (end == length<dim>(CellAddress()))
          {
            require(leaf.coarse_cell == n);
            ++n;
            end = 0;
          }
        require(leaf.coarse_cell + 1 == n && start<dim>(leaf) == end);
        end += length<dim>(leaf);
      }
    require(n == n_coarse && end == length<dim>(CellAddress()));

    const MPI_Comm communicator = triangulation.get_communicator();
    for (unsigned int pass = 0; pass < 3 * max_level(dim); ++pass)
      {
        bool differs = false;
        for (const auto &cell : triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            {
              // The leaf in which this cell begins is the cell itself, or part
              // of it, or contains it.
              const CellAddress address = CellAddress::of<dim>(cell);
              const auto        leaf    = std::upper_bound(leaves.begin(),
                                                 leaves.end(),
                                                 address,
                                                 is_before<dim>) -
                                1;
              if (leaf->level > address.level)
                cell->set_refine_flag();
              else if (leaf->level < address.level)
                cell->set_coarsen_flag();
              differs |= leaf->level != address.level;
            }
        if (Utilities::MPI::max(differs ? 1 : 0, communicator) == 0)
          return;
        triangulation.execute_coarsening_and_refinement();
      }
    require(false); // neighbours differ by more than one level
  }



  template <int dim>
  std::string
  pack_fields(const StressSampling<dim> &sampling,
              const State<dim>          &state,
              const Vector<double>      &squared_estimate)
  {
    const AdmissibleSpace<dim> &space  = sampling.space;
    const auto                  fields = nodal_fields(state);
    std::vector<bool>           is_packed(space.owned.n_elements(), false);
    std::vector<std::uint8_t>   vertices; // a bit a vertex with values here
    std::vector<double>         nodal, samples, estimate;
    std::size_t                 owned_cell = 0;
    for (const auto &cell : space.dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          std::uint8_t with_values = 0;
          for (const unsigned int v : cell->vertex_indices())
            {
              const auto dof = cell->vertex_dof_index(v, 0);
              if (!space.owned.is_element(dof) ||
                  is_packed[space.owned.index_within_set(dof)])
                continue;
              is_packed[space.owned.index_within_set(dof)] = true;
              with_values |= 1 << v;
              const auto first = space.relevant.index_within_set(dof);
              for (const DistributedVector *field : fields)
                if (field->size() > 0)
                  nodal.insert(nodal.end(),
                               field->begin() + first,
                               field->begin() + first + dim);
            }
          vertices.push_back(with_values);
          for (const IrreversibleStress *field : sample_fields(state))
            if (!field->empty())
              for (unsigned int s = 0; s < sampling.n_samples; ++s)
                {
                  const auto &sample =
                    (*field)[owned_cell * sampling.n_samples + s];
                  samples.insert(samples.end(),
                                 sample.begin_raw(),
                                 sample.begin_raw() +
                                   sample.n_independent_components);
                }
          if (squared_estimate.size() > 0)
            estimate.push_back(squared_estimate[cell->active_cell_index()]);
          ++owned_cell;
        }
    BinaryWriter                       archive;
    archive &vertices &nodal &samples &estimate;
    return archive.bytes();
  }



  template <int dim>
  bool
  unpack_fields(const std::vector<std::string> &meshes,
                const std::vector<std::string> &fields,
                const StressSampling<dim>      &sampling,
                const bool                      has_initial_u,
                const bool                      has_estimate,
                const unsigned int              n_sample_fields,
                State<dim>                     &state,
                Vector<double>                 &squared_estimate)
  {
    AssertDimension(meshes.size(), fields.size());
    using Cell = typename DoFHandler<dim>::active_cell_iterator;
    const AdmissibleSpace<dim> &space = sampling.space;
    const auto        &triangulation  = space.dof_handler.get_triangulation();
    const unsigned int n_fields       = has_initial_u ? 3 : 2;
    std::vector<IrreversibleStress *> sampled;
    for (unsigned int f = 0; f < n_sample_fields; ++f)
      sampled.push_back(sample_fields(state)[f]);
    const std::size_t n_z = sampling.n_samples * 6; // a cell and field

    // Vertices of owned cells are vertices of owned or ghost cells elsewhere.
    struct LocalCell
    {
      CellAddress address;
      Cell        cell;
      std::size_t owned_index;
    };
    std::vector<LocalCell> cells;
    std::size_t            n_owned = 0;
    for (const auto &cell : space.dof_handler.active_cell_iterators())
      if (!cell->is_artificial())
        cells.push_back({CellAddress::of<dim>(cell),
                         cell,
                         cell->is_locally_owned() ? n_owned++ : 0});
    std::sort(cells.begin(),
              cells.end(),
              [](const LocalCell &a, const LocalCell &b) {
                return is_before<dim>(a.address, b.address);
              });

    std::vector<DistributedVector> values(n_fields, space.owned_vector());
    for (IrreversibleStress *field : sampled)
      field->resize(n_owned * sampling.n_samples);
    if (has_estimate)
      squared_estimate.reinit(triangulation.n_active_cells());
    std::size_t n_values = 0, n_cells = 0;
    for (std::size_t part = 0; part < meshes.size(); ++part)
      {
        const auto addresses =
          unpack_mesh<dim>(meshes[part], triangulation.n_cells(0));
        std::vector<std::uint8_t>          vertices;
        std::vector<double>                nodal, samples, estimate;
        BinaryReader                       archive(fields[part]);
        archive &vertices &nodal &samples &estimate;
        require(archive.is_at_end() && vertices.size() == addresses.size() &&
                samples.size() == sampled.size() * n_z * addresses.size() &&
                estimate.size() == (has_estimate ? addresses.size() : 0));
        std::size_t next = 0;
        for (std::size_t i = 0; i < addresses.size(); ++i)
          {
            const auto local =
              std::lower_bound(cells.begin(),
                               cells.end(),
                               addresses[i],
                               [](const LocalCell &a, const CellAddress &b) {
                                 return is_before<dim>(a.address, b);
                               });
            const bool is_here =
              local != cells.end() && local->address == addresses[i];
            for (unsigned int v = 0; v < GeometryInfo<dim>::vertices_per_cell;
                 ++v)
              if ((vertices[i] >> v & 1) != 0)
                {
                  require(next + n_fields * dim <= nodal.size());
                  const auto dof = is_here ?
                                     local->cell->vertex_dof_index(v, 0) :
                                     numbers::invalid_dof_index;
                  if (is_here && space.owned.is_element(dof))
                    {
                      const auto first = space.owned.index_within_set(dof);
                      for (unsigned int f = 0; f < n_fields; ++f)
                        for (unsigned int d = 0; d < dim; ++d)
                          values[f].begin()[first + d] =
                            nodal[next + f * dim + d];
                      ++n_values;
                    }
                  next += n_fields * dim;
                }
            if (!is_here || !local->cell->is_locally_owned())
              continue;
            ++n_cells;
            for (std::size_t f = 0; f < sampled.size(); ++f)
              for (std::size_t j = 0; j < n_z; ++j)
                (*sampled[f])[local->owned_index * sampling.n_samples + j / 6]
                  .begin_raw()[j % 6] =
                  samples[(i * sampled.size() + f) * n_z + j];
            if (has_estimate)
              squared_estimate[local->cell->active_cell_index()] = estimate[i];
          }
        require(next == nodal.size());
      }

    const auto targets = nodal_fields(state);
    for (unsigned int f = 0; f < n_fields; ++f)
      {
        *targets[f] = space.ghosted_vector();
        *targets[f] = values[f];
      }
    return n_cells == n_owned && n_values * dim == space.owned.n_elements();
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
    // Vertices in the order in which the cells have them first, which does not
    // depend on how the mesh has been refined.
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



  namespace
  {
    /// Whether an entry decides what the unknowns are and what they mean.
    bool
    is_fixed(const std::string &path)
    {
      const std::size_t slash   = path.find('/');
      const std::string section = path.substr(0, slash),
                        entry   = slash == std::string::npos ?
                                    "" :
                                    path.substr(slash + 1);
      const auto is_one_of = [&entry](const std::vector<std::string> &names) {
        return std::find(names.begin(), names.end(), entry) != names.end();
      };
      const std::string kind = section.substr(0, section.find(' '));
      // The coarse mesh is compared as such.
      if (section == "Geometry")
        return entry != "File";
      if (kind == "Material")
        return is_one_of({"Young's modulus",
                          "Poisson's ratio",
                          "Voigt matrix",
                          "Law",
                          "Volumetric integration",
                          "Stress history"});
      if (kind == "Boundary")
        return is_one_of({"Role", "Friction law"});
      if (section == "Initial state")
        return entry != "Compatibility tolerance";
      return section == "Dimension" || path == "Mesh refinement/Strategy" ||
             path == "Output/Points" || path == "Error control/Error bar";
    }
  } // namespace



  ParameterChanges
  compare_parameters(const std::map<std::string, std::string> &old_values,
                     const std::map<std::string, std::string> &new_values)
  {
    ParameterChanges changes;
    const auto       quoted = [](const std::string &value) {
      return value.empty() ? "empty" : excerpt(value);
    };
    for (const auto &[path, value] : new_values)
      {
        const auto old = old_values.find(path);
        if (old == old_values.end())
          changes.forbidden.push_back("'" + path + "' is new");
        else if (old->second != value)
          (is_fixed(path) ? changes.forbidden : changes.allowed)
            .push_back("'" + path + "' is " + quoted(value) + " (was " +
                       quoted(old->second) + ")");
      }
    for (const auto &[path, value] : old_values)
      if (new_values.count(path) == 0)
        changes.forbidden.push_back("'" + excerpt(path) + "' is gone (was " +
                                    quoted(value) + ")");
    return changes;
  }



#define INSTANTIATE(dim)                                                    \
  template CellAddress CellAddress::of<dim>(                                \
    const Triangulation<dim>::cell_iterator &);                             \
  template std::string pack_mesh<dim>(                                      \
    const parallel::distributed::Triangulation<dim> &);                     \
  template void restore_mesh<dim>(                                          \
    const std::vector<std::string> &,                                       \
    parallel::distributed::Triangulation<dim> &);                           \
  template std::string pack_fields<dim>(const StressSampling<dim> &,        \
                                        const State<dim> &,                 \
                                        const Vector<double> &);            \
  template bool        unpack_fields<dim>(const std::vector<std::string> &, \
                                   const std::vector<std::string> &, \
                                   const StressSampling<dim> &,      \
                                   const bool,                       \
                                   const bool,                       \
                                   const unsigned int,               \
                                   State<dim> &,                     \
                                   Vector<double> &);                \
  template CoarseMesh  describe_coarse_mesh<dim>(                           \
    const parallel::distributed::Triangulation<dim> &);

  INSTANTIATE(2)
  INSTANTIATE(3)
#undef INSTANTIATE
} // namespace Viscoplastic
