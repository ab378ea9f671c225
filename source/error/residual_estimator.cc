// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/distributed/tria_base.h>

#include "acoustic_tensor.h"
#include <viscoplastic_contact/contact/normal_compliance.h>
#include <viscoplastic_contact/error/residual_estimator.h>

namespace Viscoplastic
{
  namespace
  {
    /// Return the residual of @p traction = sigma nu, zero in the directions in
    /// which u is prescribed.
    template <int dim>
    Tensor<1, dim>
    contradiction(const BoundaryCondition<dim> &condition,
                  const Tensor<1, dim>         &traction,
                  const Tensor<1, dim>         &given,
                  const Tensor<1, dim>         &multiplier_density)
    {
      Tensor<1, dim> residual;
      switch (condition.role)
        {
          case BoundaryRole::not_given:
          case BoundaryRole::clamped:
            break;
          case BoundaryRole::displacement:
            residual = traction - given;
            for (unsigned int d = 0; d < dim; ++d)
              if (condition.displacement[d])
                residual[d] = 0.;
            break;
          case BoundaryRole::traction:
          case BoundaryRole::free:
            residual = traction - given;
            break;
          case BoundaryRole::symmetry:
            residual = tangential(traction, condition.normal);
            break;
          case BoundaryRole::contact:
            if (condition.is_unilateral() || condition.against)
              {
                residual = traction + multiplier_density;
                break;
              }
            if (condition.is_glued())
              break;
            residual =
              tangential(traction + multiplier_density, condition.normal);
            if (condition.has_given_stress())
              residual +=
                ((traction - given) * condition.normal) * condition.normal;
            break;
        }
      return residual;
    }
  } // namespace



  template <int dim>
  typename ResidualEstimator<dim>::StressTerms
  ResidualEstimator<dim>::stress_terms(
    const std::size_t            cell,
    const Fields                &fields,
    const SymmetricTensor<2, 3> *mean_z) const
  {
    StressTerms terms;
    terms.u          = local.displacements(cells[cell], fields.u.begin());
    terms.stiffness  = &cells[cell].stiffness;
    terms.dilatation = 0.;
    if (stress_space.mean_dilatation)
      terms.dilatation = trace(local.mean_strain(cells[cell], terms.u));
    if (mean_z != nullptr)
      {
        SymmetricTensor<2, 3> z = mean_z[cell];
        if (fields.memory > 0.)
          {
            const SymmetricTensor<2, 3> elastic =
              terms.stiffness->stress(local.mean_strain(cells[cell], terms.u));
            const double of_strain = deviator(elastic).norm(),
                         of_stress =
                           fields.memory * deviator(elastic + z).norm();
            if (of_stress < of_strain)
              {
                const double share = of_stress / of_strain;
                for (Tensor<1, dim> &u : terms.u)
                  u *= share;
                terms.u.axial_strain *= share;
                terms.dilatation *= share;
                z += (1. - share) * elastic;
              }
          }
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            terms.z[i][j] = z[i][j];
      }
    return terms;
  }



  template <int dim>
  void
  ResidualEstimator<dim>::add_tractions(const FaceShape   &face,
                                        const StressTerms &terms,
                                        Tensor<1, dim>    *tractions) const
  {
    const Stiffness &stiffness       = *terms.stiffness;
    const bool       mean_dilatation = stress_space.mean_dilatation;
    const double     mu              = stiffness.shear_modulus(),
                 bulk                = stiffness.bulk_modulus();
    for (unsigned int q = 0; q < n_face_points; ++q)
      {
        const Tensor<1, dim> &normal = face.normals[q];
        Tensor<2, dim>        gradient;
        for (unsigned int v = 0; v < n_vertices; ++v)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              gradient[i][j] += terms.u[v][i] * face.gradients[q][v][j];
        const double zz = local.strain_zz(terms.u, face.hoops[q]);
        if (stiffness.is_isotropic())
          {
            const double divergence = trace(gradient) + zz;
            const double pressure =
              mean_dilatation ?
                bulk * terms.dilatation - 2. / 3. * mu * divergence :
                (bulk - 2. / 3. * mu) * divergence;
            Tensor<2, dim> stress = terms.z;
            for (unsigned int i = 0; i < dim; ++i)
              {
                stress[i][i] += pressure;
                for (unsigned int j = 0; j < dim; ++j)
                  stress[i][j] += mu * (gradient[i][j] + gradient[j][i]);
              }
            tractions[q] = stress * normal;
          }
        else
          {
            const SymmetricTensor<2, 3> here = strain(gradient, zz);
            tractions[q] =
              terms.z * normal +
              in_plane(stiffness.stress(
                         mean_dilatation ?
                           with_dilatation(here, terms.dilatation) :
                           here),
                       normal);
          }
      }
  }



