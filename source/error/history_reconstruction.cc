// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/distributed/tria_base.h>

#include <viscoplastic_contact/error/history_reconstruction.h>
#include <viscoplastic_contact/mesh/cell_order.h>

namespace Viscoplastic
{
  namespace
  {
    using Stress = SymmetricTensor<2, 3>;

    /// Slopes of a stress in each direction.
    template <int dim>
    struct Slopes : public std::array<Stress, dim>
    {};

    template <int dim>
    Stress
    operator*(const Slopes<dim> &slopes, const Tensor<1, dim> &x)
    {
      Stress result;
      for (unsigned int d = 0; d < dim; ++d)
        result += slopes[d] * x[d];
      return result;
    }



    /// The owned cells, followed by ghosts, and the neighbors of owned ones.
    template <int dim>
    class Neighborhood
    {
    public:
      explicit Neighborhood(const StressSpace<dim> &stress_space);

      /// The cell means of a field in owned cells and ghosts.
      std::vector<Stress>
      means(const IrreversibleStress &field) const;

      /// The slopes fitted to the means of neighbors minus those of the
      /// samples, in owned cells.
      std::vector<Slopes<dim>>
      corrections(const IrreversibleStress  &field,
                  const std::vector<Stress> &means) const;

      /// The slopes of the samples of an owned cell.
      Slopes<dim>
      sampled_slopes(const std::size_t         c,
                     const IrreversibleStress &field) const;

      /// The positions of an owned cell's samples relative to its center.
      std::vector<Tensor<1, dim>>
      sample_places(const std::size_t c) const;

      /// Bring the values of owned cells to the ranks that see them as ghosts.
      void
      exchange(std::vector<Stress> &values) const;

      const StressSpace<dim>                &stress_space;
      std::vector<Point<dim>>                centers;   // of gravity
      std::vector<std::vector<unsigned int>> neighbors; // of owned cells

    private:
      std::vector<types::global_cell_index> global_index;
    };



    template <int dim>
    Neighborhood<dim>::Neighborhood(const StressSpace<dim> &stress_space)
      : stress_space(stress_space)
      , neighbors(stress_space.n_cells())
    {
      const DoFHandler<dim>    &dof_handler = stress_space.space.dof_handler;
      std::vector<unsigned int> number(
        dof_handler.get_triangulation().n_active_cells());
      const auto add = [&](const auto &cell) {
        number[cell->active_cell_index()] = centers.size();
        global_index.push_back(cell->global_active_cell_index());
        centers.emplace_back();
      };
      for (const auto &cell : stress_space.space.cells)
        add(cell);
      for (const auto &cell : ghost_cells(dof_handler))
        add(cell);
      // Cell means belong to centers of gravity, which are not the mean of the
      // vertices unless cells are parallelograms: linear fields are reproduced.
      std::vector<Stress> places(neighbors.size());
      for (std::size_t c = 0; c < places.size(); ++c)
        for (unsigned int s = 0; s < stress_space.n_samples; ++s)
          for (unsigned int d = 0; d < dim; ++d)
            places[c].access_raw_entry(d) += stress_space.weight(c, s) /
                                             stress_space.volume(c) *
                                             stress_space.position(c, s)[d];
      exchange(places);
      for (std::size_t c = 0; c < places.size(); ++c)
        for (unsigned int d = 0; d < dim; ++d)
          centers[c][d] = places[c].access_raw_entry(d);

      for (std::size_t c = 0; c < neighbors.size(); ++c)
        {
          const auto &cell     = stress_space.space.cells[c];
          const auto  add_side = [&](const auto &neighbor) {
            if (neighbor->material_id() == cell->material_id())
              neighbors[c].push_back(number[neighbor->active_cell_index()]);
          };
          for (const unsigned int f : cell->face_indices())
            if (cell->at_boundary(f))
              continue;
            else if (cell->neighbor(f)->is_active())
              add_side(cell->neighbor(f));
            else
              for (unsigned int i = 0; i < cell->face(f)->n_children(); ++i)
                add_side(cell->neighbor_child_on_subface(f, i));
        }
    }



