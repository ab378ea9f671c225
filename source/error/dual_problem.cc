// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>

#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/dual_problem.h>

namespace Viscoplastic
{
  namespace
  {
    /// Return the part of @p v in the directions that @p condition prescribes
    /// or couples by contact or friction on a face with this normal.
    template <int dim>
    Tensor<1, dim>
    held(const BoundaryCondition<dim> &condition,
         const Tensor<1, dim>         &v,
         const Tensor<1, dim>         &normal)
    {
      if (condition.prescribes_all())
        return v;
      const Tensor<1, dim> along = tangential(v, normal);
      Tensor<1, dim>       result;
      if (condition.is_bilateral() || condition.is_unilateral())
        result += v - along;
      if (condition.has_friction())
        result += along;
      for (unsigned int d = 0; d < dim; ++d)
        if (condition.displacement[d])
          result[d] = v[d];
      return result;
    }
  } // namespace



  template <int dim>
  DualProblem<dim>::DualProblem(const Discretization<dim> &discretization,
                                const QuantityOfInterest  &quantity)
    : discretization(discretization)
    , quantity(quantity)
    , point_load(discretization.space.owned_vector())
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    if (const auto axial = space.owned_axial();
        axial && quantity.kind == QuantityOfInterest::Kind::axial_strain)
      point_load.begin()[*axial] = 1. / space.axial_length;
    if (quantity.is_force())
      find_meetings();
    if (quantity.kind != QuantityOfInterest::Kind::displacement)
      return;
    probe.emplace(space, space.scene.output_points[quantity.number]);
    std::vector<double> cartesian(space.relevant.n_elements());
    probe->add_force(Point<dim>::unit_vector(quantity.component), cartesian);
    space.add_cartesian_load(cartesian, point_load);
    make_load_density(cartesian);
  }



  template <int dim>
  void
  DualProblem<dim>::find_meetings()
  {
    using Kind                        = QuantityOfInterest::Kind;
    const AdmissibleSpace<dim> &space = discretization.space;
    DistributedVector           w     = space.ghosted_vector();
    const Tensor<1, dim>        direction =
      Point<dim>::unit_vector(quantity.component);
    space.to_cartesian(prescribed(), w);
    std::map<const BoundaryCondition<dim> *, IndexSet> planes; // of symmetry
    for (const auto &[id, condition] : space.scene.boundary)
      if (condition.role == BoundaryRole::symmetry)
        planes[&condition] = DoFTools::extract_boundary_dofs(space.dof_handler,
                                                             ComponentMask(),
                                                             {id});
    FEFaceValues<dim> face_values(space.mapping,
                                  space.dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_values | update_normal_vectors |
                                    update_JxW_values);
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      for (const unsigned int f : space.cells[c]->face_indices())
        {
          const auto &cell = space.cells[c];
          if (!cell->at_boundary(f))
            continue;
          const auto                    id = cell->face(f)->boundary_id();
          const BoundaryCondition<dim> &condition = space.scene.boundary.at(id);
          // On a pair of bodies w is a jump, not a trace.
          if (condition.against)
            continue;
          face_values.reinit(cell, f);
          const Tensor<1, dim> nu = face_values.normal_vector(0);
          // The value of w that J prescribes on its own boundary.
          Tensor<1, dim>       own;
          const Tensor<1, dim> along = tangential(direction, nu);
          if (quantity.kind == Kind::reaction && id == quantity.number)
            own = held(condition, direction, nu);
          else if (quantity.kind == Kind::friction_force &&
                   condition.has_friction() && quantity.is_of(id))
            own = along;
          else if (quantity.kind == Kind::contact_force &&
                   condition.is_unilateral() && quantity.is_of(id))
            own = direction - along;
          for (const unsigned int v : cell->vertex_indices())
            {
              Tensor<1, dim> at_node;
              for (unsigned int d = 0; d < dim; ++d)
                at_node[d] = w(cell->vertex_dof_index(v, d));
              Tensor<1, dim> excess = held(condition, at_node, nu) - own;
              // BoundaryDefects accounts for friction on sliding foundations,
              // and there is no shear beside a plane of symmetry.
              if (condition.has_friction() && condition.foundation_motion)
                excess -= tangential(excess, nu);
              for (const auto &[plane, nodes] : planes)
                if (plane->id != id &&
                    nodes.is_element(cell->vertex_dof_index(v, 0)))
                  excess -= (excess * plane->normal) * plane->normal;
              // The tolerance is large since nodal normals of curved boundaries
              // differ from those of faces.
              if (excess.norm() < 0.1 ||
                  face_values.shape_value(v * dim, 0) < 1e-10)
                continue;
              for (const unsigned int q :
                   face_values.quadrature_point_indices())
                for (unsigned int i = 0; i < dim; ++i)
                  for (unsigned int j = 0; j < dim; ++j)
                    meetings[c][i][j] += (i == j ? 1. : 0.5) * excess[i] *
                                         face_values.normal_vector(q)[j] *
                                         face_values.shape_value(v * dim, q) *
                                         face_values.JxW(q);
            }
        }
    n_meetings = Utilities::MPI::sum(meetings.size(), space.communicator);
  }



  template <int dim>
  void
  DualProblem<dim>::add_at_meetings(const State<dim> &state,
                                    Vector<double>   &parts) const
  {
    if (meetings.empty())
      return;
    const std::vector<SymmetricTensor<2, 3>> stress =
      discretization.stress_space.mean_stress(state.u, state.z);
    for (const auto &[c, of_cell] : meetings)
      parts[discretization.space.cells[c]->active_cell_index()] +=
        stress[c] * of_cell;
  }



  template <int dim>
  void
  DualProblem<dim>::make_load_density(const std::vector<double> &force)
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    // A plane of symmetry is no boundary of the whole body.
    std::set<types::boundary_id> ids;
    for (const auto &[id, condition] : space.scene.boundary)
      if (condition.role != BoundaryRole::symmetry)
        ids.insert(id);
    const auto  weights = boundary_weights(space, ids);
    const auto &hanging = space.cartesian_hanging_nodes();
    LinearAlgebra::distributed::Vector<double> forces(space.owned,
                                                      space.relevant,
                                                      space.communicator);
    for (std::size_t i = 0; i < force.size(); ++i)
      if (force[i] != 0.)
        {
          const auto dof = space.relevant.nth_index_in_set(i);
          if (!hanging.is_constrained(dof))
            forces(dof) += force[i];
          else
            for (const auto &[parent, share] :
                 *hanging.get_constraint_entries(dof))
              forces(parent) += share * force[i];
        }
    forces.compress(VectorOperation::add);
    DistributedVector values = space.owned_vector();
    for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
      if (const double weight = weights.local_element(i - i % dim); weight > 0.)
        values.begin()[i] = forces.local_element(i) / weight;
    space.distribute_hanging_nodes(values);
    load_density = space.ghosted_vector();
    load_density = values;
  }



  template <int dim>
  double
  DualProblem<dim>::value(const State<dim>  &state,
                          const Forces<dim> &forces) const
  {
    const unsigned int d = quantity.component;
    switch (quantity.kind)
      {
        case QuantityOfInterest::Kind::friction_force:
        case QuantityOfInterest::Kind::contact_force:
          {
            const bool is_contact =
              quantity.kind == QuantityOfInterest::Kind::contact_force;
            if (quantity.number == QuantityOfInterest::all)
              return discretization.face->resultant(state.contact,
                                                    is_contact)[d];
            const auto forces_of =
              discretization.face->forces_by_boundary(state.contact)
                .at(quantity.number);
            return (is_contact ? forces_of.contact : forces_of.friction)[d];
          }
        case QuantityOfInterest::Kind::friction_dissipation:
          {
            const ContactState  &contact = state.contact;
            double               work    = 0.;
            const ContactLayout &face    = discretization.face->layout();
            for (const unsigned int p : face.friction_points())
              if (!contact.sticks[p])
                work += contact.multiplier[p] * contact.slip[p];
            return face.sum(work);
          }
        case QuantityOfInterest::Kind::reaction:
          return reactions(discretization.space, forces).at(quantity.number)[d];
        case QuantityOfInterest::Kind::axial_force:
          return axial_force(discretization.space, forces);
        default:
          {
            DistributedVector        difference;
            const DistributedVector &u =
              reported_displacement(discretization.scene(), state, difference);
            return probe ? probe->value(u)[d] :
                           discretization.space.axial_strain(u.begin());
          }
      }
  }



  template <int dim>
  double
  DualProblem<dim>::size_of_parts(const State<dim>  &state,
                                  const Forces<dim> &forces) const
  {
    double sum = 0.;
    if (quantity.kind == QuantityOfInterest::Kind::reaction)
      {
        const DistributedVector w = prescribed();
        for (std::size_t i = 0; i < w.locally_owned_size(); ++i)
          sum += std::abs(w.begin()[i] * (forces.internal.begin()[i] -
                                          forces.load.values.begin()[i]));
      }
    else if (quantity.is_force() && discretization.face)
      for (const Tensor<1, 2> &multiplier : state.contact.multiplier)
        sum += multiplier.norm();
    return Utilities::MPI::sum(sum, discretization.space.communicator);
  }



  template <int dim>
  DistributedVector
  DualProblem<dim>::right_side(const ContactState &contact) const
  {
    DistributedVector       result = point_load;
    const ContactFace<dim> *face   = discretization.slipping_face();
    if (quantity.kind == QuantityOfInterest::Kind::friction_dissipation &&
        face != nullptr)
      {
        const ContactLayout &layout = face->layout();
        Vector<double>       force(layout.n_dofs());
        for (const unsigned int p : layout.friction_points())
          if (!contact.sticks[p])
            layout.add_node_values(node_force(layout.points[p],
                                              contact.multiplier[p]),
                                   layout.points[p].node,
                                   force);
        face->restriction().add(1., force, result);
      }
    return result;
  }



  template <int dim>
  DistributedVector
  DualProblem<dim>::prescribed() const
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    const Tensor<1, dim>        direction =
      Point<dim>::unit_vector(quantity.component);
    DistributedVector w = space.owned_vector();
    if (quantity.kind == QuantityOfInterest::Kind::reaction)
      // The transpose of what reactions() does with nodal forces.
      for (const auto &node : space.boundary_nodes())
        {
          const NodalFrame<dim> &frame = space.frame(node.frame);
          if (frame.n_fixed == 0)
            continue;
          Tensor<1, dim> parts;
          for (unsigned int i = 0; i < frame.n_fixed; ++i)
            if (frame.condition_boundary[i] == quantity.number)
              parts[i] = frame.condition_direction[i] * direction;
          const Tensor<1, dim> value = invert(condition_matrix(frame)) * parts;
          const std::size_t    first =
            space.owned.index_within_set(node.first_dof);
          for (unsigned int i = 0; i < frame.n_fixed; ++i)
            w.begin()[first + frame.fixed[i]] = value[i];
        }
    if (const auto axial = space.owned_axial();
        axial && quantity.kind == QuantityOfInterest::Kind::axial_force)
      w.begin()[*axial] = space.axial_length;
    const ContactFace<dim> *face = discretization.slipping_face();
    const bool              is_contact_force =
      quantity.kind == QuantityOfInterest::Kind::contact_force;
    if ((quantity.kind == QuantityOfInterest::Kind::friction_force ||
         is_contact_force) &&
        face != nullptr)
      {
        // Against another body, w is the jump in this direction.
        DistributedVector at_boundary = space.owned_vector();
        for (const auto &node : space.boundary_nodes())
          {
            const Tensor<1, dim> in_frame =
              transpose(space.frame(node.frame).directions) * direction;
            const std::size_t first =
              space.owned.index_within_set(node.first_dof);
            for (unsigned int d = 0; d < dim; ++d)
              at_boundary.begin()[first + d] = in_frame[d];
          }
        Vector<double> on_face = face->restriction().gather(at_boundary);
        // Friction has no component along obstacle normals, and contact has no
        // other. For one boundary, J takes its share of the force at each node.
        const ContactLayout &layout = face->layout();
        const auto           share  = [&](const unsigned int p) {
          return quantity.number == QuantityOfInterest::all ?
                              1. :
                              face->area_share(quantity.number, p);
        };
        for (unsigned int n = 0; n < layout.n_nodes(); ++n)
          {
            Tensor<1, 3> rest = layout.node_values(on_face, n), contact,
                         friction;
            const auto take = [&](const Tensor<1, 3> &along) {
              const Tensor<1, 3> part =
                (along * rest) / along.norm_square() * along;
              rest -= part;
              return part;
            };
            const unsigned int first          = layout.first_point[n],
                               first_obstacle = layout.first_obstacle(n);
            for (const unsigned int o : layout.obstacles(n))
              contact += share(o) * take(layout.points[o].map[0]);
            // At an edge, each of several points acts along its directions.
            for (unsigned int p = first; p + 1 < first_obstacle; ++p)
              for (unsigned int i = 0; i < layout.points[p].n_tangents; ++i)
                friction += share(p) * take(layout.points[p].map[i]);
            if (first < first_obstacle)
              friction += share(first_obstacle - 1) * rest;
            layout.set_node_values(is_contact_force ? contact : friction,
                                   n,
                                   on_face);
          }
        face->restriction().set(on_face, w);
      }
    return w;
  }



  template <int dim>
  void
  DualProblem<dim>::prescribe_work_of_pressure(const ContactState &contact,
                                               const CoulombLaw   &law,
                                               const double        slip_steps,
                                               DistributedVector  &w) const
  {
    const ContactLayout &face = discretization.face->layout();
    Vector<double>       on_face(face.n_dofs());
    for (const unsigned int p : face.friction_points())
      if (!contact.sticks[p])
        {
          const unsigned int node = face.points[p].node;
          unsigned int       o    = face.first_obstacle(node);
          const double       path = slip_steps * contact.slip[p].norm();
          for (const double coefficient : law.of_pressure[p])
            {
              Tensor<1, 2> worth;
              worth[0] = coefficient * path;
              face.add_node_values(motion_with_slip(face.points[o++], worth),
                                   node,
                                   on_face);
            }
        }
    discretization.face->restriction().set(on_face, w);
  }



  template <int dim>
  std::vector<double>
  DualProblem<dim>::change_by_bounds(const ContactState      &contact,
                                     const DualSolution<dim> &dual,
                                     const double             slip_steps) const
  {
    const ContactFace<dim> &face     = *discretization.face;
    DistributedVector       relative = dual.w;
    if (quantity.kind == QuantityOfInterest::Kind::friction_force)
      relative -= prescribed();
    const std::vector<Tensor<1, 2>> of_w = face.slips(relative);
    std::vector<double>             result(contact.n_points());
    for (const unsigned int p : face.layout().friction_points())
      if (const double slip = contact.slip[p].norm();
          !contact.sticks[p] && slip > 0.)
        result[p] = (quantity.is_sum() ? slip_steps * slip : 0.) -
                    contact.slip[p] * of_w[p] / slip;
    return result;
  }



  template <int dim>
  DistributedVector
  DualProblem<dim>::density(const Vector<double> &force) const
  {
    const ContactLayout &face = discretization.face->layout();
    ContactState         held(std::vector<double>(face.points.size(), 0.));
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      {
        const Tensor<1, 3> here = face.node_values(force, n);
        for (const unsigned int p : face.friction_points(n))
          held.multiplier[p] =
            slip(face.points[p], here) / double(face.friction_points(n).size());
        for (const unsigned int o : face.obstacles(n))
          held.multiplier[o] =
            slip(face.points[o], here) /
            (face.obstacles(n).size() * face.points[o].map[0].norm_square());
      }
    return discretization.face->density(held);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(DualProblem);
} // namespace Viscoplastic
