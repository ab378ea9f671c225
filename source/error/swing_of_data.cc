// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/swing_of_data.h>

namespace Viscoplastic
{
  namespace
  {
    /// Return the distance of a vector of @p n components from the ball whose
    /// diameter connects @p a and @p b: for numbers their range, for vectors
    /// the same in all frames.
    double
    beyond(const double      *value,
           const double      *a,
           const double      *b,
           const unsigned int n)
    {
      double distance = 0., diameter = 0.;
      for (unsigned int i = 0; i < n; ++i)
        {
          distance += Utilities::fixed_power<2>(value[i] - 0.5 * (a[i] + b[i]));
          diameter += Utilities::fixed_power<2>(a[i] - b[i]);
        }
      // Most are in the ball, which roots need not tell.
      return distance <= 0.25 * diameter ?
               0. :
               std::sqrt(distance) - 0.5 * std::sqrt(diameter);
    }



    template <int dim>
    bool
    loads_depend_on_time(const Scene<dim> &scene)
    {
      return (scene.body_force && scene.body_force->depends_on_time()) ||
             (scene.axial_force && scene.axial_force->depends_on_time()) ||
             std::any_of(scene.boundary.begin(),
                         scene.boundary.end(),
                         [](const auto &pair) {
                           return pair.second.carries_load() &&
                                  pair.second.load_depends_on_time();
                         });
    }



    template <int dim>
    bool
    displacements_depend_on_time(const Scene<dim> &scene)
    {
      const auto varies = [](const auto &datum) {
        return datum && datum->depends_on_time();
      };
      return varies(scene.axial_strain) ||
             std::any_of(scene.boundary.begin(),
                         scene.boundary.end(),
                         [&](const auto &pair) {
                           const BoundaryCondition<dim> &condition =
                             pair.second;
                           return std::any_of(condition.displacement.begin(),
                                              condition.displacement.end(),
                                              varies) ||
                                  (condition.constrains() &&
                                   (varies(condition.foundation_displacement) ||
                                    (condition.is_glued() &&
                                     condition.foundation_motion)));
                         });
    }



    /// Call @p add for each node, of dim consecutive values of @p n, with the
    /// distance of beyond() and the square of @p value.
    template <int dim, typename Add>
    void
    for_each_node(const std::size_t n,
                  const double     *left,
                  const double     *value,
                  const double     *right,
                  const Add        &add)
    {
      for (std::size_t i = 0; i < n; i += dim)
        {
          double square = 0.;
          for (unsigned int d = 0; d < dim; ++d)
            square += Utilities::fixed_power<2>(value[i + d]);
          add(beyond(value + i, left + i, right + i, dim), square);
        }
    }



    /// Return (int E^-1 sigma : sigma)^{1/2}. Collective.
    template <int dim>
    double
    stress_norm(const StressSpace<dim> &stress_space, const State<dim> &state)
    {
      const unsigned int                 n = stress_space.n_samples;
      std::vector<SymmetricTensor<2, 3>> strains(n);
      double                             square = 0.;
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        {
          const Stiffness &stiffness = stress_space.moduli(c);
          stress_space.strains(c, state.u.begin(), strains.data());
          for (unsigned int s = 0; s < n; ++s)
            {
              strains[s] = stiffness.stress(strains[s]);
              if (!state.z.empty())
                strains[s] += state.z[c * n + s];
            }
          square += stress_space.complementary_square(c, strains.data());
        }
      return std::sqrt(
        Utilities::MPI::sum(square, stress_space.space.communicator));
    }


    /// The time-dependent data of a step that affect later states.
    template <int dim>
    class DataInStep
    {
    public:
      DataInStep(const Discretization<dim> &d,
                 const EvaluatedState<dim> &accepted,
                 const EvaluatedState<dim> &end)
        : slips(d.slipping_face() != nullptr)
        , remembers(slips || d.scene().has_viscosity())
        , loads_vary(remembers && loads_depend_on_time(d.scene()))
        , bounds_vary(slips && d.face->bounds_depend_on_time())
        , moves(remembers && displacements_depend_on_time(d.scene()))
        , slides(slips && d.scene().has_moving_foundation())
        , d(d)
        , accepted(accepted)
        , end(end)
        , t_old(accepted.state.t)
      {
        const double t = end.state.t;
        if (bounds_vary)
          {
            rates         = d.face->slip_rates(accepted.state.velocity,
                                       t_old - accepted.state.k,
                                       t_old);
            bounds_before = bounds_at(t_old);
            bounds_after  = bounds_at(t);
          }
        if (moves)
          {
            prescribed_before = prescribed_at(t_old);
            prescribed_after  = prescribed_at(t);
          }
        if (slides)
          sliding = d.face->foundation_step(t_old, t);
      }

      const bool slips, remembers, loads_vary, bounds_vary, moves, slides;

      /// The distances of data from the range of their values at the ends.
      struct Deviation
      {
        /// Squared: of loads and friction bounds, and the loads themselves.
        double loads, forces;
        /// The work of friction in the deviation of foundations.
        double work;
        /// Of displacements, gaps and foundations; maximum on this rank.
        double motion = 0.;
      };