  template <int dim>
  double
  ResidualEstimator<dim>::off_the_law(const BoundaryFace &face,
                                      const unsigned int  q,
                                      const double        k,
                                      const double        w,
                                      const double        p) const
  {
    if (!face.condition->has_normal_compliance())
      return w > 0. ? k * w : std::min(-k * w, p);
    NormalCompliance foundation;
    foundation.add(face.compliances[q], face.condition->pressure_law);
    const double another_pressure = std::abs(p - foundation.force(w));
    return p > 0. ? std::min(k * std::abs(w - foundation.penetration(p)),
                             another_pressure) :
                    std::min(k * std::max(0., w), another_pressure);
  }



  template <int dim>
  double
  ResidualEstimator<dim>::off_the_interface(const BoundaryFace   &face,
                                            const unsigned int    q,
                                            const Tensor<1, dim> &u,
                                            const Tensor<1, dim> &relative_u,
                                            const double          gap,
                                            const Tensor<1, dim> &density,
                                            const Fields         &fields) const
  {
    const auto &opposite = face.opposite[q];
    if (opposite.nodes.empty())
      return 0.;
    const BoundaryCondition<dim> &condition = *face.condition;
    Tensor<1, dim>                jump      = u;
    for (const auto &[node, weight] : opposite.nodes)
      for (unsigned int d = 0; d < dim; ++d)
        jump[d] -= weight * fields.u.begin()[node + d];
    const double         k     = 1. / opposite.softness;
    const Tensor<1, dim> delta = jump - relative_u;
    const double         along = delta * opposite.normal,
                 across        = tangential(delta, opposite.normal).norm();
    if (condition.is_glued())
      return k * delta.norm();
    const double of_slip =
      std::min(k * across, tangential(density, opposite.normal).norm());
    return std::hypot(of_slip,
                      condition.is_bilateral() ?
                        k * along :
                        off_the_law(face,
                                    q,
                                    k,
                                    jump * opposite.normal - opposite.distance -
                                      gap,
                                    std::max(0., density * opposite.normal)));
  }



  template <int dim>
  typename ResidualEstimator<dim>::Residuals
  ResidualEstimator<dim>::boundary_residuals(
    const BoundaryFace   &face,
    const Fields         &fields,
    const Tensor<1, dim> *tractions) const
  {
    const BoundaryCondition<dim> &condition = *face.condition;
    const LocalCell              &cell      = cells[face.cell];
    const FaceShape              &shape = shapes[cell.shape].faces[face.face];
    const bool has_multipliers          = condition.has_contact_points() ||
                                 condition.against || face.is_other_side,
               varies =
                 condition.carries_load() && condition.load_depends_on_time(),
               has_bound   = condition.has_given_bound(),
               opens       = condition.is_unilateral(),
               bounds_vary = condition.bound_depends_on_time();
    Assert(!has_multipliers || fields.multiplier_density != nullptr,
           ExcMessage("A scene with contact points has multipliers."));
    Residuals result;
    for (unsigned int q = 0; q < n_face_points; ++q)
      {
        const auto at_point = [&](const double *nodal) {
          Tensor<1, dim> value;
          for (unsigned int v = 0; v < n_vertices; ++v)
            for (unsigned int d = 0; d < dim; ++d)
              value[d] +=
                face_values[face.face][q][v] * nodal[cell.nodes[v] + d];
          return value;
        };
        Tensor<1, dim> density, given;
        if (has_multipliers)
          density = at_point(fields.multiplier_density->begin());
        // Where boundaries meet, the field has the pressures of all of them.
        if (opens && !condition.has_friction() && !condition.against)
          density = (density * condition.normal) * condition.normal;
        const Tensor<1, dim> &normal =
          face.opposite.empty() ? condition.normal : face.opposite[q].normal;
        if (fields.t)
          {
            given =
              varies ?
                condition.load(face.positions[q], shape.normals[q], *fields.t) :
                face.data[q];
            // Nodal multipliers respect nodal bounds; between nodes the density
            // may exceed a bound that jumps.
            if (has_bound)
              result[n_face_points + q][0] =
                std::max(0.,
                         tangential(density, normal).norm() -
                           (bounds_vary ?
                              condition.bound(face.positions[q], *fields.t) :
                              face.bounds[q]));
            const double gap =
              !opens      ? 0. :
              bounds_vary ? condition.gap(face.positions[q], *fields.t) :
                            face.gaps[q];
            double &off_law = result[n_face_points + q][1];
            if (!face.opposite.empty())
              off_law = off_the_interface(face,
                                          q,
                                          at_point(fields.u.begin()),
                                          at_point(fields.relative_u->begin()),
                                          gap,
                                          density,
                                          fields);
            else if (opens)
              off_law =
                off_the_law(face,
                            q,
                            cell.stiffness.smallest_deviatoric_eigenvalue() /
                              face.diameter,
                            at_point(fields.u.begin()) * condition.normal - gap,
                            std::max(0., density * condition.normal));
          }
        if (!face.springs.empty())
          given -= face.springs[q].stiffness * at_point(fields.u.begin());
        Tensor<1, dim> traction = tractions[q];
        if (fields.load_density != nullptr &&
            condition.role != BoundaryRole::symmetry)
          traction -= at_point(fields.load_density->begin());
        result[q] = contradiction(condition, traction, given, density);
        if (face.is_other_side)
          result[q] += density;
        if (!face.springs.empty())
          result[q] = face.springs[q].weight * result[q];
      }
    return result;
  }



