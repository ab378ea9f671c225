// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>

#include <viscoplastic_contact/discretization/plane_faces.h>
#include <viscoplastic_contact/discretization/surface_normals.h>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// The normal of a face at a vertex, times its weight there.
    template <int dim>
    Tensor<1, dim>
    weighted_normal(const SurfaceFace<dim> &face, const unsigned int v)
    {
      const auto edge = [&](const unsigned int to) {
        return (face.vertices[to] + face.lifts[to]) -
               (face.vertices[v] + face.lifts[v]);
      };
      const Tensor<1, dim> a = edge(v ^ 1U);
      if constexpr (dim == 2)
        return cross_product_2d(a) / a.norm_square();
      else
        {
          const Tensor<1, dim> b = edge(v ^ 2U);
          return cross_product_3d(a, b) / (a.norm_square() * b.norm_square());
        }
    }



    template <int dim>
    Tensor<1, dim>
    nodal_value(const LinearAlgebra::distributed::Vector<double> &values,
                const types::global_dof_index                     first_dof)
    {
      Tensor<1, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = values(first_dof + d);
      return result;
    }



    template <int dim>
    void
    set_nodal_value(const Tensor<1, dim>                       &value,
                    const types::global_dof_index               first_dof,
                    LinearAlgebra::distributed::Vector<double> &values)
    {
      for (unsigned int d = 0; d < dim; ++d)
        values(first_dof + d) = value[d];
    }



    /// Scale to unit length; exact axes keep nodal frames trivial.
    template <int dim>
    Tensor<1, dim>
    normalized(Tensor<1, dim> normal)
    {
      normal /= normal.norm();
      for (unsigned int d = 0; d < dim; ++d)
        if (std::abs(std::abs(normal[d]) - 1.) < 1e-12)
          {
            const double sign = normal[d] > 0. ? 1. : -1.;
            normal            = 0.;
            normal[d]         = sign;
          }
      return normal;
    }
  } // namespace



  template <int dim>
  void
  SurfaceNormals<dim>::lift(
    const std::map<types::global_dof_index, Point<dim>> &positions,
    const AffineConstraints<double>                     &hanging_nodes)
  {
    lifts.zero_out_ghost_values();
    for (const auto &[dof, x] : positions)
      if (normals.in_local_range(dof) && hanging_nodes.is_constrained(dof))
        {
          Tensor<1, dim> normal, lift;
          for (const auto &[parent, weight] :
               *hanging_nodes.get_constraint_entries(dof))
            {
              const Tensor<1, dim> there = at(parent);
              normal += weight * there;
              lift -=
                0.5 * weight * ((x - positions.at(parent)) * there) * there;
            }
          set_nodal_value(normalized(normal), dof, normals);
          set_nodal_value(lift, dof, lifts);
        }
    normals.update_ghost_values();
    lifts.update_ghost_values();
  }



  template <int dim>
  SurfaceNormals<dim>::SurfaceNormals(
    const DoFHandler<dim>           &dof_handler,
    const AffineConstraints<double> &hanging_nodes,
    const Scene<dim>                &scene)
    : normals(dof_handler.locally_owned_dofs(),
              DoFTools::extract_locally_relevant_dofs(dof_handler),
              dof_handler.get_communicator())
    , lifts(normals)
  {
    std::set<types::boundary_id> ids;
    for (const auto &[id, condition] : scene.boundary)
      if (condition.normal_varies)
        {
          ids.insert(id);
          ids.insert(*condition.against);
        }
    const IndexSet &owned = dof_handler.locally_owned_dofs();
    std::map<types::global_dof_index, Point<dim>> positions;
    // An orthonormal basis of the symmetry planes' normals at each owned node.
    std::map<types::global_dof_index, std::vector<Tensor<1, dim>>> mirrors;
    using Cell = typename DoFHandler<dim>::active_cell_iterator;
    std::vector<std::pair<Cell, unsigned int>> faces;
    for (const auto &cell : dof_handler.active_cell_iterators())
      for (const unsigned int f : cell->face_indices())
        {
          if (cell->is_artificial() || !cell->at_boundary(f))
            continue;
          const auto  face      = cell->face(f);
          const auto &condition = scene.boundary.at(face->boundary_id());
          const bool  is_here   = ids.count(condition.id) == 1;
          if (is_here && cell->is_locally_owned())
            faces.emplace_back(cell, f);
          for (const unsigned int v : face->vertex_indices())
            {
              const auto dof = face->vertex_dof_index(v, 0);
              if (is_here)
                positions[dof] = face->vertex(v);
              if (condition.role != BoundaryRole::symmetry ||
                  !owned.is_element(dof))
                continue;
              Tensor<1, dim> across = condition.normal;
              for (const Tensor<1, dim> &other : mirrors[dof])
                across = tangential(across, other);
              if (across.norm() > 1e-6)
                mirrors[dof].push_back(across / across.norm());
            }
        }

    const bool any_hanging =
      Utilities::MPI::max(hanging_nodes.n_constraints(),
                          dof_handler.get_communicator());
    // Normals and lifted nodes depend on each other, so they are iterated.
    for (unsigned int pass = 0; pass < (any_hanging ? 3 : 1); ++pass)
      {
        LinearAlgebra::distributed::Vector<double> sums(normals);
        sums = 0.;
        for (const auto &[cell, f] : faces)
          {
            const SurfaceFace<dim> surface = face(cell, f);
            for (const unsigned int v : cell->face(f)->vertex_indices())
              {
                Tensor<1, dim> normal = weighted_normal<dim>(surface, v);
                if (normal * (cell->face(f)->center() - cell->center()) < 0.)
                  normal *= -1.;
                for (unsigned int d = 0; d < dim; ++d)
                  sums(cell->face(f)->vertex_dof_index(v, d)) += normal[d];
              }
          }
        sums.compress(VectorOperation::add);
        normals.zero_out_ghost_values();
        for (const auto &[dof, x] : positions)
          if (owned.is_element(dof) && !hanging_nodes.is_constrained(dof))
            {
              Tensor<1, dim> normal = nodal_value<dim>(sums, dof);
              if (const auto planes = mirrors.find(dof);
                  planes != mirrors.end())
                for (const Tensor<1, dim> &across : planes->second)
                  normal = tangential(normal, across);
              set_nodal_value(normalized(normal), dof, normals);
            }
        normals.update_ghost_values();
        if (any_hanging)
          lift(positions, hanging_nodes);
      }
  }



  template <int dim>
  Tensor<1, dim>
  SurfaceNormals<dim>::at(const types::global_dof_index first_dof) const
  {
    return nodal_value<dim>(normals, first_dof);
  }



  template <int dim>
  SurfaceFace<dim>
  SurfaceNormals<dim>::face(const typename DoFHandler<dim>::cell_iterator &cell,
                            const unsigned int f) const
  {
    SurfaceFace<dim> result;
    for (const unsigned int v : cell->face(f)->vertex_indices())
      {
        result.vertices[v] = cell->face(f)->vertex(v);
        const auto dof     = cell->face(f)->vertex_dof_index(v, 0);
        result.normals[v]  = at(dof);
        result.lifts[v]    = nodal_value<dim>(lifts, dof);
      }
    return result;
  }



  template <int dim>
  double
  SurfaceNormals<dim>::reach(const SurfaceFace<dim> &face)
  {
    double curvature = 0.;
    for (unsigned int v = 1; v < face.n; ++v)
      curvature = std::max(curvature,
                           (face.normals[v] - face.normals[0]).norm() /
                             (face.vertices[v] - face.vertices[0]).norm());
    // The reach of a flat face is as large as numbers allow.
    return 0.5 / std::max(curvature, std::numeric_limits<double>::min());
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(SurfaceNormals);
} // namespace Viscoplastic
