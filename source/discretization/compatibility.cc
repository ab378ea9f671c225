// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/largest_place.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/discretization/compatibility.h>
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/discretization/springs.h>

namespace Viscoplastic
{
  namespace
  {
    /// The boundaries that a node is on. Collective.
    template <int dim>
    std::set<types::boundary_id>
    boundaries_at(const AdmissibleSpace<dim> &space, const Point<dim> &position)
    {
      // Ranks other than the owner of the node may own cells at it.
      std::set<types::boundary_id> here;
      for (const auto &cell : space.cells)
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary())
            for (const unsigned int v : cell->face(f)->vertex_indices())
              if (cell->face(f)->vertex(v) == position)
                here.insert(cell->face(f)->boundary_id());
      return Utilities::MPI::compute_set_union(here, space.communicator);
    }



    /// Find the node with the largest of @p forces, and its boundaries. Forces
    /// of hanging nodes are zero.
    template <int dim>
    void
    locate_largest_force(const AdmissibleSpace<dim>  &space,
                         const DistributedVector     &forces,
                         CompatibilityViolation<dim> &result)
    {
      LargestPlace<dim> largest;
      for (const auto &cell : space.cells)
        for (const unsigned int v : cell->vertex_indices())
          if (const auto dof = cell->vertex_dof_index(v, 0);
              space.owned.is_element(dof))
            {
              Tensor<1, dim> force;
              for (unsigned int d = 0; d < dim; ++d)
                force[d] =
                  forces.begin()[space.owned.index_within_set(dof) + d];
              largest.add(stable_norm(force), cell->vertex(v));
            }
      largest.reduce(space.communicator);
      result.position   = largest.position();
      result.boundaries = boundaries_at(space, result.position);
      const auto axial  = space.owned_axial();
      result.is_axial =
        Utilities::MPI::max(axial ? std::abs(forces.begin()[*axial]) : 0.,
                            space.communicator) > largest.value();
    }



    /// The directions in which a condition prescribes u, and the values.
    template <int dim>
    std::vector<std::pair<Tensor<1, dim>, double>>
    prescribed(const BoundaryCondition<dim> &condition,
               const Point<dim>             &x,
               const double                  t)
    {
      std::vector<std::pair<Tensor<1, dim>, double>> result;
      if (condition.against)
        return result; // it prescribes a jump
      const bool is_normal =
        !condition.is_glued() && (condition.role == BoundaryRole::symmetry ||
                                  condition.role == BoundaryRole::contact);
      if (is_normal && condition.is_bilateral())
        result.emplace_back(condition.normal,
                            condition.foundation_displacement ?
                              condition.foundation_displacement->value(x, t) :
                              0.);
      for (unsigned int d = 0; d < dim && !is_normal; ++d)
        {
          const Tensor<1, dim> axis = Point<dim>::unit_vector(d);
          if (condition.role == BoundaryRole::clamped)
            result.emplace_back(axis, 0.);
          else if (condition.is_glued())
            result.emplace_back(
              axis, condition.glued_displacement(x, condition.normal, t)[d]);
          else if (condition.displacement[d])
            result.emplace_back(axis, condition.displacement[d]->value(x, t));
        }
      return result;
    }



    /// Set distances of obstacles and which of them are touched at t = 0 in
    /// @p contact. Throws ExcMessage if the body is beyond one.
    template <int dim>
    void
    touch_obstacles(const AdmissibleSpace<dim> &space,
                    const ContactFace<dim>     &face,
                    const DistributedVector    &u,
                    ContactState               &contact)
    {
      DistributedVector in_frames = space.owned_vector();
      space.to_frames(u, in_frames);
      double               size = u.linfty_norm(), deepest = 0.;
      const ContactLayout &layout = face.layout();
      for (const unsigned int o : layout.obstacles())
        size = std::max(size, std::abs(contact.gap(o)));
      size = Utilities::MPI::max(size, space.communicator);

      contact.bound = face.step_bounds(0., in_frames, {});
      for (const unsigned int o : layout.compliant(layout.obstacles()))
        contact.sticks[o] = contact.gap(o) < 0.;
      for (const unsigned int o : layout.rigid(layout.obstacles()))
        {
          contact.sticks[o] = contact.gap(o) <= 1e-10 * size;
          deepest           = std::max(deepest, -contact.gap(o));
        }
      deepest = Utilities::MPI::max(deepest, space.communicator);
      // Between curved bodies the gap has an error that is a part of the
      // distance of surfaces from chords.
      double chords = 0.;
      for (const auto &[id, rows] : space.mortar_rows)
        for (const auto &[node, row] : rows)
          chords = std::max(chords, std::abs(row.bulge));
      chords = Utilities::MPI::max(chords, space.communicator);
      if (!(deepest <= std::max(1e-8 * size, 0.1 * chords)))
        refuse("At t = 0 the body is inside of the foundation of unilateral "
               "contact, by " +
               as_text(deepest) +
               ": 'Gap' and 'Foundation displacement' add up to less than "
               "'Initial state/Displacement' takes of it; let them begin with "
               "a gap of zero or more, or set 'Initial state/Equilibrate'.");
    }



