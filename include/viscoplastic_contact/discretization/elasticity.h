// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/laws/stiffness.h>

#include <vector>

namespace Viscoplastic
{
  /// The elastic tensor of each owned cell, taken at the cell's center; uniform
  /// materials share one object.
  template <int dim>
  class ElasticModuli
  {
  public:
    /// Throws ExcMessage naming material, place and what is out of range.
    /// Collective.
    explicit ElasticModuli(const AdmissibleSpace<dim> &space);

    /// Use one tensor everywhere, e.g. the identity for a projection.
    explicit ElasticModuli(const Stiffness &stiffness);

    /// Return the tensor of a cell, by its index among the owned ones.
    const Stiffness &
    operator()(const std::size_t cell) const
    {
      return moduli[number.empty() ? 0 : number[cell]];
    }

    /// Return the largest Poisson's ratio of the body, including materials
    /// absent in the present stage; the same on all ranks.
    double
    max_poissons_ratio() const
    {
      return max_nu;
    }

  private:
    std::vector<Stiffness>    moduli;
    std::vector<unsigned int> number; // by cell; empty if there is one for all
    double                    max_nu;
  };


  /// Assemble the bilinear form a(u,v) = int E eps(u) : eps(v), fully
  /// integrated, in nodal frames without hanging nodes. Prescribed components
  /// keep their rows, which give reactions; solvers exclude them. Collective.
  ///
  /// With @p mean_dilatation, tr eps is replaced by its mean over the cell.
  template <int dim>
  void
  assemble_elastic_matrix(const AdmissibleSpace<dim> &space,
                          const ElasticModuli<dim>   &moduli,
                          const bool                  mean_dilatation,
                          DistributedMatrix          &matrix);

  /// Set @p cell_matrix to this form on one cell, at the points of @p
  /// fe_values, with hoop strains for rings. Declared here for tests of its
  /// coercivity. A matrix with an extra node, in generalized plane strain,
  /// includes the axial unknown, which makes the strain zz @p axial_strain.
  template <int dim>
  void
  elastic_cell_matrix(const FEValues<dim> &fe_values,
                      const Stiffness     &stiffness,
                      const bool           mean_dilatation,
                      FullMatrix<double>  &cell_matrix,
                      const PlaneModel     plane_model  = PlaneModel::strain,
                      const double         axial_strain = 0.);
} // namespace Viscoplastic