    template <int dim>
    void
    Neighborhood<dim>::exchange(std::vector<Stress> &values) const
    {
      values.resize(centers.size());
      const std::size_t n_owned = neighbors.size();
      const auto       &triangulation =
        dynamic_cast<const parallel::TriangulationBase<dim> &>(
          stress_space.space.dof_handler.get_triangulation());
      if (Utilities::MPI::n_mpi_processes(triangulation.get_communicator()) ==
          1)
        return;
      LinearAlgebra::distributed::Vector<double> component(
        triangulation.global_active_cell_index_partitioner().lock());
      for (unsigned int i = 0; i < Stress::n_independent_components; ++i)
        {
          component.zero_out_ghost_values();
          for (std::size_t c = 0; c < n_owned; ++c)
            component(global_index[c]) = values[c].access_raw_entry(i);
          component.update_ghost_values();
          for (std::size_t c = n_owned; c < values.size(); ++c)
            values[c].access_raw_entry(i) = component(global_index[c]);
        }
    }



    template <int dim>
    std::vector<Stress>
    Neighborhood<dim>::means(const IrreversibleStress &field) const
    {
      std::vector<Stress> result(neighbors.size());
      for (std::size_t c = 0; c < result.size(); ++c)
        result[c] = stress_space.mean(c, &field[c * stress_space.n_samples]);
      exchange(result);
      return result;
    }



    template <int dim>
    std::vector<Tensor<1, dim>>
    Neighborhood<dim>::sample_places(const std::size_t c) const
    {
      std::vector<Tensor<1, dim>> result;
      for (unsigned int s = 0; s < stress_space.n_samples; ++s)
        result.push_back(stress_space.position(c, s) - centers[c]);
      return result;
    }



    template <int dim>
    Slopes<dim>
    Neighborhood<dim>::sampled_slopes(const std::size_t         c,
                                      const IrreversibleStress &field) const
    {
      Slopes<dim> result;
      if (stress_space.n_samples == 1)
        return result;
      Tensor<2, dim> moments;
      Slopes<dim>    products;
      const auto     places = sample_places(c);
      for (unsigned int s = 0; s < stress_space.n_samples; ++s)
        {
          const Tensor<1, dim> &x      = places[s];
          const double          weight = stress_space.weight(c, s);
          moments += weight * outer_product(x, x);
          for (unsigned int d = 0; d < dim; ++d)
            products[d] +=
              weight * x[d] * field[c * stress_space.n_samples + s];
        }
      const Tensor<2, dim> inverse = invert(moments);
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = products * inverse[d];
      return result;
    }



    template <int dim>
    std::vector<Slopes<dim>>
    Neighborhood<dim>::corrections(const IrreversibleStress  &field,
                                   const std::vector<Stress> &means) const
    {
      // Least squares for the slopes' corrections c are A c = b with A the sum
      // of w w over the unit vectors w to neighbors. Regularization keeps the
      // slope in directions without neighbors, such as the radius in a ring of
      // one layer: (A^2 + threshold^2) c = A b.
      constexpr double         threshold = 0.1;
      std::vector<Slopes<dim>> result(neighbors.size());
      for (std::size_t c = 0; c < result.size(); ++c)
        {
          const Slopes<dim> sampled = sampled_slopes(c, field);
          Tensor<2, dim>    directions;
          Slopes<dim>       missed;
          for (const unsigned int n : neighbors[c])
            {
              const Tensor<1, dim> way    = centers[n] - centers[c];
              const double         weight = 1. / way.norm_square();
              directions += weight * outer_product(way, way);
              const Stress defect = means[n] - means[c] - sampled * way;
              for (unsigned int d = 0; d < dim; ++d)
                missed[d] += weight * way[d] * defect;
            }
          const Tensor<2, dim> inverse =
            invert(directions * directions +
                   threshold * threshold * unit_symmetric_tensor<dim>()) *
            directions;
          for (unsigned int d = 0; d < dim; ++d)
            result[c][d] = missed * inverse[d];
        }
      return result;
    }
  } // namespace



