// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/fe/fe.h>

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/discretization/elasticity.h>
#include <viscoplastic_contact/laws/strain.h>

#include <array>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// The irreversible stress z = sigma - E eps(u), an element of Q_h by its
  /// coefficients: StressSpace::n_samples tensors for each owned cell, in three
  /// dimensions, as plane strain has z_zz.
  using IrreversibleStress = std::vector<SymmetricTensor<2, 3>>;


  /// The space Q_h of stresses, the paper's H^h: symmetric tensors that are
  /// constant in each cell, FE_DGQ(0), or as a refinement have values at its
  /// Gauss points, FE_DGQArbitraryNodes of QGauss(2). An element of the space
  /// is a list of coefficients, its samples.
  ///
  /// The space computes the projection P_Qh of strains, (3.1), and its
  /// transpose, the virtual work of stresses. It stores projected gradients of
  /// the shape functions of V_h, once for all cells of a shape, so that the
  /// time loop needs no FEValues.
  ///
  /// In generalized plane strain the strain includes the uniform zz of the
  /// section, on which stresses do work, too.
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
    /// Coefficients of a cell: 1, or 2^dim at Gauss points.
    const unsigned int n_samples;

    /// Return the number of owned cells.
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

    /// The position of a sample: the offset from the origin of its cell.
    Point<dim>
    position(const std::size_t cell, const unsigned int s) const
    {
      return origin(cell) + offset(cell, s);
    }
    Point<dim>
    origin(const std::size_t cell) const
    {
      return space.cells[cell]->vertex(0);
    }
    const Tensor<1, dim> &
    offset(const std::size_t cell, const unsigned int s) const
    {
      return offsets[space.shapes[cell] * n_samples + s];
    }

    /// Set @p strain to P_Qh eps(u) in a cell: the mean strain, or that at the
    /// Gauss points. @p u: local array of a ghosted vector.
    void
    strains(const std::size_t      cell,
            const double          *u,
            SymmetricTensor<2, 3> *strain) const;

    /// Return the mean of these strains, at the cost of one.
    SymmetricTensor<2, 3>
    mean_strain(const std::size_t cell, const double *u) const;

    /// Return the indices in @p u of the first components at a cell's vertices.
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

    /// Add int C eps(u) : eps(v), C = @p tangent at each sample, symmetric, to
    /// a Cartesian cell matrix in the order of AdmissibleSpace::get_dofs(),
    /// with strains and virtual work as in the functions above.
    void
    add_stiffness(const std::size_t            cell,
                  const SymmetricTensor<4, 3> *tangent,
                  FullMatrix<double>          &cell_matrix) const;

    /// Return the mean of a cell's samples: the projection to constants.
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

    /// Return int E^-1 stress : stress over a cell, from its samples.
    DEAL_II_ALWAYS_INLINE double
    complementary_square(const std::size_t            cell,
                         const SymmetricTensor<2, 3> *stress) const
    {
      return moduli(cell).complementary_square(
        n_samples, &weights[space.shapes[cell] * n_samples], stress);
    }

    /// Return cell means of sigma = E eps(u) + z; @p z may be empty.
    std::vector<SymmetricTensor<2, 3>>
    mean_stress(const DistributedVector  &ghosted_u,
                const IrreversibleStress &z) const;

    /// Return for each child the matrix from values at the samples of the
    /// parent to those of the child: interpolation by the polynomial through
    /// the parent's.
    std::vector<FullMatrix<double>>
    prolongation() const;

  private:
    static constexpr unsigned int n_vertices =
      GeometryInfo<dim>::vertices_per_cell;

    using NodalValues = std::array<Tensor<1, dim>, n_vertices>;

    /// Return u at the vertices of a cell.
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

    /// Return the strain of nodal values from vertex gradients of shape
    /// functions, vertex hoop strains or null, and the uniform strain zz.
    static DEAL_II_ALWAYS_INLINE SymmetricTensor<2, 3>
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
    /// By shape of cells: the volume, and vertex gradients at the samples.
    std::vector<double>         volumes;
    std::vector<Tensor<1, dim>> gradients;
    /// Likewise, hoop strains of u_r = 1 at the vertices, empty unless the body
    /// is one of revolution; by sample, weights and offsets from vertex 0.
    std::vector<double>         hoops, weights;
    std::vector<Tensor<1, dim>> offsets;
    /// Means of gradients and hoop strains, n_vertices each.
    std::vector<Tensor<1, dim>> mean_gradients;
    std::vector<double>         mean_hoops;
  };


  /// Return (z, eps(v)), a vector in frames. Collective.
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
