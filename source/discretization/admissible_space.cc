// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/dofs/dof_tools.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/discretization/conditions_at_nodes.h>
#include <viscoplastic_contact/mesh/cell_order.h>
#include <viscoplastic_contact/mesh/cell_shapes.h>
#include <viscoplastic_contact/mesh/mesh_size.h>

namespace Viscoplastic
{
  template <int dim>
  void
  distribute_nodes(const FiniteElement<dim> &fe, DoFHandler<dim> &dof_handler)
  {
    dof_handler.distribute_dofs(fe);
    const IndexSet owned = dof_handler.locally_owned_dofs();
    std::vector<types::global_dof_index> new_numbers(
      owned.n_elements(), numbers::invalid_dof_index);
    std::vector<types::global_dof_index> dofs(fe.n_dofs_per_cell());
    std::size_t                          n_numbered = 0;
    for (const auto &cell : owned_cells(dof_handler))
      {
        cell->get_dof_indices(dofs);
        for (const auto dof : dofs)
          if (owned.is_element(dof))
            if (auto &number = new_numbers[owned.index_within_set(dof)];
                number == numbers::invalid_dof_index)
              number = owned.nth_index_in_set(n_numbered++);
      }
    dof_handler.renumber_dofs(new_numbers);
  }



  namespace
  {
    template <int dim>
    AffineConstraints<double>
    hanging_nodes_of(const DoFHandler<dim> &dof_handler)
    {
      AffineConstraints<double> result(
        DoFTools::extract_locally_relevant_dofs(dof_handler));
      DoFTools::make_hanging_node_constraints(dof_handler, result);
      result.close();
      return result;
    }



    template <int dim>
    std::unique_ptr<const SurfaceNormals<dim>>
    make_surface_normals(const DoFHandler<dim> &dof_handler,
                         const Scene<dim>      &scene)
    {
      return scene.on_any_boundary(
               [](const auto &b) { return b.normal_varies; }) ?
               std::make_unique<const SurfaceNormals<dim>>(
                 dof_handler, hanging_nodes_of(dof_handler), scene) :
               nullptr;
    }



    template <int dim>
    std::map<types::boundary_id, MortarRows>
    make_mortar_rows(const AdmissibleSpace<dim> &space)
    {
      std::map<types::boundary_id, MortarRows> result;
      const DoFHandler<dim>                   &dof_handler = space.dof_handler;
      AffineConstraints<double>                hanging_nodes;
      for (const auto &[id, condition] : space.scene.boundary)
        if (condition.against)
          {
            if (result.empty())
              hanging_nodes = hanging_nodes_of(dof_handler);
            result[id] =
              mortar_interpolation<dim>(dof_handler,
                                        hanging_nodes,
                                        space.contact_pair(condition));
            if (space.scene.contact_changes_with_stages())
              {
                ContactPair<dim> of_absent = space.contact_pair(condition);
                of_absent.of_absent        = true;
                result[id].merge(mortar_interpolation<dim>(dof_handler,
                                                           hanging_nodes,
                                                           of_absent));
                continue;
              }
            if (Utilities::MPI::max(result[id].size(),
                                    dof_handler.get_communicator()) == 0)
              refuse(
                "Nothing of boundary " + std::to_string(*condition.against) +
                " lies opposite to the nodes of boundary " +
                std::to_string(id) + " along its normal, though 'Boundary " +
                std::to_string(id) + "/Against' says so.");
          }
      return result;
    }



    /// Return the degrees of freedom of the mesh and, if any, the axial ones,
    /// see AdmissibleSpace::axial.
    template <int dim>
    IndexSet
    with_axial_dofs(const DoFHandler<dim> &dof_handler,
                    const Scene<dim>      &scene,
                    const IndexSet        &of_mesh,
                    const bool             is_relevant)
    {
      if (!scene.is_generalized())
        return of_mesh;
      const auto n = dof_handler.n_dofs();
      IndexSet   result(n + dim);
      result.add_indices(of_mesh);
      const MPI_Comm comm = dof_handler.get_communicator();
      if (is_relevant || Utilities::MPI::this_mpi_process(comm) + 1 ==
                           Utilities::MPI::n_mpi_processes(comm))
        result.add_range(n, n + dim);
      result.compress();
      return result;
    }



