// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/discretization/elasticity.h>

#include <vector>

namespace Viscoplastic
{
  /**
   * The irreversible stress z = sigma - E eps(u), sample by sample of the owned
   * cells. Always a 3D tensor: plane strain has z_zz.
   */
  using IrreversibleStress = std::vector<SymmetricTensor<2, 3>>;


  /**
   * Where stresses are sampled: once a cell, with the cell's mean strain (the
   * paper's piecewise constant stress), or at the quadrature points. Keeps the
   * gradients of the shape functions there, so that the time loop needs no
   * FEValues: 2^dim (dim + 1/2) doubles a sample.
   *
   * With mean dilatation, the strain has the volumetric part of its cell mean
   * and stresses act on such strains, as in the elastic form.
   */
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
    /// Samples a cell: 1, or 2^dim quadrature points.
    const unsigned int n_samples;

    /// Owned cells.
    std::size_t
    n_cells() const
    {
      return volumes.size();
    }

    double
    volume(const std::size_t cell) const
    {
      return volumes[cell];
    }

    double
    weight(const std::size_t cell, const unsigned int s) const
    {
      return weights[cell * n_samples + s];
    }

    const Point<dim> &
    position(const std::size_t cell, const unsigned int s) const
    {
      return positions[cell * n_samples + s];
    }

    /// Strains at the samples of a cell; @p u: local array of a ghosted vector.
    void
    strains(const std::size_t      cell,
            const double          *u,
            SymmetricTensor<2, 3> *strain) const;

    /// Add factor int stress : eps(v) to the local array @p load.
    void
    add_virtual_work(const std::size_t            cell,
                     const SymmetricTensor<2, 3> *stress,
                     const double                 factor,
                     double                      *load) const;

    /// Add int C eps(u) : eps(v) with C at each sample to the matrix of a cell,
    /// Cartesian, in the order of the cell's degrees of freedom. Strains and
    /// virtual work are those of the functions above. @p tangent: symmetric.
    void
    add_stiffness(const std::size_t            cell,
                  const SymmetricTensor<4, 3> *tangent,
                  FullMatrix<double>          &cell_matrix) const;

    /// Mean of a cell's samples.
    SymmetricTensor<2, 3>
    mean(const std::size_t cell, const SymmetricTensor<2, 3> *samples) const;

    /// sigma = E eps(u) + z, cell means; @p z may be empty (no viscosity).
    std::vector<SymmetricTensor<2, 3>>
    mean_stress(const DistributedVector  &ghosted_u,
                const IrreversibleStress &z) const;

  private:
    static constexpr unsigned int n_vertices =
      GeometryInfo<dim>::vertices_per_cell;

    std::vector<unsigned int>   nodes;     // n_vertices a cell
    std::vector<Tensor<1, dim>> gradients; // n_vertices a sample
    std::vector<double>         weights;   // 1 a sample
    std::vector<Point<dim>>     positions; // 1 a sample
    std::vector<double>         volumes;   // 1 a cell
  };


  /// Add -(z, eps(v)) to a load vector in frames. Collective.
  template <int dim>
  void
  add_irreversible_load(const StressSpace<dim>   &stress_space,
                        const IrreversibleStress &z,
                        DistributedVector        &load);
} // namespace Viscoplastic