  template <int dim>
  HistoryReconstruction
  reconstruct_history(const StressSpace<dim>   &stress_space,
                      const IrreversibleStress &z,
                      const IrreversibleStress &stress)
  {
    // With cell means, return values at the centers of the children.
    const bool         of_children = stress_space.n_samples == 1;
    const unsigned int n           = 1u << dim;
    const auto         values      = [&](const IrreversibleStress &field) {
      if (!of_children)
        return field;
      IrreversibleStress result;
      for (const Stress &mean : field)
        result.insert(result.end(), n, mean);
      return result;
    };
    HistoryReconstruction result{
      values(z),
      values(stress),
      Vector<double>(
        stress_space.space.dof_handler.get_triangulation().n_active_cells())};
    const Neighborhood<dim> near(stress_space);
    const auto mean_z = near.means(z), mean_stress = near.means(stress);
    const auto of_z      = near.corrections(z, mean_z),
               of_stress = near.corrections(stress, mean_stress);

    // The new slopes of z in owned cells and ghosts.
    std::vector<Slopes<dim>> slopes(near.centers.size());
    for (unsigned int d = 0; d < dim; ++d)
      {
        std::vector<Stress> in_direction(of_z.size());
        for (std::size_t c = 0; c < of_z.size(); ++c)
          in_direction[c] = near.sampled_slopes(c, z)[d] + of_z[c][d];
        near.exchange(in_direction);
        for (std::size_t c = 0; c < slopes.size(); ++c)
          slopes[c][d] = in_direction[c];
      }

    for (std::size_t c = 0; c < of_z.size(); ++c)
      {
        const auto      &cell      = stress_space.space.cells[c];
        const Stiffness &stiffness = stress_space.moduli(c);
        // Second moments of a cell are a third of those of equal vertex masses.
        const double weight =
          stress_space.volume(c) / (3. * cell->n_vertices());
        double of_samples = 0., square = 0.;
        for (const unsigned int v : cell->vertex_indices())
          {
            const Tensor<1, dim> x = cell->vertex(v) - near.centers[c];
            of_samples += weight * stiffness.complementary_square(of_z[c] * x);
            square += weight * x.norm_square();
          }
        // The error of new slopes is what the mean of the slopes of two
        // neighbors leaves of the difference of their cell means.
        double of_slopes = 0.;
        for (const unsigned int neighbor : near.neighbors[c])
          {
            const Tensor<1, dim> way = near.centers[neighbor] - near.centers[c];
            const Stress         jump =
              mean_z[neighbor] - mean_z[c] -
              0.5 * (slopes[c] * way + slopes[neighbor] * way);
            of_slopes += square / near.neighbors[c].size() *
                         stiffness.complementary_square(jump) /
                         way.norm_square();
          }
        double &error = result.squared_error[cell->active_cell_index()];
        error         = of_samples;
        if (of_slopes >= of_samples)
          continue;
        error = of_slopes;
        // Where creep prevails, the stress has relaxed to one that makes
        // strains of this mesh flow, and a changed one would relax again.
        std::vector<Tensor<1, dim>> places;
        if (of_children)
          for (const unsigned int v : cell->vertex_indices())
            places.push_back(0.5 * (cell->vertex(v) - near.centers[c]));
        else
          places = near.sample_places(c);
        const double size_of_z = deviator(mean_z[c]).norm(),
                     unrelaxed =
                       size_of_z > 0. ?
                         std::min(1.,
                                  deviator(mean_stress[c]).norm() / size_of_z) :
                         1.;
        for (unsigned int s = 0; s < n; ++s)
          {
            result.z[c * n + s] += of_z[c] * places[s];
            result.stress[c * n + s] += unrelaxed * (of_stress[c] * places[s]);
          }
      }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(reconstruct_history);
} // namespace Viscoplastic