    /// Collective.
    template <int dim>
    DisplacementJump<dim>
    largest_jump(const AdmissibleSpace<dim> &space, const double t)
    {
      DistributedVector in_frames = space.owned_vector(),
                        u         = space.ghosted_vector();
      space.set_prescribed(t, in_frames);
      space.to_cartesian(in_frames, u);
      DisplacementJump<dim> result;
      result.t = t;
      LargestPlace<dim> largest;
      for (const auto &cell : space.cells)
        for (const unsigned int f : cell->face_indices())
          if (const auto face = cell->face(f); face->at_boundary())
            for (const unsigned int v : face->vertex_indices())
              {
                const Point<dim> x     = face->vertex(v);
                const auto       first = face->vertex_dof_index(v, 0);
                Tensor<1, dim>   value;
                for (unsigned int d = 0; d < dim; ++d)
                  value[d] =
                    u.begin()[space.relevant.index_within_set(first + d)];
                for (const auto &[direction, datum] : prescribed(
                       space.scene.condition(face->boundary_id()), x, t))
                  {
                    result.largest = std::max(result.largest, std::abs(datum));
                    largest.add(std::abs(direction * value - datum), x);
                  }
              }
      largest.reduce(space.communicator);
      result.largest  = Utilities::MPI::max(result.largest, space.communicator);
      result.size     = largest.value();
      result.position = largest.position();
      result.boundaries = boundaries_at(space, result.position);
      return result;
    }
  } // namespace



  template <int dim>
  CompatibilityViolation<dim>
  compatibility_violation(const AdmissibleSpace<dim> &space,
                          const Load<dim>            &load,
                          const ContactFace<dim>     *face,
                          const DistributedVector    &u,
                          ContactState               &contact)
  {
    DistributedVector residual = load.values;
    space.restrict_to_unknowns(residual);
    double size = residual.l2_norm(), largest = 0.;
    if (space.scene.initial_stress || space.scene.has_initial_thermal_stress())
      {
        // More points than elsewhere keep the quadrature error small.
        DistributedVector internal = work_of_initial_stress(space, 4);
        largest                    = internal.l2_norm();
        space.restrict_to_unknowns(internal);
        size = std::max(size, internal.l2_norm());
        residual -= internal;
      }

    if (space.scene.has_springs() && space.scene.initial_displacement)
      {
        DistributedVector of_springs = space.owned_vector();
        Springs<dim>(space).add_force(u, of_springs);
        space.restrict_to_unknowns(of_springs);
        size = std::max(size, of_springs.l2_norm());
        residual += of_springs;
      }

    if (face != nullptr)
      {
        // (2.12): sigma0 + the subdifferential of j at 0, which are forces
        // within the friction bounds, contains L(0).
        const Vector<double> on_face = face->restriction().gather(residual);
        Vector<double>       force(on_face.size());
        contact = ContactState(face->bounds(0.));
        if (face->has_obstacles())
          touch_obstacles(space, *face, u, contact);
        fit_multipliers(face->layout(), on_face, contact, force);
        if (face->has_computed_pressure())
          {
            face->add_computed_bounds(0., contact, contact.bound);
            fit_multipliers(face->layout(), on_face, contact, force);
          }
        face->restriction().add(-1., force, residual);
      }
    // Where reactions balance the initial stress, `size` is rounding only.
    CompatibilityViolation<dim> result;
    if (size > 1e-12 * largest)
      result.relative = residual.l2_norm() / size;
    if (result.relative > 0.)
      locate_largest_force(space, residual, result);
    return result;
  }



  template <int dim>
  std::optional<DisplacementJump<dim>>
  first_jump(const AdmissibleSpace<dim> &space)
  {
    const TimeSchedule &schedule = space.scene.schedule;
    for (double t = 0.; t < schedule.end_time();)
      {
        t               = schedule.phase_at(t).end;
        const auto jump = largest_jump(space, t);
        if (jump.size > 1e-6 * jump.largest)
          return jump;
      }
    return {};
  }



  VISCOPLASTIC_INSTANTIATE(compatibility_violation);
  VISCOPLASTIC_INSTANTIATE(first_jump);
} // namespace Viscoplastic
