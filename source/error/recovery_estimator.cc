// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>

#include <viscoplastic_contact/error/recovery_estimator.h>

namespace Viscoplastic
{
  template <int dim>
  RecoveryEstimator<dim>::RecoveryEstimator(const LocalCells<dim> &cells)
    : local(cells)
  {
    const AdmissibleSpace<dim>      &space   = cells.stress_space.space;
    const AffineConstraints<double> &hangs   = space.cartesian_hanging_nodes();
    constexpr unsigned int           n       = n_components;
    const auto                       dofs_of = [&](const IndexSet &of_nodes) {
      IndexSet result(of_nodes.size() / dim * n);
      for (auto range = of_nodes.begin_intervals();
           range != of_nodes.end_intervals();
           ++range)
        result.add_range(*range->begin() / dim * n,
                         (range->last() + 1) / dim * n);
      return result;
    };
    values.reinit(dofs_of(space.owned),
                  dofs_of(space.relevant),
                  space.communicator);
    const auto place = [&](const types::global_dof_index dof) {
      return values.get_partitioner()->global_to_local(dof / dim * n);
    };

    // The parts of all ranks, which exchange nodal sums together.
    std::map<types::material_id, unsigned int> part_of;
    bool                                       is_mirrored = true;
    for (const auto &cell :
         space.dof_handler.get_triangulation().cell_iterators_on_level(0))
      if (const auto id = cell->material_id(); space.scene.is_present(id))
        {
          part_of.emplace(id, part_of.size());
          is_mirrored &= !space.scene.material(id).is_anisotropic();
        }
    std::set<types::boundary_id> planes;
    for (const auto &[id, condition] : space.scene.boundary)
      if (is_mirrored && condition.role == BoundaryRole::symmetry)
        {
          planes.insert(id);
          Tensor<1, 3> normal;
          for (unsigned int d = 0; d < dim; ++d)
            normal[d] = condition.normal[d];
          for (const auto dof : DoFTools::extract_boundary_dofs(
                 space.dof_handler,
                 space.dof_handler.get_fe().component_mask(
                   FEValuesExtractors::Scalar(0)),
                 {id}))
            mirrored.emplace_back(place(dof), normal);
        }
    const auto       &partitioner = *values.get_partitioner();
    const std::size_t n_nodes =
      (partitioner.locally_owned_size() + partitioner.n_ghost_indices()) / n;
    parts.resize(part_of.size());
    for (const auto &[id, p] : part_of)
      {
        Part &part = parts[p];
        // Strains grow at most like r^(-n/(n+1)) with the exponent n of a power
        // law (Hutchinson, Rice and Rosengren, 1968); n = 9 is assumed for all
        // nonlinear laws.
        const auto  &law      = space.scene.material(id).law;
        const double exponent = law && !law->has_constant_tangents() ? 9. : 1.;
        part.largest_share    = std::exp2(-2. / (exponent + 1.));
        part.inverse_weight.resize(n_nodes);
        part.inverse_inner_weight.resize(n_nodes);
        if (part.largest_share > 0.5 && sums.size() == 0)
          {
            sums.reinit(values);
            maxima.reinit(values);
          }
      }

    // In the section: volumes of rings vary for cells of one size.
    for (const Cell &cell : local.cells)
      {
        const auto    &shape  = local.shapes[cell.shape];
        Tensor<1, dim> center = cell.origin;
        for (const Tensor<1, dim> &position : shape.positions)
          center += position / n_points;
        widths.push_back(
          std::pow(shape.volume /
                     extent(space.scene.plane_model(), Point<dim>(center)),
                   1. / dim));
      }
    std::vector<std::map<types::global_dof_index, unsigned int>> hanging(
      parts.size());
    for (unsigned int c = 0; c < cells.stress_space.n_cells(); ++c)
      {
        const auto &cell = space.cells[c];
        nodes.emplace_back();
        ends.emplace_back();
        for (unsigned int v = 0; v < n_vertices; ++v)
          nodes[c][v] = place(cell->vertex_dof_index(v, 0));
        if (!cells.cells[c].is_present)
          continue;
        const unsigned int           p = part_of.at(cells.cells[c].material_id);
        std::array<bool, n_vertices> is_at_end{};
        for (const unsigned int face : cell->face_indices())
          if (cell->at_boundary(face) ?
                planes.count(cell->face(face)->boundary_id()) == 0 :
                cell->neighbor(face)->material_id() != cell->material_id())
            for (unsigned int v = 0; v < n_vertices / 2; ++v)
              is_at_end[GeometryInfo<dim>::face_to_cell_vertices(face, v)] =
                true;
        for (unsigned int v = 0; v < n_vertices; ++v)
          if (is_at_end[v] && !is_at_end[opposite(v)])
            {
              ends[c].set(v);
              parts[p].inverse_inner_weight[nodes[c][v] / n] += 1. / widths[c];
            }
        parts[p].cells.push_back(c);
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            const types::global_dof_index dof = cell->vertex_dof_index(v, 0);
            parts[p].inverse_weight[nodes[c][v] / n] += 1. / widths[c];
            if (hangs.is_constrained(dof))
              hanging[p].emplace(dof, nodes[c][v]);
          }
      }
    for (unsigned int p = 0; p < parts.size(); ++p)
      {
        for (auto *weights :
             {&parts[p].inverse_weight, &parts[p].inverse_inner_weight})
          {
            // Add the sums of all ranks.
            values = 0.;
            for (std::size_t i = 0; i < n_nodes; ++i)
              values.local_element(i * n) = (*weights)[i];
            values.compress(VectorOperation::add);
            values.update_ghost_values();
            for (std::size_t i = 0; i < n_nodes; ++i)
              if (const double weight = values.local_element(i * n);
                  weight > 0.)
                (*weights)[i] = 1. / weight;
          }
        for (const auto &[dof, node] : hanging[p])
          {
            HangingNode result{node, {}};
            bool        has_parents = true;
            for (const auto &[parent, factor] :
                 *hangs.get_constraint_entries(dof))
              {
                result.parents.emplace_back(place(parent), factor);
                has_parents &=
                  parts[p].inverse_weight[result.parents.back().first / n] > 0.;
              }
            if (has_parents)
              parts[p].hanging_nodes.push_back(std::move(result));
          }
      }