    template <int dim>
    IndexSet
    relevant_dofs(const DoFHandler<dim>                          &dof_handler,
                  const Scene<dim>                               &scene,
                  const std::map<types::boundary_id, MortarRows> &mortar_rows)
    {
      IndexSet result =
        with_axial_dofs(dof_handler,
                        scene,
                        DoFTools::extract_locally_relevant_dofs(dof_handler),
                        true);
      for (const auto &of_boundary : mortar_rows)
        for (const auto &[node, row] : of_boundary.second)
          for (const auto &other : row.nodes)
            result.add_range(other.node * dim, (other.node + 1) * dim);
      result.compress();
      return result;
    }



    /// u := matrix u, for the components of a node.
    template <int dim>
    void
    multiply(const Tensor<2, dim> &matrix, double *const u)
    {
      Tensor<1, dim> v;
      std::copy_n(u, dim, v.begin_raw());
      v = matrix * v;
      std::copy_n(v.begin_raw(), dim, u);
    }



    template <int dim>
    std::vector<unsigned int>
    shapes_of(
      const std::vector<typename DoFHandler<dim>::active_cell_iterator> &cells,
      const PlaneModel                                                   model)
    {
      CellShapes<dim>           number_of(model);
      std::vector<unsigned int> result;
      result.reserve(cells.size());
      for (const auto &cell : cells)
        result.push_back(number_of.add(cell).first);
      return result;
    }
  } // namespace



