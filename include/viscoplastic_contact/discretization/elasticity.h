// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/laws/stiffness.h>

#include <vector>

namespace Viscoplastic
{
  /// The elastic tensor of each owned cell, taken at the cell's center; one
  /// object for a material in which it is the same everywhere.
  template <int dim>
  class ElasticModuli
  {
  public:
    /// Throws ExcMessage naming material, place and what is out of range.
    /// Collective.
    explicit ElasticModuli(const AdmissibleSpace<dim> &space);

    /// A body with one tensor everywhere, e.g. the identity for a projection.
    explicit ElasticModuli(const Stiffness &stiffness);

    /// @p cell counts the owned active cells in the order of iteration.
    const Stiffness &
    operator()(const std::size_t cell) const
    {
      return moduli[number.empty() ? 0 : number[cell]];
    }

    /// Largest Poisson's ratio of the body, also of materials that are absent
    /// in the present stage; the same on all ranks.
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


  /// The bilinear form a(u,v) = int E eps(u) : eps(v), fully integrated, as a
  /// matrix in nodal frames without hanging nodes. Prescribed components keep
  /// their rows: they give the reactions, and whoever solves leaves them out.
  ///
  /// With @p mean_dilatation, tr eps is replaced by its mean over the cell.
  template <int dim>
  void
  assemble_elastic_matrix(const AdmissibleSpace<dim> &space,
                          const ElasticModuli<dim>   &moduli,
                          const bool                  mean_dilatation,
                          DistributedMatrix          &matrix);

  /// The same form for one cell: strains of the shape functions at the points
  /// of @p fe_values against each other, with hoop strains of rings. Declared
  /// here for the tests of its coercivity. A matrix with a node more than the
  /// cell has, in generalized plane strain, also has what @p axial_strain as
  /// that of its first component makes.
  template <int dim>
  void
  elastic_cell_matrix(const FEValues<dim> &fe_values,
                      const Stiffness     &stiffness,
                      const bool           mean_dilatation,
                      FullMatrix<double>  &cell_matrix,
                      const PlaneModel     plane_model  = PlaneModel::strain,
                      const double         axial_strain = 0.);
} // namespace Viscoplastic