    find_across();
    const QGauss<dim> points(2);
    const FE_Q<dim>   scalar(1);
    for (unsigned int q = 0; q < n_points; ++q)
      for (unsigned int v = 0; v < n_vertices; ++v)
        shape_values[q][v] = scalar.shape_value(v, points.point(q));
  }



  template <int dim>
  void
  RecoveryEstimator<dim>::find_across()
  {
    // Owned and ghost cells include all cells around a vertex of an owned cell.
    const std::size_t n_nodes =
      local.stress_space.space.relevant.n_elements() / dim;
    std::vector<unsigned int> begin(n_nodes + 2, 0),
      around(local.cells.size() * n_vertices);
    for (const Cell &cell : local.cells)
      for (const unsigned int node : cell.nodes)
        ++begin[node / dim + 2];
    for (std::size_t n = 2; n < begin.size(); ++n)
      begin[n] += begin[n - 1];
    for (unsigned int c = 0; c < local.cells.size(); ++c)
      for (const unsigned int node : local.cells[c].nodes)
        around[begin[node / dim + 1]++] = c;
    const double largest_ratio = std::pow(1.5, 1. / dim); // of widths
    for (unsigned int c = 0; c < nodes.size(); ++c)
      {
        across.emplace_back();
        across.back().fill(numbers::invalid_unsigned_int);
        const auto &mine = local.cells[c].nodes;
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            const unsigned int                  node = mine[v] / dim;
            const ArrayView<const unsigned int> cells(&around[begin[node]],
                                                      begin[node + 1] -
                                                        begin[node]);
            bool is_regular = cells.size() == n_vertices;
            for (const unsigned int other : cells)
              is_regular &=
                local.cells[other].is_present &&
                local.cells[other].material_id == local.cells[c].material_id &&
                widths[other] < largest_ratio * widths[c] &&
                widths[c] < largest_ratio * widths[other];
            if (!is_regular)
              continue;
            for (const unsigned int other : cells)
              {
                const auto  &its      = local.cells[other].nodes;
                unsigned int n_common = 0;
                for (unsigned int w = 0; w < n_vertices && n_common < 2; ++w)
                  n_common += std::count(mine.begin(), mine.end(), its[w]);
                if (n_common == 1)
                  across.back()[v] = other;
              }
          }
      }
  }



  template <int dim>
  void
  RecoveryEstimator<dim>::recover(const Part &part, const Strains &means) const
  {
    values              = 0.;
    double *const nodal = values.begin();
    for (const unsigned int c : part.cells)
      {
        const SymmetricTensor<2, 3> integral = 1. / widths[c] * means[c];
        for (const unsigned int node : nodes[c])
          for (unsigned int i = 0; i < n_components; ++i)
            nodal[node + i] += integral.access_raw_entry(i);
      }
    values.compress(VectorOperation::add);
    scale(values, part.inverse_weight);
    values.update_ghost_values();
    interpolate_hanging_nodes(part);
  }



  template <int dim>
  std::vector<bool>
  RecoveryEstimator<dim>::curved_ends(const Part    &part,
                                      const Strains &means) const
  {
    std::vector<bool> result;
    for (const unsigned int c : part.cells)
      for (unsigned int v = 0; v < n_vertices; ++v)
        if (ends[c][v])
          result.push_back(is_curved(c, v, means));
    return result;
  }



  template <int dim>
  void
  RecoveryEstimator<dim>::mirror() const
  {
    double *const nodal = values.begin();
    for (const auto &[node, normal] : mirrored)
      {
        SymmetricTensor<2, 3> strain = recovered(node);
        const Tensor<1, 3>    across = strain * normal,
                           shear     = across - (across * normal) * normal;
        strain -= 2. * symmetrize(outer_product(shear, normal));
        for (unsigned int i = 0; i < n_components; ++i)
          nodal[node + i] = strain.access_raw_entry(i);
      }
  }



  template <int dim>
  void
  RecoveryEstimator<dim>::scale(NodalVector               &strains,
                                const std::vector<double> &factors) const
  {
    double *entry = strains.begin();
    for (std::size_t i = 0; i < strains.locally_owned_size(); ++i)
      entry[i] *= factors[i / n_components];
  }



  template <int dim>
  void
  RecoveryEstimator<dim>::interpolate_hanging_nodes(const Part &part) const
  {
    double *const nodal = values.begin();
    for (const HangingNode &hanging : part.hanging_nodes)
      for (unsigned int i = 0; i < n_components; ++i)
        {
          nodal[hanging.node + i] = 0.;
          for (const auto &[parent, factor] : hanging.parents)
            nodal[hanging.node + i] += factor * nodal[parent + i];
        }
  }



  template <int dim>
  void
  RecoveryEstimator<dim>::extrapolate(const Part              &part,
                                      const Strains           &means,
                                      const std::vector<bool> &is_left) const
  {
    mirror();
    auto        left = is_left.cbegin();
    NodalVector change;
    change.reinit(values);
    const double *const nodal = values.begin();
    for (const unsigned int c : part.cells)
      {
        if (ends[c].none())
          continue;
        // Half of the nodes, corrected twofold, restore the mean of a linear
        // strain.
        SymmetricTensor<2, 3> missed = means[c];
        for (const unsigned int node : nodes[c])
          for (unsigned int i = 0; i < n_components; ++i)
            missed.access_raw_entry(i) -= nodal[node + i] / n_vertices;
        missed *= 2. / widths[c];
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            const bool is_skipped = !ends[c][v] || *left++;
            for (unsigned int i = 0; i < n_components && !is_skipped; ++i)
              change.local_element(nodes[c][v] + i) +=
                missed.access_raw_entry(i);
          }
      }
    change.compress(VectorOperation::add);
    scale(change, part.inverse_inner_weight);
    values.zero_out_ghost_values();
    values += change;
    values.update_ghost_values();
    mirror();
    interpolate_hanging_nodes(part);
  }



  template <int dim>
  typename RecoveryEstimator<dim>::Strains
  RecoveryEstimator<dim>::mean_strains(const DistributedVector &u) const
  {
    Strains result;
    result.reserve(local.cells.size());
    for (const Cell &cell : local.cells)
      result.push_back(
        local.mean_strain(cell, local.displacements(cell, u.begin())));
    return result;
  }



  template <int dim>
  std::array<SymmetricTensor<2, 3>, RecoveryEstimator<dim>::n_points>
  RecoveryEstimator<dim>::strains(const unsigned int       c,
                                  const DistributedVector &u,
                                  double                  *dilatations) const
  {
    const Cell &cell = local.cells[c];
    return local.strains(cell,
                         local.displacements(cell, u.begin()),
                         dilatations);
  }



  template <int dim>
  std::array<SymmetricTensor<2, 3>, RecoveryEstimator<dim>::n_points>
  RecoveryEstimator<dim>::defects(
    const unsigned int                                 c,
    const std::array<SymmetricTensor<2, 3>, n_points> &strains) const
  {
    std::array<SymmetricTensor<2, 3>, n_points> result;
    const double                               *nodal = values.begin();
    for (unsigned int i = 0; i < n_components; ++i)
      {
        double at_vertices[n_vertices];
        for (unsigned int v = 0; v < n_vertices; ++v)
          at_vertices[v] = nodal[nodes[c][v] + i];
        for (unsigned int q = 0; q < n_points; ++q)
          {
            double recovered = 0.;
            for (unsigned int v = 0; v < n_vertices; ++v)
              recovered += shape_values[q][v] * at_vertices[v];
            result[q].access_raw_entry(i) = recovered;
          }
      }
    for (unsigned int q = 0; q < n_points; ++q)
      result[q] -= strains[q];
    return result;
  }



  template <int dim>
  double
  RecoveryEstimator<dim>::energy_density(
    const unsigned int           c,
    const SymmetricTensor<2, 3> &strain) const
  {
    return local.cells[c].stiffness.stress(strain) * strain;
  }



  template <int dim>
  SymmetricTensor<2, 3>
  RecoveryEstimator<dim>::recovered(const unsigned int node) const
  {
    SymmetricTensor<2, 3> result;
    for (unsigned int i = 0; i < n_components; ++i)
      result.access_raw_entry(i) = values.local_element(node + i);
    return result;
  }



  template <int dim>
  bool
  RecoveryEstimator<dim>::is_curved(const unsigned int c,
                                    const unsigned int vertex,
                                    const Strains     &means) const
  {
    constexpr double   least_curvature = 0.25;
    const unsigned int other           = across[c][opposite(vertex)];
    if (other == numbers::invalid_unsigned_int)
      return false;
    const SymmetricTensor<2, 3> here = means[c], there = means[other],
                                patch = recovered(nodes[c][opposite(vertex)]);
    return energy_density(c, here + there - 2. * patch) >
           least_curvature * energy_density(c, here - patch);
  }



  template <int dim>
  Vector<double>
  RecoveryEstimator<dim>::estimate(
    const DistributedVector                              &u,
    const std::vector<typename LocalCells<dim>::Strains> &strains,
    double                                               *deviatoric) const
  {
    const Strains       means = mean_strains(u);
    std::vector<double> squares(local.cells.size());
    double              of_deviators = 0.;
    for (const Part &part : parts)
      {
        recover(part, means);
        for (const unsigned int c : part.cells)
          {
            const Cell &cell    = local.cells[c];
            const auto &weights = local.shapes[cell.shape].weights;
            const auto  e       = defects(c, strains[c]);
            // e : e and (tr e)^2, which tell most without more tensors.
            double all = 0., of_traces = 0.;
            for (unsigned int q = 0; q < n_points; ++q)
              {
                all += weights[q] * (e[q] * e[q]);
                of_traces +=
                  weights[q] * Utilities::fixed_power<2>(trace(e[q]));
              }
            const Stiffness &stiffness = cell.stiffness;
            const double     two_mu    = 2. * stiffness.shear_modulus();
            if (stiffness.is_isotropic())
              squares[c] = two_mu * all +
                           (stiffness.bulk_modulus() - two_mu / 3.) * of_traces;
            else
              for (unsigned int q = 0; q < n_points; ++q)
                squares[c] += weights[q] * (stiffness.stress(e[q]) * e[q]);
            of_deviators += stiffness.smallest_deviatoric_eigenvalue() *
                            std::max(0., all - of_traces / 3.);
          }
        // Corner singularities of linear laws are recovered well enough.
        if (part.largest_share > 0.5)
          raise_at_singular_points(part, means, squares);
      }
    if (deviatoric != nullptr)
      *deviatoric = Utilities::MPI::sum(of_deviators,
                                        local.stress_space.space.communicator);
    return local.by_active_index(squares);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(RecoveryEstimator);
} // namespace Viscoplastic
