// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/symmetric_tensor.h>

#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/contact/node_forces.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// Directions that are held by less than this part of others are not.
    constexpr double least_hold = 1e-12;
    /// Springs press by how deep the node is, whatever others hold: of forces
    /// that leave a choice theirs has next to no weight.
    constexpr double weight_of_springs = 1e-8;



    /// The nearest point of the cone |lambda| <= given + coefficient p, p >= 0.
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
                         const CoulombCoefficients *law,
                         const bool                 with_springs)
    : face(face)
    , node(node)
    , begin(face.first_point[node])
    , end(face.first_point[node + 1])
    , obstacle(face.first_obstacle(node))
    , state(state)
    , law(law)
    , with_springs(with_springs)
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

    SymmetricTensor<2, 3> sum;
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
          sum +=
            symmetrize(outer_product(push.back(), push.back())) / weight_of(o);
      }
    for (unsigned int p = begin; p < obstacle; ++p)
      if (takes_part(p))
        for (unsigned int i = 0; i < face.points[p].n_tangents; ++i)
          sum += symmetrize(
            outer_product(face.points[p].map[i], face.points[p].map[i]));
    gram = eigenvectors(sum);
  }



  double
  NodeForces::weight_of(const unsigned int o) const
  {
    return face.points[o].gives_way() ? weight_of_springs : 1.;
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
        // The friction that this pressure carries, as a rule of one point.
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
    // What does not hold the node.
    Tensor<1, 3> missing = residual;
    for (unsigned int p = begin; p < end; ++p)
      {
        Tensor<1, 2> lambda;
        if (face.points[p].gives_way())
          lambda[0] = face.points[p].compliance.force(state.penetration(p));
        else if (slips(p))
          if (const double given = given_bound(p); given > 0.)
            lambda = state.slip[p] * (given / state.slip[p].norm());
        missing -= node_force(face.points[p], lambda);
        result.multiplier[p] = lambda;
      }

    // Least norm.
    const Tensor<1, 3>        goal     = held * missing;
    const Tensor<1, 3>        solution = invert_gram(goal);
    std::vector<Tensor<1, 2>> lambda(end - begin);
    for (unsigned int p = begin; p < end; ++p)
      if (takes_part(p))
        {
          lambda[p - begin] = slip(face.points[p], solution);
          if (p >= obstacle)
            lambda[p - begin][0] = push[p - obstacle] * solution;
        }
    std::vector<Tensor<1, 2>> z = lambda, old;
    clip(lambda);
    // Where laws do not allow that: accelerated projected gradients. One in a
    // thousand random nodes takes all of them, with nothing left to gain but
    // where bounds or areas of pieces differ by some 1e4. Whatever they end
    // with is admissible, and the force that it misses counts as an error.
    if (lambda != z)
      {
        const double L        = gram[0].first;
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



  Tensor<1, 3>
  NodeForces::pressure_of_force(const unsigned int o) const
  {
    return takes_part(o) ?
             held * invert_gram(push[o - obstacle]) / weight_of(o) :
             Tensor<1, 3>();
  }



  std::vector<double>
  NodeForces::pressures(const Tensor<1, 3> &residual) const
  {
    Tensor<1, 3> remaining = residual;
    for (unsigned int p = begin; p < obstacle; ++p)
      if (slips(p) && law->given[p] > 0.)
        remaining -=
          node_force(face.points[p],
                     state.slip[p] * (law->given[p] / state.slip[p].norm()));
    std::vector<double> result;
    for (unsigned int o = obstacle; o < end; ++o)
      result.push_back(std::max(0., pressure_of_force(o) * remaining));
    return result;
  }
} // namespace Viscoplastic
