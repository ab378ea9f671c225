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


  /// Fields of the body in a state, for all outputs: displacement and velocity
  /// have values at vertices, all others are cell means. Values are in the
  /// order of the enumeration, with one for each component. Only requested
  /// fields are computed.
  template <int dim>
  class BodyFields
  {
  public:
    /// Compute the fields of the body among @p fields. Keeps references to the
    /// other arguments. Collective.
    BodyFields(const FlowLaws<dim>           &laws,
               const State<dim>              &state,
               const std::set<RecordedField> &fields);

    BodyFields(const BodyFields &) = delete;

    /// The fields in the output of a scene, except for nodal ones.
    static std::set<RecordedField>
    of_output(const Scene<dim> &scene);

    /// Add to each of @p values the sum of weight times value over the vertices
    /// of an owned cell, which is an interpolation or an integral.
    void
    add(const std::size_t         cell,
        const VertexWeights<dim> &weights,
        double                   *values) const;

    /// The values of those fields that are cell means.
    std::vector<double>
    means(const std::size_t cell) const;

  private:
    const StressSpace<dim> &stress_space;
    const State<dim>       &state;
    /// Storage of the reported displacement, if it is not that of the state.
    DistributedVector        difference;
    const DistributedVector &u;
    /// Storage of z without thermal stress, if that differs from z.
    IrreversibleStress                   rest;
    const IrreversibleStress            &irreversible;
    const typename FlowLaws<dim>::AtTime now;
    /// The fields that are cell means, and the nodal ones.
    std::set<RecordedField>                cell_fields;
    std::vector<const DistributedVector *> nodal_fields;
    /// G at the samples, and irreversible strain of the initial data by cell;
    /// empty unless needed.
    IrreversibleStress                 rate;
    std::vector<SymmetricTensor<2, 3>> initial_strain;
  };
} // namespace Viscoplastic
