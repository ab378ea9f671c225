// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/fe/fe.h>

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/discretization/elasticity.h>
#include <viscoplastic_contact/laws/strain.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  /// The irreversible stress z = sigma - E eps(u), an element of Q_h by its
  /// coefficients: StressSpace::n_samples tensors for each owned cell. Always
  /// tensors of three dimensions: plane strain has z_zz.
  using IrreversibleStress = std::vector<SymmetricTensor<2, 3>>;


  /// The space Q_h of stresses, the paper's H^h: symmetric tensors that are
  /// constant in each cell, FE_DGQ(0). As its refinement, tensors at the Gauss
  /// points of each cell, FE_DGQArbitraryNodes of QGauss(2). An element of the
  /// space is a list of coefficients, its samples.
  ///
  /// The space knows the projection P_Qh of strains, (3.1), and its transpose,
  /// the virtual work of stresses. It keeps the gradients of the shape
  /// functions of V_h, projected, so that the time loop needs no FEValues; once
  /// for all cells of a shape.
  ///
  /// In generalized plane strain the strain has zz of the whole section, which
  /// stresses work on, too.
  ///
  /// With mean dilatation, the strain has the volumetric part of its cell mean
  /// and stresses act on such strains, as in the elastic form.
  template <int dim>
  class StressSpace
  {
  public:
    StressSpace(const AdmissibleSpace<dim> &space,
                const ElasticModuli<dim>   &moduli,
                const bool                  at_quadrature_points,
                const bool                  mean_dilatation);

    const AdmissibleSpace<dim> &space;
    const ElasticModuli<dim>   &moduli;
    const bool                  mean_dilatation;
    /// The element of each component of a stress.
    const std::unique_ptr<const FiniteElement<dim>> element;
    /// Coefficients of a cell: 1, or those at 2^dim Gauss points.
    const unsigned int n_samples;

    /// Owned cells.
    std::size_t
    n_cells() const
    {
      return space.cells.size();
    }

    double
    volume(const std::size_t cell) const
    {
      return volumes[space.shapes[cell]];
    }

    double
    weight(const std::size_t cell, const unsigned int s) const
    {
      return weights[space.shapes[cell] * n_samples + s];
    }

    Point<dim>
    position(const std::size_t cell, const unsigned int s) const
    {
      return space.cells[cell]->vertex(0) +
             positions[space.shapes[cell] * n_samples + s];
    }

    /// P_Qh eps(u) in a cell: the mean strain, or that at the Gauss points.
    /// @p u: local array of a ghosted vector.
    void
    strains(const std::size_t      cell,
            const double          *u,
            SymmetricTensor<2, 3> *strain) const;

    /// The mean of these strains, for the price of one.
    SymmetricTensor<2, 3>
    mean_strain(const std::size_t cell, const double *u) const;

    /// The positions in @p u of the first components at the vertices of a cell.
    const unsigned int *
    nodes_of_cell(const std::size_t cell) const
    {
      return &nodes[cell * n_vertices];
    }

    /// Add factor int stress : eps(v) to the local array @p load.
    void
    add_virtual_work(const std::size_t            cell,
                     const SymmetricTensor<2, 3> *stress,
                     const double                 factor,
                     double                      *load) const;

    /// Add int C eps(u) : eps(v) with C at each sample to the matrix of a cell,
    /// Cartesian, in the order of AdmissibleSpace::get_dofs(). Strains and
    /// virtual work are those of the functions above. @p tangent: symmetric.
    void
    add_stiffness(const std::size_t            cell,
                  const SymmetricTensor<4, 3> *tangent,
                  FullMatrix<double>          &cell_matrix) const;

    /// The mean of a cell's samples: the projection to piecewise constants.
    SymmetricTensor<2, 3>
    mean(const std::size_t cell, const SymmetricTensor<2, 3> *samples) const
    {
      if (n_samples == 1)
        return samples[0];
      SymmetricTensor<2, 3> result;
      for (unsigned int s = 0; s < n_samples; ++s)
        result += samples[s] * (weight(cell, s) / volume(cell));
      return result;
    }

    /// int E^-1 a : b over a cell, from its samples.
    DEAL_II_ALWAYS_INLINE double
    complementary_product(const std::size_t            cell,
                          const SymmetricTensor<2, 3> *a,
                          const SymmetricTensor<2, 3> *b) const
    {
      return moduli(cell).complementary_product(
        n_samples, &weights[space.shapes[cell] * n_samples], a, b);
    }

    /// sigma = E eps(u) + z, cell means; @p z may be empty (no viscosity).
    std::vector<SymmetricTensor<2, 3>>
    mean_stress(const DistributedVector  &ghosted_u,
                const IrreversibleStress &z) const;

    /// For each child of a cell, the matrix from the values at the samples of
    /// the parent to those at the samples of the child: interpolation by the
    /// polynomial through the parent's samples.
    std::vector<FullMatrix<double>>
    prolongation() const;

  private:
    static constexpr unsigned int n_vertices =
      GeometryInfo<dim>::vertices_per_cell;

    using NodalValues = std::array<Tensor<1, dim>, n_vertices>;

    /// u at the vertices of a cell.
    NodalValues
    displacements(const std::size_t cell, const double *u) const
    {
      const unsigned int *node = nodes_of_cell(cell);
      NodalValues         result;
      for (unsigned int v = 0; v < n_vertices; ++v)
        for (unsigned int d = 0; d < dim; ++d)
          result[v][d] = u[node[v] + d];
      return result;
    }

    /// The strain of these values from the gradients of shape functions, and
    /// hoop strains or null, at the vertices; zz of the whole section.
    static SymmetricTensor<2, 3>
    strain_at(const NodalValues    &values,
              const Tensor<1, dim> *gradient,
              const double         *hoop,
              double                zz)
    {
      Tensor<2, dim> sum;
      for (unsigned int v = 0; v < n_vertices; ++v)
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            sum[i][j] += values[v][i] * gradient[v][j];
      if (hoop != nullptr)
        for (unsigned int v = 0; v < n_vertices; ++v)
          zz += values[v][0] * hoop[v];
      return strain(sum, zz);
    }

    std::vector<unsigned int> nodes; // n_vertices a cell
    /// Of shapes of cells: 1 each, then at their samples n_vertices each, ...
    std::vector<double>         volumes;
    std::vector<Tensor<1, dim>> gradients;
    /// ... the hoop strain of u_r = 1 at each vertex, likewise; empty unless
    /// the body is one of revolution; and 1 each, positions from vertex 0.
    std::vector<double>         hoops, weights;
    std::vector<Tensor<1, dim>> positions;
    /// Means of gradients and hoop strains, n_vertices each.
    std::vector<Tensor<1, dim>> mean_gradients;
    std::vector<double>         mean_hoops;
  };


  /// (z, eps(v)), a vector in frames. Collective.
  template <int dim>
  DistributedVector
  irreversible_forces(const StressSpace<dim>   &stress_space,
                      const IrreversibleStress &z);

  /// Add -(z, eps(v)) to a load vector in frames. Collective.
  template <int dim>
  void
  add_irreversible_load(const StressSpace<dim>   &stress_space,
                        const IrreversibleStress &z,
                        DistributedVector        &load);
} // namespace Viscoplastic
