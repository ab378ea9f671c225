// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/checkpoint/checkpoint.h>
#include <viscoplastic_contact/mesh/cell_order.h>

namespace Viscoplastic
{
  namespace
  {
    /// Return the nodes of the contact face by their first degrees of freedom.
    template <int dim>
    std::map<types::global_dof_index, unsigned int>
    nodes_by_dof(const ContactFace<dim> *face)
    {
      std::map<types::global_dof_index, unsigned int> result;
      if (face != nullptr)
        for (unsigned int node = 0; node < face->layout().n_nodes(); ++node)
          result[face->first_dof(node)] = node;
      return result;
    }



    /// Call act(value) with a reference to each number of contact and
    /// truncations at a node.
    template <typename StateType, typename TruncationType, typename Action>
    void
    for_each_value(const ContactLayout                 &face,
                   const unsigned int                   node,
                   StateType                           &contact,
                   const std::vector<TruncationType *> &truncations,
                   const Action                        &act)
    {
      for (const unsigned int p : face.node_points(node))
        {
          act(contact.bound[p]);
          for (unsigned int i = 0; i < 2; ++i)
            {
              act(contact.slip[p][i]);
              act(contact.multiplier[p][i]);
            }
        }
      double none = 0.;
      for (TruncationType *truncation : truncations)
        for (auto *blocks :
             {&truncation->projector, &truncation->spring, &truncation->tilt})
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              act(blocks->empty() ? none : (*blocks)[node][i][j]);
    }



    /// Contact data at nodes, which are vertices of the cells of a rank.
    struct PackedContact
    {
      /// A bit per vertex of a cell with contact points; points per node.
      std::vector<std::uint8_t> vertices, n_points;
      std::vector<double>       values;
      std::vector<bool>         sticks;

      template <typename Archive>
      void
      exchange(Archive &archive)
      {
        archive &vertices &n_points &values &sticks;
      }
    };



    /// The data at the owned cells of a rank, in their order.
    struct PackedPart
    {
      /// A bit for each vertex of a cell with values in this part.
      std::vector<std::uint8_t> vertices;
      std::vector<double>       nodal, samples, estimate;
      PackedContact             points;

      template <typename Archive>
      void
      exchange(Archive &archive)
      {
        archive &vertices &nodal &samples &estimate;
        points.exchange(archive);
      }
    };
  } // namespace



