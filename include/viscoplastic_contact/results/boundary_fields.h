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
  /// Fields of the boundary in a state, as BodyFields are of the body: those of
  /// contact and friction, which have values at the nodes of Gamma_3, and
  /// tractions, which are those of the mean stress of the cell behind a face.
  /// On the other side of contact between two bodies there are the same fields:
  /// means over the nodes opposite, of vectors the reverse.
  template <int dim>
  class BoundaryFields
  {
  public:
    /// Make the fields of the boundary among @p fields. @p face is null without
    /// contact points. Collective.
    BoundaryFields(const StressSpace<dim>        &stress_space,
                   const State<dim>              &state,
                   const ContactFace<dim>        *face,
                   const std::set<RecordedField> &fields);

    /// The fields of Gamma_3 that the output of a scene has, but for the
    /// displacement. @p face is null without contact points.
    static std::set<RecordedField>
    of_output(const Scene<dim> &scene, const ContactFace<dim> *face);

    static std::string
    name(const RecordedField field)
    {
      std::string name = name_of(field);
      std::replace(name.begin(), name.end(), ' ', '_');
      return name;
    }
    static bool
    is_vector(const RecordedField field)
    {
      return field == RecordedField::slip ||
             field == RecordedField::slip_rate ||
             field == RecordedField::traction ||
             field == RecordedField::stress_vector;
    }

    /// The names of the values; vectors have one for each component.
    static std::vector<std::string>
    names(const std::set<RecordedField> &fields);

    /// Whether a boundary is the other side of contact between two bodies.
    bool
    is_other_side(const types::boundary_id id) const
    {
      return secondary_of.count(id) == 1;
    }

    /// The condition on a boundary: that of the contact there, on either side.
    const BoundaryCondition<dim> &
    condition_at(const types::boundary_id id) const
    {
      return stress_space.space.scene.boundary.at(
        is_other_side(id) ? secondary_of.at(id) : id);
    }

    /// The values at a vertex of an owned cell, on a face with an outward unit
    /// normal. Fields of contact need a face of Gamma_3.
    std::vector<double>
    values(const std::size_t     cell,
           const unsigned int    face,
           const unsigned int    vertex,
           const Tensor<1, dim> &normal) const;

    /// Add to each of @p values the sum over the vertices of the face of weight
    /// times value.
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
    /// Make the fields on the other sides of those at the nodes of Gamma_3.
    void
    carry_across();

    bool
    has(const RecordedField field) const
    {
      return fields.count(field) > 0;
    }

    const StressSpace<dim> &stress_space;
    const State<dim>       &state;
    std::set<RecordedField> fields;
    /// The secondary boundary of each primary one.
    std::map<types::boundary_id, types::boundary_id> secondary_of;
    /// Nodal fields of contact points, with ghosts; zero at nodes without a
    /// point, empty where not asked for.
    DistributedVector slip, slip_rate, density, bound, utilization, slipping,
      pressure, gap, friction_work;
  };
} // namespace Viscoplastic