  template <int dim>
  template <typename Visitor>
  void
  ResidualEstimator<dim>::visit_residuals(const Fields  &fields,
                                          const Visitor &visit) const
  {
    IrreversibleStress           means;
    const SymmetricTensor<2, 3> *mean_z =
      local.mean_irreversible_stress(fields.z, means);

    // sigma nu at all faces.
    std::vector<Tensor<1, dim>> tractions(
      (cells.size() * n_faces + subface_sides.size()) * n_face_points);
    for (std::size_t c = 0; c < cells.size(); ++c)
      {
        const StressTerms terms = stress_terms(c, fields, mean_z);
        for (unsigned int f = 0; f < n_faces; ++f)
          add_tractions(shapes[cells[c].shape].faces[f],
                        terms,
                        &tractions[(c * n_faces + f) * n_face_points]);
      }
    for (std::size_t s = 0; s < subface_sides.size(); ++s)
      add_tractions(subface_shapes[subface_sides[s].table],
                    stress_terms(subface_sides[s].cell, fields, mean_z),
                    &tractions[(cells.size() * n_faces + s) * n_face_points]);

    if (fields.t && !initial_tractions.empty())
      for (std::size_t i = 0; i < tractions.size(); ++i)
        tractions[i] += initial_tractions[i];
    if (fields.t && stress_space.space.scene.has_thermal_strain())
      add_thermal_tractions(*fields.t, tractions);

    // Normals point out of both sides.
    for (const InteriorFace &face : interior_faces)
      {
        const bool is_hanging =
          face.tractions[1] >= cells.size() * n_faces * n_face_points;
        Residuals jumps;
        for (unsigned int q = 0; q < n_face_points; ++q)
          jumps[q] = tractions[face.tractions[0] + q] +
                     tractions[face.tractions[1] + face.partner[q]];
        // Beside an absent material the jump is the residual of a free face.
        const bool is_free =
          !cells[face.cells[0]].is_present || !cells[face.cells[1]].is_present;
        for (const unsigned int cell : face.cells)
          if (cells[cell].is_present)
            visit(
              {cell,
               shapes[cells[face.cells[0]].shape].faces[face.face],
               is_hanging && cell == face.cells[1] ? 1. / n_face_points : 1.,
               is_free,
               jumps,
               cell == face.cells[1] && !is_free && face.is_within_material});
      }
    for (const BoundaryFace &face : boundary_faces)
      {
        const Residuals residuals = boundary_residuals(
          face,
          fields,
          &tractions[(face.cell * n_faces + face.face) * n_face_points]);
        visit({face.cell,
               shapes[cells[face.cell].shape].faces[face.face],
               1.,
               true,
               residuals});
      }
  }



