// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/discretization/held_traction.h>
#include <viscoplastic_contact/results/boundary_fields.h>
#include <viscoplastic_contact/results/unit_labels.h>

namespace Viscoplastic
{
  template <int dim>
  BoundaryFields<dim>::BoundaryFields(const StressSpace<dim> &stress_space,
                                      const State<dim>       &state,
                                      const ContactFace<dim> *face,
                                      const std::set<RecordedField> &all_fields)
    : stress_space(stress_space)
    , state(state)
  {
    for (const RecordedField field : all_fields)
      if (is_of_boundary(field))
        fields.insert(field);
    for (const auto &[id, condition] : stress_space.space.scene.boundary)
      if (condition.against)
        secondary_of[*condition.against] = id;
    make_fields(face);
    if (!secondary_of.empty())
      carry_across();
  }



  template <int dim>
  void
  BoundaryFields<dim>::make_fields(const ContactFace<dim> *face)
  {
    for (const RecordedField field : fields)
      if (field == RecordedField::friction_work)
        nodal[field] = state.friction_work;
      else if (field == RecordedField::slip ||
               field == RecordedField::slip_rate)
        {
          DistributedVector &motion = nodal[field];
          motion = field == RecordedField::slip ? state.u : state.velocity;
          if (field == RecordedField::slip && state.initial_u.size() > 0)
            for (std::size_t i = 0;
                 i < stress_space.space.relevant.n_elements();
                 ++i)
              motion.begin()[i] -= state.initial_u.begin()[i];
          stress_space.space.make_relative(motion);
        }
      else if (field == RecordedField::traction && face)
        nodal[field] = face->density(state.contact,
                                     /* of_friction_alone = */ true);
      else if (is_of_contact(field) && face)
        {
          std::vector<double> values;
          for (unsigned int p = 0; p < state.contact.n_points(); ++p)
            values.push_back(value_at_point(field, *face, p));
          nodal[field] =
            face->nodal_field(values, is_of_unilateral_contact(field));
        }
  }



  template <int dim>
  double
  BoundaryFields<dim>::value_at_point(const RecordedField     field,
                                      const ContactFace<dim> &face,
                                      const unsigned int      p) const
  {
    const ContactState &contact = state.contact;
    const double        bound   = contact.bound[p];
    switch (field)
      {
        case RecordedField::bound:
          return bound / face.weights()[p];
        case RecordedField::utilization:
          return bound > 0. ? stable_norm(contact.multiplier[p]) / bound : 0.;
        case RecordedField::stick: // that of nodes without points is 1
          return contact.sticks[p] ? 0. : 1.;
        case RecordedField::contact_pressure:
          return contact.multiplier[p][0] / face.weights()[p];
        default: // the gap
          return bound - contact.slip[p][0];
      }
  }



  template <int dim>
  void
  BoundaryFields<dim>::carry_across()
  {
    const AdmissibleSpace<dim>  &space = stress_space.space;
    std::set<types::boundary_id> primaries, secondaries;
    for (const auto &[primary, secondary] : secondary_of)
      {
        primaries.insert(primary);
        secondaries.insert(secondary);
      }
    const auto areas  = boundary_weights(space, primaries),
               shares = boundary_weights(space, secondaries);
    // The weight of a secondary node p at a primary node q is Q_pq int phi_p.
    const auto visit = [&](const auto &act) {
      for (const auto &of_boundary : space.mortar_rows)
        for (const auto &[node, row] : of_boundary.second)
          if (const auto p = node * dim; space.owned.is_element(p))
            for (const auto &[other, weight] : row.nodes)
              act(p, other * dim, weight * shares(p));
    };
    LinearAlgebra::distributed::Vector<double> sums(space.owned,
                                                    space.relevant,
                                                    space.communicator),
      weights(sums);
    visit([&](const auto, const auto q, const double weight) {
      weights(q) += weight;
    });
    weights.compress(VectorOperation::add);
    for (auto &[field, values] : nodal)
      {
        if (values.size() == 0 || field == RecordedField::traction)
          continue;
        sums                = 0.;
        const double factor = column_of(field).rank == 1 ? -1. : 1.;
        visit([&](const auto p, const auto q, const double weight) {
          for (unsigned int d = 0; d < dim; ++d)
            sums(q + d) +=
              factor * weight *
              values.begin()[space.relevant.index_within_set(p) + d];
        });
        sums.compress(VectorOperation::add);
        // Primary nodes without opposite nodes do not stick.
        const double      elsewhere = field == RecordedField::stick ? 1. : 0.;
        DistributedVector result    = space.owned_vector();
        for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
          {
            const std::size_t first = i - i % dim;
            result.begin()[i] =
              areas.local_element(first) == 0. ?
                values.begin()[space.relevant.index_within_set(
                  space.owned.nth_index_in_set(i))] :
              weights.local_element(first) > 1e-6 * areas.local_element(first) ?
                sums.local_element(i) / weights.local_element(first) :
                elsewhere;
          }
        space.distribute_hanging_nodes(result);
        values = result;
      }
  }



