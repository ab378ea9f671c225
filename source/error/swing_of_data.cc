// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/error/swing_of_data.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// How far a vector of @p n components is from the ball that has two others
    /// as the ends of a diameter: from the range of two numbers, and for
    /// vectors the same in all frames.
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
      return std::max(0., std::sqrt(distance) - 0.5 * std::sqrt(diameter));
    }



    template <int dim>
    bool
    loads_depend_on_time(const Scene<dim> &scene)
    {
      return (scene.body_force && scene.body_force->depends_on_time()) ||
             std::any_of(scene.boundary.begin(),
                         scene.boundary.end(),
                         [](const auto &pair) {
                           return pair.second.carries_load() &&
                                  pair.second.load_depends_on_time();
                         });
    }



    /// (int E^-1 sigma : sigma)^{1/2}.
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
              SymmetricTensor<2, 3> stress = stiffness.stress(strains[s]);
              if (!state.z.empty())
                stress += state.z[c * n + s];
              square += stress_space.weight(c, s) *
                        stiffness.complementary_square(stress);
            }
        }
      return std::sqrt(
        Utilities::MPI::sum(square, stress_space.space.communicator));
    }
  } // namespace



  template <int dim>
  Swing
  swing_of_data(const Discretization<dim> &d,
                const EvaluatedState<dim> &accepted,
                const EvaluatedState<dim> &end)
  {
    const bool slips       = d.slipping_face() != nullptr,
               varies      = loads_depend_on_time(d.scene()),
               bounds_vary = slips && d.face->bounds_depend_on_time();
    if ((!slips && !d.scene().has_viscosity()) || (!varies && !bounds_vary))
      return {};
    const double              t_old = accepted.state.t, t = end.state.t;
    const ContactState       &contact = accepted.state.contact;
    const std::vector<double> rates =
      bounds_vary ? d.face->slip_rates(accepted.state.velocity,
                                       t_old - accepted.state.k,
                                       t_old) :
                    std::vector<double>();
    const auto bounds_at = [&](const double time) {
      std::vector<double> bounds = d.face->bounds(time, rates);
      d.face->add_computed_bounds(time, contact, bounds, rates);
      return bounds;
    };
    std::vector<double> bounds_before, bounds_after;
    if (bounds_vary)
      {
        bounds_before = bounds_at(t_old);
        bounds_after  = bounds_at(t);
      }
    const DistributedVector &before = accepted.forces.load.values,
                            &after  = end.forces.load.values;
    double largest = 0., forces = end.forces.internal.norm_sqr();
    for (const double part : {0.25, 0.5, 0.75})
      {
        const double        time = t_old + part * (t - t_old);
        std::vector<double> sums(3, 0.);
        if (varies)
          {
            const Load<dim> load = d.loads.assemble(time);
            const double   *now = load.values.begin(), *left = before.begin(),
                         *right = after.begin();
            // Node by node.
            for (unsigned int i = 0; i < before.locally_owned_size(); i += dim)
              {
                sums[0] += Utilities::fixed_power<2>(
                  beyond(now + i, left + i, right + i, dim));
                for (unsigned int d = 0; d < dim; ++d)
                  sums[1] += Utilities::fixed_power<2>(now[i + d]);
              }
          }
        if (bounds_vary)
          {
            const std::vector<double> now = bounds_at(time);
            for (unsigned int p = 0; p < contact.n_points(); ++p)
              if (!d.face->layout().points[p].is_obstacle)
                sums[2] += Utilities::fixed_power<2>(
                  beyond(&now[p], &bounds_before[p], &bounds_after[p], 1));
          }
        Utilities::MPI::sum(sums, d.space.communicator, sums);
        largest = std::max(largest, sums[0] + sums[2]);
        forces  = std::max(forces, sums[1]);
      }
    // Below this it is rounding.
    if (!(largest > 1e-20 * forces))
      return {};
    const double remembered =
      slips     ? 1. :
      !end.rate ? 1. :
                  std::min(1., end.state.k * end.rate->relaxation_rate);
    const double share = remembered * std::sqrt(largest / forces);
    return {share, share * stress_norm(d.stress_space, end.state)};
  }



  template Swing
  swing_of_data<2>(const Discretization<2> &,
                   const EvaluatedState<2> &,
                   const EvaluatedState<2> &);
  template Swing
  swing_of_data<3>(const Discretization<3> &,
                   const EvaluatedState<3> &,
                   const EvaluatedState<3> &);
} // namespace Viscoplastic
