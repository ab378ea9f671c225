// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/householder.h>
#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/contact/kink_search.h>
#include <viscoplastic_contact/contact/statics.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Viscoplastic
{
  namespace
  {
    using Generalized = std::vector<double>;

    /// A misfit below this part of HeldBody::load_size is rounding.
    constexpr double load_rounding = 1e-12;
    /// The same for 3D friction: its round cones are approximated step by step.
    constexpr double rounding_of_cones = 1e-6;
    /// The accuracy of a motion as a proof: the sine of the angle at which it
    /// may enter an obstacle, and the work of friction that it may miss,
    /// relative to that of the loads.
    constexpr double proof_tolerance = 1e-13;
    /// Friction with a bound of this many times the loads counts as unlimited.
    constexpr double without_end = 1e4;
    /// More than needed: a few per rigid motion, more with round friction
    /// cones.
    constexpr unsigned int max_iterations = 1000;



    double
    dot(const Generalized &a, const Generalized &b)
    {
      return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
    }



    double
    norm(const Generalized &a)
    {
      return std::sqrt(dot(a, a));
    }



    /// The work of unit forces at each point on each of the motions.
    std::vector<std::vector<Tensor<1, 2>>>
    work_of_forces(const HeldBody &body)
    {
      std::vector<std::vector<Tensor<1, 2>>> result;
      for (const ContactLayout::Point &point : body.face.points)
        {
          result.emplace_back();
          for (const Vector<double> &motion : body.motions)
            {
              Tensor<1, 2> s =
                slip(point, body.face.node_values(motion, point.node));
              // Motions perpendicular to a row up to rounding do no work.
              for (unsigned int t = 0; t < point.n_tangents; ++t)
                if (std::abs(s[t]) <= 1e-12 * point.map[t].norm())
                  s[t] = 0.;
              result.back().push_back(s);
            }
        }
      return result;
    }



    /// The set of generalized forces (work on the motions) that contact can
    /// balance: a cone of pressures, with the friction that follows from them,
    /// plus friction within given bounds. One more dimension makes the set a
    /// cone: the last entry is 1 for friction of given bounds, 0 for pressures.
    class Resistance
    {
    public:
      /// A generator of the cone, of length 1.
      struct Force
      {
        Generalized value;
        /// Whether its point is on this rank; its obstacle, if any, and
        /// pressure.
        bool         is_here  = false;
        unsigned int obstacle = numbers::invalid_unsigned_int;
        double       pressure = 0.;
      };

      Resistance(const HeldBody                         &body,
                 const std::vector<double>              &bounds,
                 const std::vector<std::vector<double>> &bounds_of_pressure,
                 const double                            unit)
        : body(body)
        , bounds(bounds)
        , bounds_of_pressure(bounds_of_pressure)
        , unit(unit)
        , forces(work_of_forces(body))
      {}

      /// The generator that does most work on a motion. Collective.
      Force
      most_effective(const Generalized &motion) const
      {
        const unsigned int n = body.motions.size();
        // Friction of given bounds at all points is one generator.
        Force friction;
        friction.value.assign(n + 1, 0.);
        Force      best;
        double     largest_work = 0.;
        const auto compare      = [&](Generalized        value,
                                 const unsigned int obstacle) {
          const double length = norm(value);
          if (length == 0. || !(dot(value, motion) > largest_work * length))
            return;
          largest_work = dot(value, motion) / length;
          for (double &x : value)
            x /= length;
          best = {std::move(value), true, obstacle, 1. / length};
        };
        for (unsigned int node = 0; node < body.face.n_nodes(); ++node)
          {
            const unsigned int begin = body.face.first_point[node],
                               first = body.face.first_obstacle(node),
                               end   = body.face.first_point[node + 1];
            for (unsigned int p = begin; p < first; ++p)
              if (bounds[p] <= without_end * unit)
                add_friction(p, bounds[p], motion, friction.value);
              else
                {
                  Generalized value(n + 1, 0.);
                  add_friction(p, 1., motion, value);
                  compare(std::move(value), numbers::invalid_unsigned_int);
                }
            for (unsigned int o = first; o < end; ++o)
              {
                Generalized value(n + 1, 0.);
                for (unsigned int i = 0; i < n; ++i)
                  value[i] = forces[o][i][0];
                if (!bounds_of_pressure.empty())
                  for (unsigned int p = begin; p < first; ++p)
                    add_friction(p,
                                 bounds_of_pressure[p][o - first],
                                 motion,
                                 value);
                compare(std::move(value), o);
              }
          }
        const MPI_Comm communicator = body.face.communicator;
        Utilities::MPI::sum(friction.value, communicator, friction.value);
        for (double &x : friction.value)
          x /= unit;
        friction.value[n]         = 1.;
        const double other_length = norm(friction.value);
        for (double &x : friction.value)
          x /= other_length;

        const auto of_ranks =
          Utilities::MPI::all_gather(communicator, best.value);
        Force result = friction;
        for (unsigned int rank = 0; rank < of_ranks.size(); ++rank)
          if (!of_ranks[rank].empty() &&
              dot(of_ranks[rank], motion) > dot(result.value, motion))
            {
              const bool is_here =
                rank == Utilities::MPI::this_mpi_process(communicator);
              result         = is_here ? best : Force();
              result.value   = of_ranks[rank];
              result.is_here = is_here;
            }
        return result;
      }

    private:
      /// Add the friction of size @p most that does most work on the motion.
      void
      add_friction(const unsigned int p,
                   const double       most,
                   const Generalized &motion,
                   Generalized       &value) const
      {
        Tensor<1, 2> s;
        for (unsigned int i = 0; i < forces[p].size(); ++i)
          s += motion[i] * forces[p][i];
        const double length = s.norm();
        if (most > 0. && length > 0.)
          for (unsigned int i = 0; i < forces[p].size(); ++i)
            value[i] += most / length * (s * forces[p][i]);
      }

      const HeldBody                              &body;
      const std::vector<double>                   &bounds;
      const std::vector<std::vector<double>>      &bounds_of_pressure;
      const double                                 unit;
      const std::vector<std::vector<Tensor<1, 2>>> forces;
    };



    /// The coefficients of the linear combination nearest to the target.
    Generalized
    least_squares(const std::vector<Resistance::Force> &forces,
                  const Generalized                    &target)
    {
      FullMatrix<double> matrix(target.size(), forces.size());
      for (unsigned int j = 0; j < forces.size(); ++j)
        for (unsigned int i = 0; i < target.size(); ++i)
          matrix(i, j) = forces[j].value[i];
      const Householder<double> factors(matrix);
      Vector<double>            right(target.begin(), target.end()),
        solution(forces.size());
      factors.least_squares(solution, right);
      return {solution.begin(), solution.end()};
    }



    /// The eigenvalues and eigenvectors of a symmetric matrix; eigenvalues that
    /// are negligible relative to the largest one are set to zero.
    std::vector<std::pair<double, Generalized>>
    eigenpairs(const FullMatrix<double> &matrix)
    {
      const unsigned int       n = matrix.m();
      LAPACKFullMatrix<double> lapack(n, n);
      lapack = matrix;
      Vector<double>     values;
      FullMatrix<double> vectors;
      const double       most = std::numeric_limits<double>::max();
      lapack.compute_eigenvalues_symmetric(-most, most, 0., values, vectors);
      std::vector<std::pair<double, Generalized>> result(n);
      for (unsigned int e = 0; e < n; ++e)
        {
          if (values[e] > 1e-10 * values.linfty_norm())
            result[e].first = values[e];
          for (unsigned int i = 0; i < n; ++i)
            result[e].second.push_back(vectors(i, e));
        }
      return result;
    }
  } // namespace



  Statics
  balance(const HeldBody                         &body,
          const std::vector<double>              &bounds,
          const std::vector<std::vector<double>> &bounds_of_pressure,
          const double                            accuracy)
  {
    const bool has_round_cones =
      body.face.any(std::any_of(body.face.points.begin(),
                                body.face.points.end(),
                                [](const ContactLayout::Point &point) {
                                  return point.n_tangents > 1;
                                }));
    const double enough =
      has_round_cones ? std::max(accuracy, rounding_of_cones) : accuracy;
    Statics result;
    result.pressures.assign(body.face.points.size(), 0.);
    const double unit = norm(body.load), size = body.load_size;
    if (unit <= load_rounding * size)
      return result;
    const Resistance resistance(body, bounds, bounds_of_pressure, unit);
    Generalized      target(body.load);
    for (double &x : target)
      x /= unit;
    target.push_back(1.);
    std::vector<Resistance::Force> forces; // with positive coefficients
    Generalized                    coefficients, missing(target);
    double                         last     = 2. * norm(target);
    bool                           is_proof = false;
    for (unsigned int n = 0; n < max_iterations; ++n)
      {
        const double left = norm(missing);
        if (left <= enough || left <= load_rounding * size / unit)
          break;
        const auto   force = resistance.most_effective(missing);
        const double work  = dot(force.value, missing) / left;
        // With round cones the misfit stops to fall at rounding of its square.
        is_proof =
          work <= proof_tolerance +
                    10. * std::numeric_limits<double>::epsilon() / left ||
          (!(left < last) && work <= std::sqrt(proof_tolerance));
        if (is_proof || !(left < last))
          break;
        last = left;
        forces.push_back(force);
        coefficients.push_back(0.);
        while (!forces.empty())
          {
            const Generalized solution = least_squares(forces, target);
            // Go as far as all coefficients stay positive.
            double       step    = 1.;
            unsigned int leaving = forces.size();
            for (unsigned int j = 0; j < forces.size(); ++j)
              if (!(solution[j] > 0.))
                {
                  const double there =
                    coefficients[j] / (coefficients[j] - solution[j]);
                  if (!(there > step) || leaving == forces.size())
                    {
                      step    = std::isfinite(there) ? there : 0.;
                      leaving = j;
                    }
                }
            for (unsigned int j = 0; j < forces.size(); ++j)
              coefficients[j] += step * (solution[j] - coefficients[j]);
            if (leaving == forces.size())
              break;
            forces.erase(forces.begin() + leaving);
            coefficients.erase(coefficients.begin() + leaving);
          }
        missing = target;
        for (unsigned int j = 0; j < forces.size(); ++j)
          for (unsigned int i = 0; i < target.size(); ++i)
            missing[i] -= coefficients[j] * forces[j].value[i];
      }
    // Without a proof of the contrary the solve of the step decides.
    result.is_balanced = !is_proof;
    if (is_proof)
      {
        missing.pop_back();
        result.motion = missing;
        return result;
      }
    for (unsigned int j = 0; j < forces.size(); ++j)
      if (forces[j].is_here &&
          forces[j].obstacle != numbers::invalid_unsigned_int)
        result.pressures[forces[j].obstacle] +=
          unit * coefficients[j] * forces[j].pressure;
    return result;
  }



  std::vector<double>
  settle(const HeldBody                  &body,
         const ContactState              &contact,
         const std::vector<Tensor<1, 2>> &slips)
  {
    const ContactLayout &face  = body.face;
    const unsigned int   n     = body.load.size();
    const auto           works = work_of_forces(body);
    const auto           add   = [&](FullMatrix<double> &matrix,
                         const unsigned int  p,
                         const double        stiffness) {
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          matrix(i, j) += stiffness * (works[p][i] * works[p][j]);
    };
    FullMatrix<double> prevented(n, n);
    for (unsigned int p = 0; p < face.points.size(); ++p)
      if (contact.blocks(face.points[p], p))
        add(prevented, p, 1.);
    Utilities::MPI::sum(prevented, face.communicator, prevented);
    std::vector<Generalized> free;
    for (const auto &[value, motion] : eigenpairs(prevented))
      if (value == 0.)
        free.push_back(motion);

    Generalized  motion(n, 0.);
    ContactState state(contact);
    state.slip = slips;
    // Newton's method with a line search. If it ends early, the solves of the
    // step merely begin farther from their solution.
    for (unsigned int iteration = 0; iteration < 100 && !free.empty();
         ++iteration)
      {
        Generalized        force(n, 0.);
        FullMatrix<double> stiffness(n, n);
        for (unsigned int p = 0; p < face.points.size(); ++p)
          {
            const ContactLayout::Point &point = face.points[p];
            const Tensor<1, 2> multiplier = state.multiplier_of_slip(point, p);
            for (unsigned int i = 0; i < n; ++i)
              force[i] -= multiplier * works[p][i];
          }
        for (const unsigned int o : face.compliant(face.obstacles()))
          add(stiffness,
              o,
              face.points[o].compliance.slope(state.penetration(o)));
        Utilities::MPI::sum(force, face.communicator, force);
        Utilities::MPI::sum(stiffness, face.communicator, stiffness);
        const double size = norm(body.load) + norm(force);
        for (unsigned int i = 0; i < n; ++i)
          force[i] += body.load[i];

        FullMatrix<double> reduced(free.size(), free.size());
        for (unsigned int a = 0; a < free.size(); ++a)
          for (unsigned int b = 0; b < free.size(); ++b)
            for (unsigned int i = 0; i < n; ++i)
              for (unsigned int j = 0; j < n; ++j)
                reduced(a, b) += free[a][i] * stiffness(i, j) * free[b][j];
        reduced.symmetrize();
        Generalized step(n, 0.);
        for (const auto &[value, direction] : eigenpairs(reduced))
          if (value > 0.)
            {
              Generalized in_motions(n, 0.);
              for (unsigned int a = 0; a < free.size(); ++a)
                for (unsigned int i = 0; i < n; ++i)
                  in_motions[i] += direction[a] * free[a][i];
              const double part = dot(in_motions, force);
              if (std::abs(part) > 1e-14 * size)
                for (unsigned int i = 0; i < n; ++i)
                  step[i] += part / value * in_motions[i];
            }
        Vector<double> change(face.n_dofs());
        for (unsigned int i = 0; i < n; ++i)
          face.add(step[i], body.motions[i], change);
        const double length =
          repetitions({dot(step, force), 0.}, face, state, change);
        if (length == 0.)
          break;
        for (unsigned int i = 0; i < n; ++i)
          motion[i] += length * step[i];
        for (unsigned int p = 0; p < face.points.size(); ++p)
          for (unsigned int i = 0; i < n; ++i)
            state.slip[p] += length * step[i] * works[p][i];
      }
    return motion;
  }
} // namespace Viscoplastic