  template <int dim>
  AdmissibleSpace<dim>::AdmissibleSpace(const DoFHandler<dim> &dof_handler,
                                        const Scene<dim>      &scene)
    : dof_handler(dof_handler)
    , scene(scene)
    , communicator(dof_handler.get_communicator())
    , mapping(mapping_of<dim>(scene.plane_model()))
    , surface_normals(make_surface_normals(dof_handler, scene))
    , mortar_rows(make_mortar_rows(*this))
    , owned(with_axial_dofs(dof_handler,
                            scene,
                            dof_handler.locally_owned_dofs(),
                            false))
    , relevant(relevant_dofs(dof_handler, scene, mortar_rows))
    , axial(scene.is_generalized() ?
              std::make_optional<std::size_t>(relevant.n_elements() - dim) :
              std::nullopt)
    , axial_length(scene.is_generalized() ?
                     body_diagonal(dof_handler.get_triangulation()) :
                     1.)
    , cells(owned_cells(dof_handler))
    , shapes(shapes_of<dim>(cells, scene.plane_model()))
    , first_owned(owned.n_elements() > 0 ?
                    relevant.index_within_set(owned.nth_index_in_set(0)) :
                    0)
    , node_position(dof_handler.n_locally_owned_dofs() / dim)
  {
    if (!(Utilities::MPI::max(dof_handler.n_dofs(), communicator) <
          static_cast<types::global_dof_index>(
            std::numeric_limits<int>::max())))
      refuse("The mesh has more than 2^31 degrees of freedom, which this build "
             "of Trilinos cannot index.");
    hanging_cartesian.reinit(relevant);
    DoFTools::make_hanging_node_constraints(dof_handler, hanging_cartesian);
    hanging_cartesian.close();
    any_hanging =
      Utilities::MPI::max(hanging_cartesian.n_constraints(), communicator) > 0;

    for (const auto &cell : cells)
      for (const unsigned int v : cell->vertex_indices())
        {
          const auto dof = cell->vertex_dof_index(v, 0);
          Assert(cell->vertex_dof_index(v, dim - 1) == dof + dim - 1,
                 ExcMessage("The components of a node must be consecutive."));
          if (owned.is_element(dof))
            node_position[owned.index_within_set(dof) / dim] = cell->vertex(v);
        }
    make_frames();
    if (!mortar_rows.empty())
      make_couplings();
    check_rigid_motions();
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::renew_ghosts(DistributedVector &vector) const
  {
    DistributedVector entries = owned_vector();
    for (std::size_t i = 0; i < owned.n_elements(); ++i)
      entries.begin()[i] = vector(owned.nth_index_in_set(i));
    vector = ghosted_vector();
    vector = entries;
  }



  template <int dim>
  types::global_dof_index
  AdmissibleSpace<dim>::n_first_dofs() const
  {
    const Triangulation<dim> &triangulation = dof_handler.get_triangulation();
    if (triangulation.n_global_levels() < 2)
      return 0;
    // All ranks have all coarse cells.
    std::vector<bool> is_vertex(triangulation.n_vertices(), false);
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      for (const unsigned int v : cell->vertex_indices())
        is_vertex[cell->vertex_index(v)] = true;
    return std::count(is_vertex.begin(), is_vertex.end(), true) * dim;
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::make_frames()
  {
    // A node's frame is a function of the conditions at the node and, on curved
    // boundaries, of its normal. Their bit masks are sent to other ranks in a
    // vector.
    const auto [listed, mask, waits] = conditions_at_nodes(
      dof_handler, scene, hanging_cartesian, mortar_rows, node_position);

    DistributedVector masks = owned_vector(), ghosted_masks = ghosted_vector();
    for (std::size_t n = 0; n < mask.size(); ++n)
      masks.begin()[n * dim] = static_cast<double>(mask[n]);
    ghosted_masks = masks;

    frames.assign(1, make_nodal_frame<dim>({}));
    std::map<std::uint64_t, unsigned int> frame_of_mask{{0, 0}};
    frame_of_node.assign(relevant.n_elements() / dim, 0);
    std::uint64_t curved = 0;
    for (unsigned int i = 0; i < listed.size(); ++i)
      if (listed[i]->normal_varies)
        curved |= std::uint64_t(1) << i;
    for (std::size_t n = 0; n < frame_of_node.size(); ++n)
      {
        const auto bits =
          static_cast<std::uint64_t>(ghosted_masks.begin()[n * dim]);
        if (frame_of_mask.count(bits) == 0 || (bits & curved) != 0)
          {
            std::vector<const BoundaryCondition<dim> *> here;
            for (unsigned int i = 0; i < listed.size(); ++i)
              if (bits & (std::uint64_t(1) << i))
                here.push_back(listed[i]);
            frame_of_mask[bits] = frames.size();
            frames.push_back(make_nodal_frame<dim>(
              here,
              (bits & curved) != 0 ?
                surface_normals->at(relevant.nth_index_in_set(n * dim)) :
                Tensor<1, dim>()));
          }
        frame_of_node[n] = frame_of_mask[bits];
        if (!frames[frame_of_node[n]].is_cartesian)
          rotated_nodes.push_back(n * dim);
      }

    is_excluded.assign(owned.n_elements(), false);
    if (const auto of_section = owned_axial())
      for (std::size_t i = *of_section; i < is_excluded.size(); ++i)
        is_excluded[i] = i > *of_section || scene.axial_strain;
    for (std::size_t n = 0; n < mask.size(); ++n)
      {
        const auto first_dof = owned.nth_index_in_set(n * dim);
        if (mask[n] != 0)
          {
            nodes.push_back(
              {first_dof,
               node_position[n],
               frame_of_node[relevant.index_within_set(first_dof) / dim]});
            const NodalFrame<dim> &frame = frames[nodes.back().frame];
            for (unsigned int i = 0; i < frame.n_fixed; ++i)
              is_excluded[n * dim + frame.fixed[i]] = true;
          }
        if (!waits.empty() && waits[n])
          for (unsigned int d = 0; d < dim; ++d)
            is_excluded[n * dim + d] = true;
        if (hanging_cartesian.is_constrained(first_dof))
          for (unsigned int d = 0; d < dim; ++d)
            {
              is_excluded[n * dim + d] = true;
              hanging_entries.push_back(n * dim + d);
            }
      }
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::add_cartesian_load(std::vector<double> &cartesian,
                                           DistributedVector   &load) const
  {
    AssertDimension(cartesian.size(), relevant.n_elements());
    if (any_hanging)
      for (const auto &line : hanging_cartesian.get_lines())
        {
          double &share = cartesian[relevant.index_within_set(line.index)];
          if (share != 0.)
            for (const auto &[master, weight] : line.entries)
              cartesian[relevant.index_within_set(master)] += weight * share;
          share = 0.;
        }
    for (const Coupling &coupling : couplings)
      {
        Tensor<1, dim> f;
        for (unsigned int d = 0; d < dim; ++d)
          f[d] = cartesian[coupling.node + d];
        f = coupling.projector * f;
        for (const auto &[other, weight] : coupling.others)
          for (unsigned int d = 0; d < dim; ++d)
            cartesian[other + d] += weight * f[d];
      }
    for (const std::size_t n : rotated_nodes)
      multiply(transpose(frames[frame_of_node[n / dim]].directions),
               &cartesian[n]);

    const std::size_t n_owned = owned.n_elements();
    for (std::size_t i = 0; i < n_owned; ++i)
      load.begin()[i] += cartesian[first_owned + i];
    if (Utilities::MPI::n_mpi_processes(communicator) > 1)
      {
        std::vector<types::global_dof_index> indices;
        std::vector<double>                  values;
        for (std::size_t i = 0; i < cartesian.size(); ++i)
          if ((i < first_owned || i >= first_owned + n_owned) &&
              cartesian[i] != 0.)
            {
              indices.push_back(relevant.nth_index_in_set(i));
              values.push_back(cartesian[i]);
            }
        load.add(indices, values);
        load.compress(VectorOperation::add);
      }
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::to_cartesian(const DistributedVector &in_frames,
                                     DistributedVector       &ghosted) const
  {
    DistributedVector cartesian(in_frames);
    for (const std::size_t n : rotated_nodes)
      if (n >= first_owned && n < first_owned + owned.n_elements())
        multiply(frames[frame_of_node[n / dim]].directions,
                 cartesian.begin() + (n - first_owned));
    if (!mortar_rows.empty())
      {
        ghosted = cartesian;
        add_opposite(1., ghosted, cartesian);
      }
    distribute_hanging_nodes(cartesian);
    ghosted = cartesian;
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::to_frames(const DistributedVector &ghosted,
                                  DistributedVector       &in_frames) const
  {
    const double *u = ghosted.begin();
    for (std::size_t i = 0; i < owned.n_elements(); ++i)
      in_frames.begin()[i] = u[first_owned + i];
    add_opposite(-1., ghosted, in_frames);
    for (const std::size_t n : rotated_nodes)
      if (n >= first_owned && n < first_owned + owned.n_elements())
        multiply(transpose(frames[frame_of_node[n / dim]].directions),
                 in_frames.begin() + (n - first_owned));
    for (const std::size_t i : hanging_entries)
      in_frames.begin()[i] = 0.;
  }



  template <int dim>
  Tensor<1, dim>
  AdmissibleSpace<dim>::prescribed_at(const BoundaryNode &node,
                                      const double        t) const
  {
    const NodalFrame<dim> &frame = frames[node.frame];
    Tensor<1, dim>         datum;
    for (unsigned int i = 0; i < frame.n_fixed; ++i)
      {
        const auto &condition = scene.condition(frame.condition_boundary[i]);
        if (condition.role == BoundaryRole::displacement)
          datum[i] =
            condition.displacement[frame.condition_component[i]]->value(
              node.position, t);
        else if (condition.is_glued())
          datum[i] =
            condition.glued_displacement(node.position,
                                         normal_at(node.first_dof, condition),
                                         t)[frame.condition_component[i]];
        else if (condition.foundation_displacement)
          datum[i] = condition.foundation_displacement->value(node.position, t);
      }
    return invert(condition_matrix(frame)) * datum;
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::set_prescribed(const double       t,
                                       DistributedVector &in_frames) const
  {
    const auto first = owned.n_elements() > 0 ? owned.nth_index_in_set(0) : 0;
    if (const auto of_section = owned_axial(); of_section && scene.axial_strain)
      in_frames.begin()[*of_section] =
        axial_length * scene.axial_strain->value(Point<dim>(), t);
    for (const BoundaryNode &node : nodes)
      {
        const NodalFrame<dim> &frame = frames[node.frame];
        if (frame.n_fixed == 0)
          continue;
        const Tensor<1, dim> value = prescribed_at(node, t);
        for (unsigned int j = 0; j < frame.n_fixed; ++j)
          in_frames.begin()[node.first_dof - first + frame.fixed[j]] = value[j];
      }
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(AdmissibleSpace);
  VISCOPLASTIC_INSTANTIATE(distribute_nodes);
} // namespace Viscoplastic
