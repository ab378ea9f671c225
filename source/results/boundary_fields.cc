// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/results/boundary_fields.h>

#include <algorithm>

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
    if (has(RecordedField::slip))
      {
        slip = state.u;
        if (state.initial_u.size() > 0)
          for (std::size_t i = 0; i < stress_space.space.relevant.n_elements();
               ++i)
            slip.begin()[i] -= state.initial_u.begin()[i];
        stress_space.space.make_relative(slip);
      }
    if (has(RecordedField::slip_rate))
      {
        slip_rate = state.velocity;
        stress_space.space.make_relative(slip_rate);
      }
    if (face == nullptr)
      return;
    const ContactState        &contact = state.contact;
    const std::vector<double> &bounds  = contact.bound;
    std::vector<double>        values(bounds.size());
    if (has(RecordedField::traction))
      density = face->density(contact, /* of_friction_alone = */ true);
    if (has(RecordedField::bound))
      {
        for (unsigned int p = 0; p < values.size(); ++p)
          values[p] = bounds[p] / face->weights()[p];
        bound = face->nodal_field(values);
      }
    if (has(RecordedField::utilization))
      {
        for (unsigned int p = 0; p < values.size(); ++p)
          values[p] = bounds[p] > 0. ?
                        stable_norm(contact.multiplier[p]) / bounds[p] :
                        0.;
        utilization = face->nodal_field(values);
      }
    if (has(RecordedField::stick))
      {
        for (unsigned int p = 0; p < values.size(); ++p)
          values[p] = contact.sticks[p] ? 0. : 1.;
        slipping = face->nodal_field(values);
      }
    if (has(RecordedField::contact_pressure))
      {
        for (unsigned int p = 0; p < values.size(); ++p)
          values[p] = contact.multiplier[p][0] / face->weights()[p];
        pressure = face->nodal_field(values, /* of_obstacles = */ true);
      }
    if (has(RecordedField::gap))
      {
        for (unsigned int p = 0; p < values.size(); ++p)
          values[p] = bounds[p] - contact.slip[p][0];
        gap = face->nodal_field(values, /* of_obstacles = */ true);
      }
  }



  template <int dim>
  std::string
  BoundaryFields<dim>::name(const RecordedField field)
  {
    std::string name = name_of(field);
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
  }



  template <int dim>
  bool
  BoundaryFields<dim>::is_vector(const RecordedField field)
  {
    return field == RecordedField::slip || field == RecordedField::slip_rate ||
           field == RecordedField::traction ||
           field == RecordedField::stress_vector;
  }



  template <int dim>
  std::vector<std::string>
  BoundaryFields<dim>::names(const std::set<RecordedField> &fields)
  {
    std::vector<std::string> result;
    for (const RecordedField field : fields)
      if (is_vector(field))
        for (unsigned int d = 0; d < dim; ++d)
          result.push_back(name(field) + "_" + "xyz"[d]);
      else if (is_of_boundary(field))
        result.push_back(name(field));
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
      space.scene.boundary.at(cell->face(f)->boundary_id());
    const auto           first_dof = cell->vertex_dof_index(v, 0);
    const auto           node      = space.relevant.index_within_set(first_dof);
    const Tensor<1, dim> normal    = condition.normal_varies ?
                                       space.normal_at(first_dof, condition) :
                                       normal_of_face;
    const auto           vector    = [&](const DistributedVector &field) {
      Tensor<1, dim> value;
      for (unsigned int d = 0; d < dim; ++d)
        value[d] = field.begin()[node + d];
      return value;
    };
    const auto scalar = [&](const DistributedVector &field) {
      return condition.has_friction() && field.size() > 0 ?
               field.begin()[node] :
               0.;
    };
    const auto stress_vector = [&]() {
      std::vector<SymmetricTensor<2, 3>> samples(stress_space.n_samples);
      stress_space.strains(c, state.u.begin(), samples.data());
      SymmetricTensor<2, 3> stress =
        stress_space.moduli(c).stress(stress_space.mean(c, samples.data()));
      if (!state.z.empty())
        stress += stress_space.mean(c, &state.z[c * stress_space.n_samples]);
      Tensor<1, dim> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i] += stress[i][j] * normal[j];
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
            append(tangential(vector(slip), normal) -
                   condition.sliding(cell->vertex(v), state.t));
            break;
          case RecordedField::slip_rate:
            {
              Tensor<1, dim> rate = tangential(vector(slip_rate), normal);
              if (state.k > 0. && condition.foundation_motion)
                rate -=
                  (condition.sliding(cell->vertex(v), state.t) -
                   condition.sliding(cell->vertex(v), state.t - state.k)) /
                  state.k;
              append(rate);
              break;
            }
          case RecordedField::traction:
            // On the body: minus the multiplier.
            append(condition.has_friction() && density.size() > 0 ?
                     -1. * tangential(vector(density),
                                      space.normal_at(first_dof, condition)) :
                     Tensor<1, dim>());
            break;
          case RecordedField::bound:
            result.push_back(scalar(bound));
            break;
          case RecordedField::utilization:
            result.push_back(scalar(utilization));
            break;
          case RecordedField::stick:
            result.push_back(condition.has_friction() ? 1. - scalar(slipping) :
                                                        0.);
            break;
          case RecordedField::contact_pressure:
          case RecordedField::gap:
            {
              const DistributedVector &of =
                field == RecordedField::gap ? gap : pressure;
              result.push_back(condition.is_unilateral() && of.size() > 0 ?
                                 of.begin()[node] :
                                 0.);
              break;
            }
          case RecordedField::friction_work:
            result.push_back(scalar(state.friction_work));
            break;
          case RecordedField::normal_traction:
            result.push_back(stress_vector() * normal);
            break;
          case RecordedField::stress_vector:
            append(stress_vector());
            break;
          default:
            Assert(false, ExcInternalError());
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



  template class BoundaryFields<2>;
  template class BoundaryFields<3>;
} // namespace Viscoplastic