  template <int dim>
  double
  ResidualEstimator<dim>::factor(const LocalResiduals &r) const
  {
    const double width =
      shapes[cells[r.cell].shape].volume * r.share / r.face.area;
    return (r.is_at_boundary ? 1. / 6. : 1. / 24.) * width;
  }



  template <int dim>
  Vector<double>
  ResidualEstimator<dim>::estimate(const Fields &fields) const
  {
    std::vector<double> eta(cells.size()); // squared
    double              square = 0.;
    visit_residuals(fields, [&](const LocalResiduals &r) {
      if (!r.are_again)
        square = acoustic_square<dim>(cells[r.cell].stiffness,
                                      r.face.normals,
                                      r.face.weights,
                                      r.values);
      for (unsigned int q = 0; r.is_at_boundary && q < n_face_points; ++q)
        square += r.face.weights[q] * 2. *
                  r.values[n_face_points + q].norm_square() /
                  cells[r.cell].stiffness.smallest_deviatoric_eigenvalue();
      eta[r.cell] += factor(r) * square;
    });
    return local.by_active_index(eta);
  }



  template <int dim>
  Vector<double>
  ResidualEstimator<dim>::estimate_geometry(const Fields &fields) const
  {
    std::vector<double> eta(cells.size()); // squared
    for (const BoundaryFace &face : boundary_faces)
      {
        if (face.offset == 0. && face.opposite.empty())
          continue;
        const LocalCell &cell  = cells[face.cell];
        const FaceShape &shape = shapes[cell.shape].faces[face.face];
        const double     stiffness =
          cell.stiffness.smallest_deviatoric_eigenvalue();
        double square = 0.;
        for (unsigned int q = 0; q < n_face_points; ++q)
          {
            Tensor<1, dim> density, u;
            for (unsigned int v = 0; v < n_vertices; ++v)
              for (unsigned int d = 0; d < dim; ++d)
                {
                  const std::size_t i   = cell.nodes[v] + d;
                  const double      phi = face_values[face.face][q][v];
                  density[d] += phi * fields.multiplier_density->begin()[i];
                  u[d] += phi * fields.u.begin()[i];
                }
            double delta = density.norm() > 0. ? face.offset : 0.;
            if (density.norm() == 0. && face.condition->is_unilateral() &&
                !face.opposite.empty() && !face.opposite[q].nodes.empty())
              {
                const auto &opposite = face.opposite[q];
                for (const auto &[node, weight] : opposite.nodes)
                  for (unsigned int d = 0; d < dim; ++d)
                    u[d] -= weight * fields.u.begin()[node + d];
                delta =
                  std::max(0.,
                           u * opposite.normal - opposite.distance -
                             face.condition->gap(face.positions[q], *fields.t) +
                             face.offset + largest_offset);
              }
            const double k = stiffness / face.diameter;
            square += shape.weights[q] * 2. * k * k * delta * delta / stiffness;
          }
        eta[face.cell] += shapes[cell.shape].volume / shape.area / 6. * square;
      }
    return local.by_active_index(eta);
  }



  template <int dim>
  typename ResidualEstimator<dim>::OfDual
  ResidualEstimator<dim>::of_dual(const Fields &dual) const
  {
    OfDual              result;
    std::vector<double> squares(cells.size());
    visit_residuals(dual, [&](const LocalResiduals &r) {
      const double here     = factor(r);
      auto        &weighted = result.weighted.emplace_back();
      for (unsigned int q = 0; q < n_face_points; ++q)
        {
          weighted[q] = here * r.face.weights[q] *
                        acoustic_compliance(cells[r.cell].stiffness,
                                            r.face.normals[q],
                                            r.values[q]);
          squares[r.cell] += weighted[q] * r.values[q];
        }
    });
    result.squares = local.by_active_index(squares);
    return result;
  }



  template <int dim>
  Vector<double>
  ResidualEstimator<dim>::multiply(const Fields &state,
                                   const OfDual &dual) const
  {
    std::vector<double> products(cells.size());
    auto                weighted = dual.weighted.cbegin();
    visit_residuals(state, [&](const LocalResiduals &r) {
      for (unsigned int q = 0; q < n_face_points; ++q)
        products[r.cell] += (*weighted)[q] * r.values[q];
      ++weighted;
    });
    return local.by_active_index(products);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ResidualEstimator);
} // namespace Viscoplastic