  template <int dim>
  std::string
  pack_fields(const StressSpace<dim>                    &stress_space,
              const ContactFace<dim>                    *face,
              const State<dim>                          &state,
              const std::vector<const FaceTruncation *> &truncations,
              const Vector<double>                      &squared_estimate)
  {
    const AdmissibleSpace<dim> &space  = stress_space.space;
    const auto                  fields = nodal_fields(state);
    std::vector<bool>           is_packed(space.owned.n_elements(), false);
    PackedPart                  part;
    auto &[vertices, nodal, samples, estimate, points] = part;
    const auto  face_nodes                             = nodes_by_dof(face);
    std::size_t owned_cell                             = 0;
    for (const auto &cell : space.cells)
      {
        std::uint8_t with_values = 0, with_points = 0;
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
            const auto node = face_nodes.find(dof);
            if (node == face_nodes.end())
              continue;
            with_points |= 1 << v;
            const ContactLayout &layout = face->layout();
            for_each_value(layout,
                           node->second,
                           state.contact,
                           truncations,
                           [&values = part.points.values](const double value) {
                             values.push_back(value);
                           });
            points.n_points.push_back(layout.node_points(node->second).size());
            for (const unsigned int p : layout.node_points(node->second))
              points.sticks.push_back(state.contact.sticks[p]);
          }
        vertices.push_back(with_values);
        if (face != nullptr)
          points.vertices.push_back(with_points);
        for_each_sample_field(
          state, [&, &samples = samples](const auto &field) {
            if (!field.empty())
              for (unsigned int s = 0; s < stress_space.n_samples; ++s)
                {
                  const auto &sample =
                    field[owned_cell * stress_space.n_samples + s];
                  samples.insert(samples.end(),
                                 sample.begin_raw(),
                                 sample.begin_raw() +
                                   sample.n_independent_components);
                }
          });
        if (squared_estimate.size() > 0)
          estimate.push_back(squared_estimate[cell->active_cell_index()]);
        ++owned_cell;
      }
    if (space.axial)
      for (const DistributedVector *field : fields)
        if (field->size() > 0)
          nodal.push_back(field->begin()[*space.axial]);
    BinaryWriter archive;
    part.exchange(archive);
    return archive.bytes();
  }



  namespace
  {
    /// Return the owned cells of this rank with their index, and its ghost
    /// cells, since values at an owned node may be packed with a ghost cell.
    template <int dim>
    auto
    local_cells(const AdmissibleSpace<dim> &space)
    {
      std::map<CellId,
               std::pair<typename DoFHandler<dim>::active_cell_iterator,
                         std::optional<std::size_t>>>
        result;
      for (std::size_t i = 0; i < space.cells.size(); ++i)
        result[space.cells[i]->id()] = {space.cells[i], i};
      for (const auto &cell : ghost_cells(space.dof_handler))
        result[cell->id()] = {cell, std::nullopt};
      return result;
    }



    /// Read the values of all fields at vertices of a cell with bits in @p
    /// vertices, from position @p next on. @p cell is null if not on this rank.
    /// Returns how many of these vertices are nodes owned by this rank.
    template <typename Cell>
    unsigned int
    read_nodes(const std::uint8_t              vertices,
               const Cell *const               cell,
               const IndexSet                 &owned,
               const std::vector<double>      &nodal,
               std::size_t                    &next,
               std::vector<DistributedVector> &values)
    {
      constexpr unsigned int dim = Cell::AccessorType::dimension;
      unsigned int           n   = 0;
      for (const unsigned int v : GeometryInfo<dim>::vertex_indices())
        if ((vertices >> v & 1) != 0)
          {
            const std::size_t first = next;
            next += values.size() * dim;
            require_sense(next <= nodal.size());
            if (cell == nullptr)
              continue;
            const auto dof = (*cell)->vertex_dof_index(v, 0);
            if (!owned.is_element(dof))
              continue;
            for (unsigned int f = 0; f < values.size(); ++f)
              std::copy_n(&nodal[first + f * dim],
                          dim,
                          values[f].begin() + owned.index_within_set(dof));
            ++n;
          }
      return n;
    }



    /// Reads contact data at nodes, packed by one rank, in their order.
    class ContactReader
    {
    public:
      ContactReader(const PackedContact                 &packed,
                    const ContactLayout                 &layout,
                    ContactState                        &contact,
                    const std::vector<FaceTruncation *> &truncations)
        : packed(packed)
        , layout(layout)
        , contact(contact)
        , truncations(truncations)
      {}

      /// Read the data at vertices of a cell with bits in @p vertices. @p cell
      /// is null if not on this rank. Returns how many of these vertices are
      /// nodes of the face.
      template <typename Cell>
      unsigned int
      read(const std::uint8_t                                     vertices,
           const Cell *const                                      cell,
           const std::map<types::global_dof_index, unsigned int> &face_nodes)
      {
        unsigned int n = 0;
        for (const unsigned int v :
             GeometryInfo<Cell::AccessorType::dimension>::vertex_indices())
          if ((vertices >> v & 1) != 0)
            {
              const auto node =
                cell != nullptr ?
                  face_nodes.find((*cell)->vertex_dof_index(v, 0)) :
                  face_nodes.end();
              const bool is_here = node != face_nodes.end();
              read(is_here ? std::optional(node->second) : std::nullopt);
              n += is_here;
            }
        return n;
      }

      bool
      is_at_end() const
      {
        return next_node == packed.n_points.size() &&
               next_point == packed.sticks.size() &&
               next_value == packed.values.size();
      }

    private:
      /// Read the next packed node into @p node, or skip it if that is empty.
      void
      read(const std::optional<unsigned int> node)
      {
        require_sense(next_node < packed.n_points.size());
        const unsigned int n_points = packed.n_points[next_node++];
        const std::size_t  value = next_value, point = next_point;
        next_point += n_points;
        next_value += n_points * 5 + truncations.size() * 27;
        require_sense(next_point <= packed.sticks.size() &&
                      next_value <= packed.values.size());
        if (!node)
          return;
        require_sense(n_points == layout.node_points(*node).size());
        const double *from = packed.values.data() + value;
        for_each_value(layout, *node, contact, truncations, [&](double &to) {
          to = *from++;
        });
        for (unsigned int p = 0; p < n_points; ++p)
          contact.sticks[layout.first_point[*node] + p] =
            packed.sticks[point + p];
      }

      const PackedContact                 &packed;
      const ContactLayout                 &layout;
      ContactState                        &contact;
      const std::vector<FaceTruncation *> &truncations;
      std::size_t next_node = 0, next_point = 0, next_value = 0;
    };
  } // namespace



  template <int dim>
  bool
  unpack_fields(const PackedFields                  &packed,
                const StressSpace<dim>              &stress_space,
                const ContactFace<dim>              *face,
                State<dim>                          &state,
                const std::vector<FaceTruncation *> &truncations,
                Vector<double>                      &squared_estimate)
  {
    AssertDimension(packed.meshes.size(), packed.fields.size());
    const AdmissibleSpace<dim> &space = stress_space.space;
    const auto &triangulation         = space.dof_handler.get_triangulation();
    std::vector<DistributedVector *> targets; // the packed ones
    for (unsigned int f = 0; f < packed.has_nodal_field.size(); ++f)
      if (packed.has_nodal_field[f])
        targets.push_back(nodal_fields(state)[f]);
    const unsigned int n_fields  = targets.size();
    const auto        &is_packed = packed.has_sample_field;
    const std::size_t  n_z = stress_space.n_samples * 6, // per cell and field
      n_sampled =
        n_z * std::count(is_packed.begin(), is_packed.end(), true); // per cell

    const auto                     cells = local_cells(space);
    std::vector<DistributedVector> values(n_fields, space.owned_vector());
    const bool                    *is_present = is_packed.data();
    for_each_sample_field(state, [&](auto &field) {
      field.resize(*is_present++ ? space.cells.size() * stress_space.n_samples :
                                   0);
    });
    if (packed.has_estimate)
      squared_estimate.reinit(triangulation.n_active_cells());
    const auto           face_nodes = nodes_by_dof(face);
    const ContactLayout  no_face;
    const ContactLayout &layout = face != nullptr ? face->layout() : no_face;
    state.contact = ContactState(std::vector<double>(layout.points.size()));
    for (FaceTruncation *truncation : truncations)
      for (auto *blocks :
           {&truncation->projector, &truncation->spring, &truncation->tilt})
        blocks->resize(layout.n_nodes());
    std::size_t n_values = 0, n_face_nodes = 0, n_cells = 0;
    for (std::size_t p = 0; p < packed.meshes.size(); ++p)
      {
        const std::vector<CellId> ids =
          unpack_mesh<dim>(packed.meshes[p], triangulation.n_cells(0));
        PackedPart   part;
        BinaryReader archive(packed.fields[p]);
        part.exchange(archive);
        const auto &[vertices, nodal, samples, estimate, points] = part;
        require_sense(archive.is_at_end() && vertices.size() == ids.size() &&
                      points.vertices.size() == (face ? ids.size() : 0) &&
                      samples.size() == n_sampled * ids.size() &&
                      estimate.size() ==
                        (packed.has_estimate ? ids.size() : 0));
        ContactReader of_nodes(points, layout, state.contact, truncations);
        std::size_t   next = 0;
        for (std::size_t i = 0; i < ids.size(); ++i)
          {
            const auto  found    = cells.find(ids[i]);
            const bool  is_known = found != cells.end();
            const auto *cell     = is_known ? &found->second.first : nullptr;
            n_values +=
              read_nodes(vertices[i], cell, space.owned, nodal, next, values);
            if (face)
              n_face_nodes +=
                of_nodes.read(points.vertices[i], cell, face_nodes);
            if (!is_known || !found->second.second)
              continue;
            ++n_cells;
            const double *from = samples.data() + i * n_sampled;
            for_each_sample_field(state, [&](auto &field) {
              if (!field.empty())
                for (std::size_t j = 0; j < n_z; ++j)
                  field[*found->second.second * stress_space.n_samples + j / 6]
                    .begin_raw()[j % 6] = *from++;
            });
            if (packed.has_estimate)
              squared_estimate[found->second.first->active_cell_index()] =
                estimate[i];
          }
        if (space.axial)
          {
            require_sense(next + n_fields <= nodal.size());
            const auto axial = space.owned_axial();
            for (unsigned int f = 0; axial && f < n_fields; ++f)
              values[f].begin()[*axial] = nodal[next + f];
            next += n_fields;
          }
        require_sense(next == nodal.size() && of_nodes.is_at_end());
      }

    for (FaceTruncation *truncation : truncations)
      if (std::all_of(truncation->tilt.begin(),
                      truncation->tilt.end(),
                      [](const Tensor<2, 3> &tilt) {
                        return tilt.norm_square() == 0.;
                      }))
        truncation->tilt.clear(); // there is none
    for (unsigned int f = 0; f < n_fields; ++f)
      {
        *targets[f] = space.ghosted_vector();
        *targets[f] = values[f];
      }
    return n_cells == space.cells.size() &&
           n_values * dim == space.dof_handler.n_locally_owned_dofs() &&
           n_face_nodes == face_nodes.size();
  }



  VISCOPLASTIC_INSTANTIATE(pack_fields);
  VISCOPLASTIC_INSTANTIATE(unpack_fields);
} // namespace Viscoplastic
