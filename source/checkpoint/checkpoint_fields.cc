// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/checkpoint/checkpoint_fields.h>
#include <viscoplastic_contact/mesh/cell_order.h>

namespace Viscoplastic
{
  template <int dim>
  std::vector<unsigned int>
  pack_mesh(const parallel::distributed::Triangulation<dim> &triangulation)
  {
    std::vector<unsigned int> words;
    for (const auto &cell : owned_cells(triangulation))
      {
        const auto binary = cell->id().template to_binary<dim>();
        words.insert(words.end(), binary.begin(), binary.end());
      }
    return words;
  }



  template <int dim>
  void
  restore_mesh(const std::vector<std::vector<unsigned int>> &parts,
               parallel::distributed::Triangulation<dim>    &triangulation)
  {
    std::vector<CellId> leaves;
    CellId::binary_type binary;
    for (const auto &words : parts)
      for (std::size_t i = 0; i < words.size(); i += binary.size())
        {
          std::copy_n(&words[i], binary.size(), binary.begin());
          leaves.emplace_back(binary);
        }
    // CellId orders a cell before its descendants, these before the next cell.
    std::sort(leaves.begin(), leaves.end());

    constexpr unsigned int max_passes = 100; // three times the levels of p4est
    for (unsigned int pass = 0; pass < max_passes; ++pass)
      {
        bool differs = false;
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
            else
              cell->set_coarsen_flag();
          }
        if (!Utilities::MPI::logical_or(differs,
                                        triangulation.get_communicator()))
          return;
        triangulation.execute_coarsening_and_refinement();
      }
    refuse("The mesh of the checkpoint cannot be made.");
  }



  template <int dim>
  std::string
  checksum_of_coarse_mesh(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    std::string bytes;
    const auto  add = [&bytes](const auto value) {
      bytes.append(reinterpret_cast<const char *>(&value), sizeof(value));
    };
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      {
        add(cell->material_id());
        for (const unsigned int v : cell->vertex_indices())
          {
            add(cell->vertex_index(v));
            // Files of other formats round vertices; zero has no sign.
            for (unsigned int d = 0; d < dim; ++d)
              add(static_cast<float>(cell->vertex(v)[d]) + 0.f);
          }
        for (const unsigned int f : cell->face_indices())
          add(cell->face(f)->boundary_id());
      }
    return std::to_string(checksum(bytes));
  }



  template <int dim>
  std::vector<bool>
  fields_present(const State<dim> &state, const MPI_Comm communicator)
  {
    std::vector<bool> result;
    for (const DistributedVector *field : nodal_fields(state))
      result.push_back(field->size() > 0);
    // Ranks without cells have no samples.
    for_each_sample_field(state, [&](const auto &field) {
      result.push_back(
        Utilities::MPI::logical_or(!field.empty(), communicator));
    });
    return result;
  }



  namespace
  {
    /// The owned cells in the order of p4est, as indices of
    /// AdmissibleSpace::cells, in which coarse cells stand in another order.
    template <int dim>
    std::vector<std::size_t>
    order_of_p4est(const AdmissibleSpace<dim> &space)
    {
      std::vector<std::pair<types::coarse_cell_id, std::size_t>> by_tree;
      for (const auto &cell : space.cells)
        by_tree.emplace_back(cell->id().get_coarse_cell_id(), by_tree.size());
      std::sort(by_tree.begin(), by_tree.end());
      std::vector<std::size_t> result;
      for (const auto &entry : by_tree)
        result.push_back(entry.second);
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
          double sticks = contact.sticks[p];
          act(sticks);
          if constexpr (!std::is_const_v<StateType>)
            contact.sticks[p] = sticks != 0.;
        }
      double none = 0.;
      for (TruncationType *truncation : truncations)
        for (auto *blocks :
             {&truncation->projector, &truncation->spring, &truncation->tilt})
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              act(blocks->empty() ? none : (*blocks)[node][i][j]);
    }



    /// Call @p begin_cell for each owned cell in the order of p4est, then
    /// act(value) with a reference to each number at the cell: of those nodes
    /// that are at no earlier cell, and of the cell itself. A node belongs to
    /// the rank of its first cell, so that the numbers at a cell are the same
    /// on any number of ranks.
    template <int dim,
              typename StateType,
              typename TruncationType,
              typename Estimate,
              typename Begin,
              typename Action>
    void
    for_each_value(const StressSpace<dim>              &stress_space,
                   const ContactFace<dim>              *face,
                   StateType                           &state,
                   const std::vector<TruncationType *> &truncations,
                   Estimate                            &squared_estimate,
                   const Begin                         &begin_cell,
                   const Action                        &act)
    {
      const AdmissibleSpace<dim> &space = stress_space.space;
      std::map<types::global_dof_index, unsigned int> face_nodes;
      for (unsigned int node = 0; face && node < face->layout().n_nodes();
           ++node)
        face_nodes[face->first_dof(node)] = node;
      std::vector<bool> is_done(space.owned.n_elements(), false);
      const auto        fields = nodal_fields(state);
      for (const std::size_t c : order_of_p4est(space))
        {
          begin_cell();
          const auto &cell = space.cells[c];
          for (const unsigned int v : cell->vertex_indices())
            {
              const auto dof = cell->vertex_dof_index(v, 0);
              if (!space.owned.is_element(dof) ||
                  is_done[space.owned.index_within_set(dof)])
                continue;
              is_done[space.owned.index_within_set(dof)] = true;
              for (auto *field : fields)
                for (unsigned int d = 0; field->size() > 0 && d < dim; ++d)
                  act(field->begin()[space.relevant.index_within_set(dof) + d]);
              if (const auto node = face_nodes.find(dof);
                  node != face_nodes.end())
                for_each_value(face->layout(),
                               node->second,
                               state.contact,
                               truncations,
                               act);
            }
          for (auto *field : fields)
            if (space.axial && field->size() > 0)
              act(field->begin()[*space.axial]);
          for_each_sample_field(state, [&](auto &field) {
            if (!field.empty())
              for (unsigned int s = 0; s < stress_space.n_samples; ++s)
                for (unsigned int i = 0; i < 6; ++i)
                  act(field[c * stress_space.n_samples + s].begin_raw()[i]);
          });
          if (squared_estimate.size() > 0)
            act(squared_estimate[cell->active_cell_index()]);
        }
    }
  } // namespace



  template <int dim>
  CellValues
  pack_fields(const StressSpace<dim>                    &stress_space,
              const ContactFace<dim>                    *face,
              const State<dim>                          &state,
              const std::vector<const FaceTruncation *> &truncations,
              const Vector<double>                      &squared_estimate)
  {
    CellValues result;
    for_each_value(
      stress_space,
      face,
      state,
      truncations,
      squared_estimate,
      [&]() { result.sizes.push_back(0); },
      [&](const double value) {
        result.values.push_back(value);
        ++result.sizes.back();
      });
    return result;
  }



  template <int dim>
  void
  unpack_fields(const CellValues                    &packed,
                const std::vector<bool>             &present,
                const StressSpace<dim>              &stress_space,
                const ContactFace<dim>              *face,
                State<dim>                          &state,
                const std::vector<FaceTruncation *> &truncations,
                Vector<double>                      &squared_estimate)
  {
    const AdmissibleSpace<dim> &space      = stress_space.space;
    auto                        is_present = present.begin();
    for (DistributedVector *field : nodal_fields(state))
      *field = *is_present++ ? space.ghosted_vector() : DistributedVector();
    for_each_sample_field(state, [&](auto &field) {
      field.resize(*is_present++ ? space.cells.size() * stress_space.n_samples :
                                   0);
    });
    state.contact = ContactState(
      std::vector<double>(face ? face->layout().points.size() : 0));
    for (FaceTruncation *truncation : truncations)
      for (auto *blocks :
           {&truncation->projector, &truncation->spring, &truncation->tilt})
        blocks->resize(face ? face->layout().n_nodes() : 0);

    bool        fits = packed.sizes.size() == space.cells.size();
    auto        size = packed.sizes.begin();
    std::size_t next = 0, end = 0; // of the values of a cell
    if (fits)
      for_each_value(
        stress_space,
        face,
        state,
        truncations,
        squared_estimate,
        [&]() {
          fits = fits && next == end;
          end += *size++;
        },
        [&](auto &value) {
          fits = fits && next < end;
          if (fits)
            value = packed.values[next++];
        });
    fits = fits && next == packed.values.size();
    if (Utilities::MPI::logical_or(!fits, space.communicator))
      refuse("its fields do not fit the scene");

    for (FaceTruncation *truncation : truncations)
      if (std::all_of(truncation->tilt.begin(),
                      truncation->tilt.end(),
                      [](const Tensor<2, 3> &tilt) {
                        return tilt.norm_square() == 0.;
                      }))
        truncation->tilt.clear(); // there is none
    for (DistributedVector *field : nodal_fields(state))
      if (field->size() > 0)
        space.renew_ghosts(*field);
  }



  VISCOPLASTIC_INSTANTIATE(pack_mesh);
  VISCOPLASTIC_INSTANTIATE(restore_mesh);
  VISCOPLASTIC_INSTANTIATE(checksum_of_coarse_mesh);
  VISCOPLASTIC_INSTANTIATE(fields_present);
  VISCOPLASTIC_INSTANTIATE(pack_fields);
  VISCOPLASTIC_INSTANTIATE(unpack_fields);
} // namespace Viscoplastic
