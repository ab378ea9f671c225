// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/results/body_fields.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Fields of the boundary in a state: those of contact and friction, with
  /// values at the nodes of Gamma_3, and tractions of the mean stress in the
  /// cell at a face. The primary side of contact between two bodies has the
  /// same fields: means over opposite nodes, with the sign of vectors reversed.
  template <int dim>
  class BoundaryFields
  {
  public:
    /// Compute the fields of the boundary among @p fields. @p face is null
    /// without contact points. Collective.
    BoundaryFields(const StressSpace<dim>        &stress_space,
                   const State<dim>              &state,
                   const ContactFace<dim>        *face,
                   const std::set<RecordedField> &fields);

    /// The fields on Gamma_3 in the output of a scene, except for the
    /// displacement. @p face is null without contact points.
    static std::set<RecordedField>
    of_output(const Scene<dim> &scene, const ContactFace<dim> *face);

    /// The condition of the contact at a boundary on either of its sides.
    const BoundaryCondition<dim> &
    condition_at(const types::boundary_id id) const
    {
      const auto secondary = secondary_of.find(id);
      return stress_space.space.scene.boundary.at(
        secondary == secondary_of.end() ? id : secondary->second);
    }

    /// The values at a vertex of an owned cell, on a face with this outward
    /// unit normal. Fields of contact need a face of Gamma_3.
    std::vector<double>
    values(const std::size_t     cell,
           const unsigned int    face,
           const unsigned int    vertex,
           const Tensor<1, dim> &normal) const;

    /// Add to each of @p values the sum of weight times value over the vertices
    /// of the face.
    void
    add(const std::size_t         cell,
        const unsigned int        face,
        const VertexWeights<dim> &weights,
        const Tensor<1, dim>     &normal,
        double                   *values) const;

  private:
    /// The mean of sigma n in an owned cell.
    Tensor<1, dim>
    stress_vector(const std::size_t cell, const Tensor<1, dim> &normal) const;

    void
    make_fields(const ContactFace<dim> *face);
    /// Set fields on primary sides to means of those on secondary sides.
    void
    carry_across();

    /// The value of a field of contact at a contact point.
    double
    value_at_point(const RecordedField     field,
                   const ContactFace<dim> &face,
                   const unsigned int      p) const;

    const StressSpace<dim> &stress_space;
    const State<dim>       &state;
    std::set<RecordedField> fields;
    /// The secondary boundary of each primary one.
    std::map<types::boundary_id, types::boundary_id> secondary_of;
    /// The requested fields of contact points, with ghosts, zero at nodes
    /// without a point: as they are written but for `stick', 1 minus it, and
    /// `slip', `slip rate' and `traction', whose normal parts do not count.
    std::map<RecordedField, DistributedVector> nodal;
  };
} // namespace Viscoplastic