  template <int dim>
  std::set<RecordedField>
  BoundaryFields<dim>::of_output(const Scene<dim>       &scene,
                                 const ContactFace<dim> *face)
  {
    const std::set<RecordedField> &asked =
      scene.parameters.output.additional_fields;
    std::set<RecordedField> result{RecordedField::slip,
                                   RecordedField::slip_rate};
    if (scene.has_unilateral_contact())
      result.insert({RecordedField::contact_pressure, RecordedField::gap});
    if (face != nullptr && scene.has_friction())
      {
        result.insert({RecordedField::traction,
                       RecordedField::bound,
                       RecordedField::utilization,
                       RecordedField::stick});
        if (asked.count(RecordedField::friction_work) == 1)
          result.insert(RecordedField::friction_work);
      }
    if (asked.count(RecordedField::normal_traction) == 1)
      result.insert(RecordedField::normal_traction);
    return result;
  }



  template <int dim>
  Tensor<1, dim>
  BoundaryFields<dim>::stress_vector(const std::size_t     c,
                                     const Tensor<1, dim> &normal) const
  {
    SymmetricTensor<2, 3> stress = stress_space.moduli(c).stress(
      stress_space.mean_strain(c, state.u.begin()));
    if (!state.z.empty())
      stress += stress_space.mean(c, &state.z[c * stress_space.n_samples]);
    Tensor<1, dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        result[i] += stress[i][j] * normal[j];
    return result;
  }



  template <int dim>
  std::vector<double>
  BoundaryFields<dim>::values(const std::size_t     c,
                              const unsigned int    f,
                              const unsigned int    v,
                              const Tensor<1, dim> &normal_of_face) const
  {
    const AdmissibleSpace<dim>   &space = stress_space.space;
    const auto                   &cell  = space.cells[c];
    const BoundaryCondition<dim> &condition =
      condition_at(cell->face(f)->boundary_id());
    const auto           first_dof = cell->vertex_dof_index(v, 0);
    const auto           node      = space.relevant.index_within_set(first_dof);
    const Tensor<1, dim> normal    = condition.normal_varies ?
                                       space.normal_at(first_dof, condition) :
                                       normal_of_face;
    const auto           value     = [&](const RecordedField field) {
      Tensor<1, dim> result;
      const auto     found = nodal.find(field);
      if (found != nodal.end() && found->second.size() > 0)
        for (unsigned int d = 0; d < dim; ++d)
          result[d] = found->second.begin()[node + d];
      return result;
    };

    std::vector<double> result;
    const auto          append = [&result](const Tensor<1, dim> &value) {
      for (unsigned int d = 0; d < dim; ++d)
        result.push_back(value[d]);
    };
    for (const RecordedField field : fields)
      switch (field)
        {
          case RecordedField::slip:
            append(tangential(value(field), normal) -
                   condition.sliding(cell->vertex(v), state.t));
            break;
          case RecordedField::slip_rate:
            {
              Tensor<1, dim> rate = tangential(value(field), normal);
              if (state.k > 0. && condition.foundation_motion)
                rate -=
                  (condition.sliding(cell->vertex(v), state.t) -
                   condition.sliding(cell->vertex(v), state.t - state.k)) /
                  state.k;
              append(rate);
              break;
            }
          case RecordedField::traction:
            // The traction on the body is minus the multiplier.
            append(condition.has_friction() ?
                     -1. * tangential(value(field),
                                      space.normal_at(first_dof, condition)) :
                     Tensor<1, dim>());
            break;
          case RecordedField::stick:
            result.push_back(condition.has_friction() ? 1. - value(field)[0] :
                                                        0.);
            break;
          case RecordedField::normal_traction:
            result.push_back(stress_vector(c, normal) * normal);
            break;
          case RecordedField::stress_vector:
            append(stress_vector(c, normal));
            break;
          default:
            result.push_back((is_of_friction(field) ?
                                condition.has_friction() :
                                condition.is_unilateral()) ?
                               value(field)[0] :
                               0.);
        }
    return result;
  }



  template <int dim>
  void
  BoundaryFields<dim>::add(const std::size_t         cell,
                           const unsigned int        face,
                           const VertexWeights<dim> &weights,
                           const Tensor<1, dim>     &normal,
                           double                   *result) const
  {
    if (fields.empty())
      return;
    for (unsigned int i = 0; i < GeometryInfo<dim>::vertices_per_face; ++i)
      {
        const unsigned int v =
          GeometryInfo<dim>::face_to_cell_vertices(face, i);
        const std::vector<double> at_vertex = values(cell, face, v, normal);
        for (std::size_t j = 0; j < at_vertex.size(); ++j)
          result[j] += weights[v] * at_vertex[j];
      }
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(BoundaryFields);
} // namespace Viscoplastic