      /// Return the deviations at a time. Collective.
      Deviation
      at(const double time) const
      {
        std::vector<double> sums(4, 0.);
        Deviation           result{};
        double             &motion = result.motion;
        if (loads_vary)
          {
            const Load<dim> now = d.loads.assemble(time);
            for_each_node<dim>(now.values.locally_owned_size(),
                               accepted.forces.load.values.begin(),
                               now.values.begin(),
                               end.forces.load.values.begin(),
                               [&](const double distance, const double square) {
                                 sums[0] += distance * distance;
                                 sums[1] += square;
                               });
          }
        if (bounds_vary)
          {
            const std::vector<double> now      = bounds_at(time);
            const auto                of_point = [&](const unsigned int p) {
              return beyond(&now[p], &bounds_before[p], &bounds_after[p], 1);
            };
            for (const unsigned int p : d.face->layout().friction_points())
              sums[2] += Utilities::fixed_power<2>(of_point(p));
            // The bound of an obstacle is its gap.
            for (const unsigned int o : d.face->layout().obstacles())
              motion = std::max(motion, of_point(o));
          }
        if (moves)
          {
            const std::vector<double> now = prescribed_at(time);
            for_each_node<dim>(now.size(),
                               prescribed_before.data(),
                               now.data(),
                               prescribed_after.data(),
                               [&](const double of_node, const double) {
                                 motion = std::max(motion, of_node);
                               });
          }
        if (slides)
          {
            const std::vector<Tensor<1, 2>> now =
              d.face->foundation_step(t_old, time);
            const Tensor<1, 2> start;
            for (unsigned int p = 0; p < now.size(); ++p)
              {
                const double of_point =
                  beyond(&now[p][0], &start[0], &sliding[p][0], 2);
                motion = std::max(motion, of_point);
                sums[3] += end.state.contact.bound[p] * of_point;
              }
          }
        Utilities::MPI::sum(sums, d.space.communicator, sums);
        result.loads  = sums[0] + sums[2];
        result.forces = sums[1];
        result.work   = sums[3];
        return result;
      }

    private:
      std::vector<double>
      bounds_at(const double time) const
      {
        std::vector<double> bounds = d.face->bounds(time, rates);
        d.face->add_computed_bounds(time,
                                    accepted.state.contact,
                                    bounds,
                                    rates);
        return bounds;
      }

      /// Return the prescribed values at constrained nodes, dim numbers each.
      std::vector<double>
      prescribed_at(const double time) const
      {
        std::vector<double> values;
        if (const auto &axial = d.scene().axial_strain;
            axial && d.space.owned_axial())
          {
            values.resize(dim);
            values[0] = d.space.axial_length * axial->value(Point<dim>(), time);
          }
        for (const auto &node : d.space.boundary_nodes())
          if (d.space.frame(node.frame).n_fixed > 0)
            {
              const Tensor<1, dim> at_node = d.space.prescribed_at(node, time);
              values.insert(values.end(),
                            at_node.begin_raw(),
                            at_node.end_raw());
            }
        return values;
      }

      const Discretization<dim> &d;
      const EvaluatedState<dim> &accepted, &end;
      const double               t_old;
      std::vector<double> rates, bounds_before, bounds_after, prescribed_before,
        prescribed_after;
      std::vector<Tensor<1, 2>> sliding;
    };
  } // namespace



  template <int dim>
  Swing
  swing_of_data(const Discretization<dim> &d,
                const EvaluatedState<dim> &accepted,
                const EvaluatedState<dim> &end)
  {
    const DataInStep<dim> data(d, accepted, end);
    if (!(data.loads_vary || data.bounds_vary || data.moves || data.slides))
      return {};
    // distribute_nodes() numbers the components of a node one after the other.
    Assert(end.forces.load.values.locally_owned_size() % dim == 0,
           ExcInternalError());
    const double t_old = accepted.state.t, t = end.state.t;
    double loads = 0., forces = end.forces.internal.norm_sqr(), motion = 0.,
           work = 0.;
    for (const double part : {0.25, 0.5, 0.75})
      {
        const auto now = data.at(t_old + part * (t - t_old));
        loads          = std::max(loads, now.loads);
        forces         = std::max(forces, now.forces);
        motion         = std::max(motion, now.motion);
        work           = std::max(work, now.work);
      }
    motion = Utilities::MPI::max(motion, d.space.communicator);
    const double remembered =
      data.slips || !end.rate ?
        1. :
        std::min(1., end.state.k * end.rate->relaxation_rate);
    Swing swing;
    // A smaller deviation is rounding. A friction bound without any force does
    // no work; motions of foundations are counted below.
    if (forces > 0. && loads > 1e-20 * forces)
      {
        swing.share = remembered * std::sqrt(loads / forces);
        swing.energy_norm =
          swing.share * stress_norm(d.stress_space, end.state);
      }
    const double size =
      std::max(accepted.forces.u.linfty_norm(), end.forces.u.linfty_norm());
    if (motion > 1e-10 * size)
      {
        // The energy norm scales with the displacement; friction makes at most
        // the error of its work, rho times the way there and back.
        const double of_friction = std::sqrt(2. * work);
        double       share = 1., energy_norm = of_friction;
        if (size > 0.)
          {
            share = remembered * motion / size;
            energy_norm =
              share * std::sqrt(2. * std::max(0., end.forces.strain_energy));
            if (data.slides && !data.moves && !data.bounds_vary)
              energy_norm = std::min(energy_norm, of_friction);
          }
        swing.share       = std::hypot(swing.share, share);
        swing.energy_norm = std::hypot(swing.energy_norm, energy_norm);
      }
    return swing;
  }



  VISCOPLASTIC_INSTANTIATE(swing_of_data);
} // namespace Viscoplastic
