// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/contact/node_forces.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// Eigenvalues below this part of the largest one count as zero.
    constexpr double least_hold = 1e-12;
    /// The weight of pressures in the least norm at nodes that can move into a
    /// compliant obstacle: pressures carry what they can before the friction of
    /// another piece does. It magnifies rounding of friction.
    constexpr double preference_of_pressures = 1e4;
    /// Friction that is within this relative distance of its bound stays at it.
    constexpr double at_limit = 1e-8;



    /// The pseudo-inverse: least-norm solutions of least squares, by column.
    FullMatrix<double>
    pseudo_inverse(const FullMatrix<double> &matrix)
    {
      FullMatrix<double> result(matrix.n(), matrix.m());
      if (matrix.empty())
        return result;
      FullMatrix<double> product(matrix.m(), matrix.m());
      matrix.mTmult(product, matrix);
      LAPACKFullMatrix<double> gram(matrix.m());
      gram = product;
      gram.compute_inverse_svd(least_hold);
      Vector<double> unit(matrix.m()), y(matrix.m()), x(matrix.n());
      for (unsigned int j = 0; j < matrix.m(); ++j)
        {
          unit    = 0.;
          unit[j] = 1.;
          gram.vmult(y, unit);
          matrix.Tvmult(x, y);
          for (unsigned int i = 0; i < matrix.n(); ++i)
            result(i, j) = x[i];
        }
      return result;
    }



    /// Project onto the cone |lambda| <= given + coefficient p, p >= 0.
    void
    clip_to_cone(const double  given,
                 const double  coefficient,
                 double       &pressure,
                 Tensor<1, 2> &lambda)
    {
      const double size = stable_norm(lambda);
      double       p    = std::max(0., pressure);
      if (size > given + coefficient * p)
        p = std::max(0.,
                     (pressure + coefficient * (size - given)) /
                       (1. + coefficient * coefficient));
      pressure           = p;
      const double bound = given + coefficient * p;
      if (size > bound)
        lambda *= bound / size;
    }
  } // namespace



  NodeForces::NodeForces(const ContactLayout       &face,
                         const unsigned int         node,
                         const ContactState        &state,
                         const CoulombCoefficients *law)
    : face(face)
    , node(node)
    , begin(face.first_point[node])
    , end(face.first_point[node + 1])
    , obstacle(face.first_obstacle(node))
    , state(state)
    , law(law)
  {
    SymmetricTensor<2, 3> rows;
    for (unsigned int p = begin; p < end; ++p)
      if (takes_part(p))
        for (unsigned int i = 0; i < face.points[p].n_tangents; ++i)
          rows += symmetrize(
            outer_product(face.points[p].map[i], face.points[p].map[i]));
    const auto directions = eigenvectors(rows);
    for (const auto &[value, vector] : directions)
      if (value > least_hold * directions[0].first)
        {
          held += outer_product(vector, vector);
          ++n_held;
        }

    SymmetricTensor<2, 3> of_friction, of_pressures;
    for (unsigned int o = obstacle; o < end; ++o)
      {
        Tensor<1, 3> unit = face.points[o].map[0];
        if (law != nullptr)
          for (unsigned int p = begin; p < obstacle; ++p)
            if (slips(p))
              unit += law->of_pressure[p][o - obstacle] *
                      node_force(face.points[p],
                                 state.slip[p] / state.slip[p].norm());
        push.push_back(held * unit);
        if (takes_part(o))
          of_pressures += symmetrize(outer_product(push.back(), push.back()));
      }
    for (unsigned int p = begin; p < obstacle; ++p)
      if (takes_part(p))
        for (unsigned int i = 0; i < face.points[p].n_tangents; ++i)
          of_friction += symmetrize(
            outer_product(face.points[p].map[i], face.points[p].map[i]));
    largest     = eigenvectors(of_pressures + of_friction)[0].first;
    any_springs = false;
    for (unsigned int o = obstacle; o < end; ++o)
      any_springs |= is_spring(o);
    pressure_scale = is_free() && any_springs ? preference_of_pressures : 1.;
    gram           = eigenvectors(pressure_scale * of_pressures + of_friction);
  }



  Tensor<1, 3>
  NodeForces::invert_gram(const Tensor<1, 3> &x) const
  {
    Tensor<1, 3> result;
    for (const auto &[value, vector] : gram)
      if (value > least_hold * gram[0].first)
        result += (vector * x) / value * vector;
    return result;
  }



  double
  NodeForces::given_bound(const unsigned int p) const
  {
    if (law == nullptr)
      return state.bound[p];
    double result = law->given[p];
    for (unsigned int o = obstacle; o < end; ++o)
      if (!takes_part(o) && state.sticks[o])
        result += law->of_pressure[p][o - obstacle] *
                  face.points[o].compliance.force(state.penetration(o));
    return result;
  }



  double
  NodeForces::bound(const unsigned int               p,
                    const std::vector<Tensor<1, 2>> &multipliers) const
  {
    double result = given_bound(p);
    if (law != nullptr)
      for (unsigned int o = obstacle; o < end; ++o)
        if (takes_part(o))
          result +=
            law->of_pressure[p][o - obstacle] * multipliers[o - begin][0];
    return result;
  }



  void
  NodeForces::clip(std::vector<Tensor<1, 2>> &multipliers) const
  {
    for (unsigned int o = obstacle; o < end; ++o)
      {
        double &pressure = multipliers[o - begin][0];
        pressure         = takes_part(o) ? pressure : 0.;
        // Project together with the friction of the points, usually one, whose
        // bound depends on this pressure.
        const double all = pressure;
        for (unsigned int p = begin; law != nullptr && p < obstacle; ++p)
          if (const double coefficient = law->of_pressure[p][o - obstacle];
              coefficient > 0. && takes_part(o) && takes_part(p))
            {
              pressure             = 0.;
              const double without = bound(p, multipliers);
              pressure             = all;
              clip_to_cone(without,
                           coefficient,
                           pressure,
                           multipliers[p - begin]);
            }
        pressure = std::max(0., pressure);
      }
    for (unsigned int p = begin; p < obstacle; ++p)
      {
        Tensor<1, 2> &lambda = multipliers[p - begin];
        const double  limit = bound(p, multipliers), size = stable_norm(lambda);
        if (!takes_part(p))
          lambda = Tensor<1, 2>();
        else if (size > limit)
          lambda *= limit / size;
      }
  }



  Tensor<1, 3>
  NodeForces::force(const std::vector<Tensor<1, 2>> &multipliers) const
  {
    Tensor<1, 3> result;
    for (unsigned int p = begin; p < end; ++p)
      if (takes_part(p))
        result += p >= obstacle ?
                    multipliers[p - begin][0] * push[p - obstacle] :
                    node_force(face.points[p], multipliers[p - begin]);
    return result;
  }



  Tensor<1, 3>
  NodeForces::fit(const Tensor<1, 3> &residual, ContactState &result) const
  {
    // Known forces: of compliant obstacles and of slipping points.
    Tensor<1, 3> missing = residual;
    for (unsigned int p = begin; p < end; ++p)
      {
        Tensor<1, 2> lambda;
        if (p >= obstacle)
          lambda[0] = face.points[p].compliance.force(state.penetration(p));
        else if (slips(p))
          if (const double given = given_bound(p); given > 0.)
            lambda = state.slip[p] * (given / state.slip[p].norm());
        missing -= node_force(face.points[p], lambda);
        result.multiplier[p] = lambda;
      }

    // The solution of least norm without regard to the laws.
    const Tensor<1, 3>        goal     = held * missing;
    const Tensor<1, 3>        solution = invert_gram(goal);
    std::vector<Tensor<1, 2>> lambda(end - begin);
    for (unsigned int p = begin; p < end; ++p)
      if (takes_part(p))
        {
          lambda[p - begin] = slip(face.points[p], solution);
          if (p >= obstacle)
            lambda[p - begin][0] =
              pressure_scale * (push[p - obstacle] * solution);
        }
    std::vector<Tensor<1, 2>> z = lambda, old;
    clip(lambda);
    // If the laws do not allow it: accelerated projected gradients with
    // restart. One in a thousand random nodes takes all steps, without a
    // visible loss unless bounds or areas of pieces differ by some 1e4. Every
    // iterate is admissible, and the force that it misses counts as an error.
    if (lambda != z)
      {
        const double L        = largest;
        double       momentum = 1.;
        z                     = lambda;
        for (unsigned int step = 0; step < 3000; ++step)
          {
            old                       = lambda;
            const Tensor<1, 3> remain = (goal - force(z)) / L;
            for (unsigned int p = begin; p < end; ++p)
              if (p >= obstacle)
                lambda[p - begin][0] =
                  z[p - begin][0] + push[p - obstacle] * remain;
              else
                lambda[p - begin] = z[p - begin] + slip(face.points[p], remain);
            clip(lambda);
            double change = 0., size = 0., uphill = 0.;
            for (unsigned int i = 0; i < lambda.size(); ++i)
              {
                uphill += (z[i] - lambda[i]) * (lambda[i] - old[i]);
                change += (z[i] - lambda[i]).norm();
                size += lambda[i].norm();
              }
            if (change <= 1e-15 * size)
              break;
            const double next =
              uphill > 0. ?
                1. :
                0.5 * (1. + std::sqrt(1. + 4. * momentum * momentum));
            const double beta = uphill > 0. ? 0. : (momentum - 1.) / next;
            momentum          = next;
            for (unsigned int i = 0; i < lambda.size(); ++i)
              z[i] = lambda[i] + beta * (lambda[i] - old[i]);
          }
      }

    for (unsigned int p = begin; p < end; ++p)
      {
        if (takes_part(p))
          result.multiplier[p] = lambda[p - begin];
        if (p < obstacle && law != nullptr)
          {
            result.bound[p] = bound(p, lambda);
            if (slips(p) && result.bound[p] > 0.)
              result.multiplier[p] =
                state.slip[p] * (result.bound[p] / state.slip[p].norm());
            else if (!slips(p) && result.bound[p] > 0.)
              result.sticks[p] = true;
          }
      }
    missing = residual;
    for (unsigned int p = begin; p < end; ++p)
      missing -= node_force(face.points[p], result.multiplier[p]);
    return missing;
  }



  std::vector<Tensor<1, 3>>
  NodeForces::pressures_of_force() const
  {
    const unsigned int n = end - obstacle;
    if (n == 1 && face.is_plain(node))
      {
        const Tensor<1, 3> &normal = face.points[obstacle].map[0];
        return {state.sticks[obstacle] ? normal / normal.norm_square() :
                                         Tensor<1, 3>()};
      }
    PressureChanges changes = changes_of_what_holds();
    const auto      springs = springs_of_force(changes);
    for (unsigned int k = 0; k < n; ++k)
      for (unsigned int j = 0; j < n; ++j)
        changes.of_force[j] += changes.of_spring[k][j] * springs[k];
    for (unsigned int k = 0; k < n; ++k)
      changes.of_force[k] += springs[k];
    return changes.of_force;
  }



  NodeForces::PressureChanges
  NodeForces::changes_of_what_holds() const
  {
    std::vector<Column>       columns;
    std::vector<unsigned int> limits;
    for (unsigned int p = begin; p < end; ++p)
      if (takes_part(p) &&
          (!any_springs ||
           (p >= obstacle ? state.multiplier[p][0] : state.bound[p]) > 0.))
        {
          for (unsigned int i = 0; i < face.points[p].n_tangents; ++i)
            columns.push_back({p, i});
          if (p < obstacle && law != nullptr && any_springs &&
              state.multiplier[p].norm() >= state.bound[p] * (1. - at_limit))
            limits.push_back(p);
        }
    const FullMatrix<double> changes =
      pseudo_inverse(equations(columns, limits));

    const unsigned int n     = end - obstacle;
    const double       scale = std::sqrt(pressure_scale);
    PressureChanges    result{
      std::vector<Tensor<1, 3>>(n),
      std::vector<std::vector<double>>(n, std::vector<double>(n, 0.))};
    for (unsigned int c = 0; c < columns.size(); ++c)
      if (const unsigned int p = columns[c].point; p >= obstacle)
        {
          Tensor<1, 3> &of_force = result.of_force[p - obstacle];
          for (unsigned int d = 0; d < 3; ++d)
            of_force[d] = scale * changes(c, d);
          of_force = held * of_force;
          for (unsigned int o = obstacle; o < end; ++o)
            if (is_spring(o))
              {
                double &of_spring =
                  result.of_spring[o - obstacle][p - obstacle];
                of_spring = -of_force * push[o - obstacle];
                for (unsigned int a = 0; a < limits.size(); ++a)
                  of_spring += scale * changes(c, 3 + a) *
                               law->of_pressure[limits[a]][o - obstacle];
              }
        }
    return result;
  }



  FullMatrix<double>
  NodeForces::equations(const std::vector<Column>       &columns,
                        const std::vector<unsigned int> &limits) const
  {
    FullMatrix<double> result(3 + limits.size(), columns.size());
    for (unsigned int c = 0; c < columns.size(); ++c)
      {
        const auto [p, i]  = columns[c];
        const double scale = p >= obstacle ? std::sqrt(pressure_scale) : 1.;
        const Tensor<1, 3> of =
          p >= obstacle ? push[p - obstacle] : face.points[p].map[i];
        for (unsigned int d = 0; d < 3; ++d)
          result(d, c) = scale * of[d];
        for (unsigned int a = 0; a < limits.size(); ++a)
          {
            const unsigned int q = limits[a];
            if (p >= obstacle)
              result(3 + a, c) = -scale * law->of_pressure[q][p - obstacle];
            else if (p == q)
              result(3 + a, c) =
                state.multiplier[q][i] / state.multiplier[q].norm();
          }
      }
    return result;
  }



  std::vector<Tensor<1, 3>>
  NodeForces::springs_of_force(const PressureChanges &changes) const
  {
    std::vector<Tensor<1, 3>> result(end - obstacle);
    std::vector<unsigned int> springs;
    std::vector<Tensor<1, 3>> normals, units;
    Tensor<2, 3>              tilt = identity();
    const Tensor<2, 3>        free = tilt - held;
    for (unsigned int o = obstacle; o < end; ++o)
      {
        Tensor<1, 3>       unit   = face.points[o].map[0];
        const Tensor<1, 3> normal = free * unit;
        const bool         is_free_spring =
          is_spring(o) && normal.norm() > 1e-8 * unit.norm();
        for (unsigned int p = begin; p < obstacle; ++p)
          if (slips(p))
            {
              const Tensor<1, 3> along =
                node_force(face.points[p],
                           state.slip[p] / state.slip[p].norm());
              double bound = law->of_pressure[p][o - obstacle];
              if (takes_part(o))
                tilt -=
                  bound * outer_product(along, changes.of_force[o - obstacle]);
              for (unsigned int j = obstacle; is_free_spring && j < end; ++j)
                bound += law->of_pressure[p][j - obstacle] *
                         changes.of_spring[o - obstacle][j - obstacle];
              unit += bound * along;
            }
        if (is_free_spring)
          {
            springs.push_back(o - obstacle);
            normals.push_back(normal);
            units.push_back(free * unit);
          }
      }
    FullMatrix<double> products(springs.size(), springs.size());
    for (unsigned int i = 0; i < springs.size(); ++i)
      for (unsigned int k = 0; k < springs.size(); ++k)
        products(k, i) = normals[i] * units[k];
    const FullMatrix<double> dual = pseudo_inverse(products);
    for (unsigned int k = 0; k < springs.size(); ++k)
      {
        Tensor<1, 3> b;
        for (unsigned int i = 0; i < springs.size(); ++i)
          b += dual(i, k) * normals[i];
        result[springs[k]] = b * tilt;
      }
    return result;
  }



  std::vector<double>
  NodeForces::pressures(const Tensor<1, 3> &residual) const
  {
    Tensor<1, 3> change = residual;
    for (unsigned int p = begin; p < end; ++p)
      change -= node_force(face.points[p], state.multiplier[p]);
    const auto          of_force = pressures_of_force();
    std::vector<double> result;
    for (unsigned int o = obstacle; o < end; ++o)
      result.push_back(
        std::max(0., state.multiplier[o][0] + of_force[o - obstacle] * change));
    return result;
  }
} // namespace Viscoplastic
