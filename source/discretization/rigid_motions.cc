// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/discretization/admissible_space.h>

#include <algorithm>
#include <iomanip>
#include <set>
#include <sstream>

// The rigid motions of a body: those that its conditions have to prevent, and
// the near null space that they are for some solvers.

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    constexpr unsigned int n_rigid_motions = dim == 2 ? 3 : 6;



    /// The null space of the Gram matrix of the rigid motions on the prescribed
    /// components, in words.
    template <int dim>
    std::string
    free_motions(const FullMatrix<double> &gram)
    {
      constexpr unsigned int   n = n_rigid_motions<dim>;
      LAPACKFullMatrix<double> matrix(n, n);
      matrix = gram;
      Vector<double>     eigenvalues(n);
      FullMatrix<double> eigenvectors(n, n);
      matrix.compute_eigenvalues_symmetric(
        -1., 1e300, 0., eigenvalues, eigenvectors);
      const auto is_free = [&](const unsigned int e) {
        return eigenvalues[e] <=
               1e-12 * std::max(eigenvalues.linfty_norm(), 1e-300);
      };
      const auto is_translation = [&](const unsigned int e) {
        for (unsigned int a = dim; a < n; ++a)
          if (std::abs(eigenvectors(a, e)) > 1e-8)
            return false;
        return true;
      };
      unsigned int n_translations = 0;
      for (unsigned int e = 0; e < eigenvalues.size(); ++e)
        n_translations += is_free(e) && is_translation(e);
      std::string result;
      for (unsigned int e = 0; e < eigenvalues.size(); ++e)
        if (is_free(e))
          {
            // Name the mode by its largest part.
            unsigned int largest = 0;
            for (unsigned int a = 1; a < n; ++a)
              if (std::abs(eigenvectors(a, e)) >
                  std::abs(eigenvectors(largest, e)) + 1e-8)
                largest = a;
            const std::string xyz = "xyz";
            result += result.empty() ? "" : " and ";
            // A single translation may have any direction; of several, the
            // axes are a basis.
            if (n_translations == 1 && is_translation(e) &&
                std::abs(eigenvectors(largest, e)) < 1. - 1e-8)
              {
                std::ostringstream direction;
                direction << std::setprecision(3) << "translation along (";
                const double sign = eigenvectors(largest, e) > 0. ? 1. : -1.;
                for (unsigned int a = 0; a < dim; ++a)
                  direction << (a == 0 ? "" : ", ")
                            << sign * eigenvectors(a, e);
                result += direction.str() + ')';
              }
            else if (largest < dim)
              result += std::string("translation along ") + xyz[largest];
            else
              result += std::string("rotation about ") +
                        (dim == 2 ? 'z' : xyz[largest - dim]);
          }
      return result;
    }



    /// Which parts of the present body, joined by faces, each boundary node
    /// belongs to, by its position in the list of boundary nodes. Without
    /// stages the body is one. Returns the number of parts.
    template <int dim>
    unsigned int
    find_parts(const AdmissibleSpace<dim>          &space,
               std::vector<std::set<unsigned int>> &parts)
    {
      const auto &nodes = space.boundary_nodes();
      if (!space.scene.has_stages())
        {
          parts.assign(nodes.size(), {0});
          return 1;
        }
      // All ranks have the coarse mesh, whose cells are present or absent as a
      // whole.
      const auto &triangulation = space.dof_handler.get_triangulation();
      const auto  is_present    = [&space](const auto &cell) {
        return space.scene.is_present(cell->material_id());
      };
      std::vector<unsigned int> part_of_cell(triangulation.n_cells(0),
                                             numbers::invalid_unsigned_int);
      unsigned int              n_parts = 0;
      for (const auto &first : triangulation.cell_iterators_on_level(0))
        {
          if (!is_present(first) ||
              part_of_cell[first->index()] != numbers::invalid_unsigned_int)
            continue;
          std::vector<typename Triangulation<dim>::cell_iterator> open{first};
          part_of_cell[first->index()] = n_parts;
          while (!open.empty())
            {
              const auto cell = open.back();
              open.pop_back();
              for (const unsigned int f : cell->face_indices())
                if (!cell->at_boundary(f))
                  {
                    const auto neighbor = cell->neighbor(f);
                    if (!is_present(neighbor) ||
                        part_of_cell[neighbor->index()] !=
                          numbers::invalid_unsigned_int)
                      continue;
                    part_of_cell[neighbor->index()] = n_parts;
                    open.push_back(neighbor);
                  }
            }
          ++n_parts;
        }

      std::map<types::global_dof_index, std::size_t> number;
      for (std::size_t i = 0; i < nodes.size(); ++i)
        number[nodes[i].first_dof] = i;
      parts.assign(nodes.size(), {});
      for (const auto &cell : space.dof_handler.active_cell_iterators())
        if (!cell->is_artificial() && is_present(cell))
          for (const unsigned int v : cell->vertex_indices())
            {
              const auto node = number.find(cell->vertex_dof_index(v, 0));
              if (node == number.end())
                continue;
              typename Triangulation<dim>::cell_iterator ancestor = cell;
              while (ancestor->level() > 0)
                ancestor = ancestor->parent();
              parts[node->second].insert(part_of_cell[ancestor->index()]);
            }
      return n_parts;
    }
  } // namespace



  template <int dim>
  void
  AdmissibleSpace<dim>::check_rigid_motions()
  {
    constexpr unsigned int              n = n_rigid_motions<dim>;
    std::vector<std::set<unsigned int>> parts;
    std::vector<FullMatrix<double>>     gram(find_parts(*this, parts),
                                         FullMatrix<double>(n, n));
    Point<dim>                          center;
    double                              count = node_position.size();
    for (const auto &x : node_position)
      center += x;
    center =
      Point<dim>(Utilities::MPI::sum(Tensor<1, dim>(center), communicator) /
                 Utilities::MPI::sum(count, communicator));
    double radius = 0.;
    for (const auto &x : node_position)
      radius = std::max(radius, x.distance(center));
    radius = Utilities::MPI::max(radius, communicator);

    // What the displacement of a place along a direction sees of the motions.
    const auto add_row = [&](FullMatrix<double>   &to,
                             const Point<dim>     &position,
                             const Tensor<1, dim> &direction) {
      const Tensor<1, dim> x = (position - center) / radius;
      std::vector<double>  value(n);
      for (unsigned int d = 0; d < dim; ++d)
        value[d] = direction[d];
      if constexpr (dim == 2)
        value[2] = -x[1] * direction[0] + x[0] * direction[1];
      else
        {
          const Tensor<1, dim> moment = cross_product_3d(x, direction);
          for (unsigned int d = 0; d < dim; ++d)
            value[dim + d] = moment[d];
        }
      for (unsigned int a = 0; a < n; ++a)
        for (unsigned int b = 0; b < n; ++b)
          to(a, b) += value[a] * value[b];
    };
    const auto sees_contact = [](const NodalFrame<dim> &frame,
                                 const unsigned int     d) {
      bool seen = false;
      for (const FrictionPlane<dim> &plane : frame.planes)
        for (const auto &row : plane.map)
          seen |= row[d] != 0.;
      for (const Obstacle<dim> &obstacle : frame.obstacles)
        seen |= obstacle.map[d] != 0.;
      return seen;
    };
    FullMatrix<double> contact(n, n);
    for (std::size_t m = 0; m < nodes.size(); ++m)
      for (unsigned int i = 0; i < frames[nodes[m].frame].n_fixed; ++i)
        for (const unsigned int part : parts[m])
          add_row(gram[part],
                  nodes[m].position,
                  column(frames[nodes[m].frame].directions,
                         frames[nodes[m].frame].fixed[i]));

    for (FullMatrix<double> &of_part : gram)
      {
        Utilities::MPI::sum(of_part, communicator, of_part);
        std::string motions = free_motions<dim>(of_part);
        const bool  may_be_held_by_contact =
          gram.size() == 1 && scene.has_unilateral_contact();
        if (!motions.empty() && may_be_held_by_contact)
          {
            for (const BoundaryNode &node : nodes)
              for (unsigned int d = 0; d < dim; ++d)
                if (sees_contact(frames[node.frame], d))
                  add_row(contact,
                          node.position,
                          column(frames[node.frame].directions, d));
            Utilities::MPI::sum(contact, communicator, contact);
            contact.add(1., of_part);
            motions         = free_motions<dim>(contact);
            held_by_contact = motions.empty();
          }
        std::ostringstream what;
        what << "The boundary conditions leave a rigid motion free";
        if (gram.size() > 1)
          what << " of one of the " << gram.size() << " parts of the body";
        if (scene.stage() > 0)
          what << " from t = " << scene.stage_ends[scene.stage() - 1]
               << " on, when materials are added or removed";
        AssertThrow(motions.empty(),
                    ExcMessage(
                      what.str() + ": " + motions +
                      ". Prescribe displacements that prevent it "
                      "(clamped, displacement, symmetry, bilateral or "
                      "glued contact; friction does not count" +
                      (may_be_held_by_contact ?
                         ", nor does unilateral contact along its face)." :
                         ").")));
      }
  }



  template <int dim>
  std::vector<DistributedVector>
  AdmissibleSpace<dim>::rigid_body_modes() const
  {
    const unsigned int             n_modes = dim == 2 ? 3 : 6;
    std::vector<DistributedVector> modes(n_modes, owned_vector());

    Point<dim>   center;
    const double count = node_position.size();
    for (const auto &x : node_position)
      center += x;
    center =
      Point<dim>(Utilities::MPI::sum(Tensor<1, dim>(center), communicator) /
                 Utilities::MPI::sum(count, communicator));

    for (std::size_t n = 0; n < node_position.size(); ++n)
      {
        const NodalFrame<dim> &frame =
          frames[frame_of_node[(first_owned / dim) + n]];
        const Tensor<1, dim> x = node_position[n] - center;
        for (unsigned int m = 0; m < n_modes; ++m)
          {
            Tensor<1, dim> u;
            if (m < dim)
              u[m] = 1.;
            else if constexpr (dim == 2)
              {
                u[0] = -x[1];
                u[1] = x[0];
              }
            else
              {
                Tensor<1, dim> axis;
                axis[m - dim] = 1.;
                u             = cross_product_3d(axis, x);
              }
            if (!frame.is_cartesian)
              u = transpose(frame.directions) * u;
            for (unsigned int d = 0; d < dim; ++d)
              if (!is_excluded[n * dim + d])
                modes[m].begin()[n * dim + d] = u[d];
          }
      }
    return modes;
  }



  template void
  AdmissibleSpace<2>::check_rigid_motions();
  template void
  AdmissibleSpace<3>::check_rigid_motions();
  template std::vector<DistributedVector>
  AdmissibleSpace<2>::rigid_body_modes() const;
  template std::vector<DistributedVector>
  AdmissibleSpace<3>::rigid_body_modes() const;
} // namespace Viscoplastic
