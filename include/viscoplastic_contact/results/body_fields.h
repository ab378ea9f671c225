// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/geometry_info.h>

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>

#include <array>
#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A number for each vertex of a cell.
  template <int dim>
  using VertexWeights =
    std::array<double, GeometryInfo<dim>::vertices_per_cell>;


  /// Fields of the body in a state: what the outputs, points, lines and
  /// integrals have of it comes from here. Displacement and velocity have
  /// values at vertices, all others are means of cells. Values come in the
  /// order of the enumeration, one for each component. Nothing is computed for
  /// what is not asked for.
  template <int dim>
  class BodyFields
  {
  public:
    /// Make the fields of the body among @p fields; the other arguments stay in
    /// use as long as this object. Collective.
    BodyFields(const FlowLaws<dim>           &laws,
               const State<dim>              &state,
               const std::set<RecordedField> &fields);

    BodyFields(const BodyFields &) = delete;
    BodyFields &
    operator=(const BodyFields &) = delete;

    /// The fields that the output of a scene has, but for the nodal ones.
    static std::set<RecordedField>
    of_output(const Scene<dim> &scene);

    /// The names of the values: displacement_x, ..., creep_rate, ...
    static std::vector<std::string>
    names(const std::set<RecordedField> &fields);

    /// Add to each of @p values the sum over the vertices of an owned cell of
    /// weight times value: an interpolation, or an integral.
    void
    add(const std::size_t         cell,
        const VertexWeights<dim> &weights,
        double                   *values) const;

    /// The means of a cell alone.
    std::vector<double>
    means(const std::size_t cell) const;

  private:
    const StressSpace<dim> &stress_space;
    const State<dim>       &state;
    /// The displacement as it is reported.
    DistributedVector        difference;
    const DistributedVector &u;
    /// z without thermal stress.
    IrreversibleStress                   rest;
    const IrreversibleStress            &irreversible;
    const typename FlowLaws<dim>::AtTime now;
    /// The fields that are means of cells, and the others.
    std::set<RecordedField>                cell_fields;
    std::vector<const DistributedVector *> nodal_fields;
    /// G at the samples, where it is needed, and the irreversible strain of the
    /// initial data, where there is some.
    IrreversibleStress                 rate;
    std::vector<SymmetricTensor<2, 3>> initial_strain;
  };
} // namespace Viscoplastic
