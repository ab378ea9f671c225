// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/coulomb_bounds.h>

#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// Bounds rest once this many corrections have not halved the error.
    constexpr unsigned int patience = 8;
    /// Bounds at rest are moved when the error for them is below part_of_missed
    /// times their misfit. They follow again when it has fallen by
    /// near_enough^n, where Newton's method has stalled n times.
    constexpr double part_of_missed = 0.1, near_enough = 0.3;
  } // namespace



  std::optional<double>
  aitken_factor(const ContactLayout       &face,
                const double               factor,
                const std::vector<double> &last_missing,
                const std::vector<double> &missing)
  {
    double product = 0., square = 0.;
    for (unsigned int p = 0; p < missing.size(); ++p)
      {
        const double difference = missing[p] - last_missing[p];
        product += last_missing[p] * difference;
        square += difference * difference;
      }
    product = face.sum(product);
    square  = face.sum(square);
    if (!(square > 0.))
      return {};
    return -factor * product / square;
  }



  CoulombBounds::CoulombBounds(
    const CoulombLaw                &law,
    const ContactLayout             &face,
    const std::vector<Tensor<2, 3>> &inverse_diagonal)
    : law(law)
    , face(face)
    , inverse_diagonal(inverse_diagonal)
    , largest_coefficient(law.largest_coefficient(face))
  {}



  void
  CoulombBounds::measure(const ContactState &state)
  {
    double sum = 0.;
    missing.assign(face.points.size(), 0.);
    for (const unsigned int p : face.friction_points())
      {
        missing[p] = law.bound(face, state, p) - state.bound[p];
        sum += missing[p] * missing[p] *
               inverse_diagonal[face.points[p].node].norm();
      }
    missed = std::sqrt(face.sum(sum));
  }



  void
  CoulombBounds::predict(ContactSolve         &bulk,
                         const FaceTruncation &truncation,
                         const Vector<double> &residual,
                         const Vector<double> &w,
                         ContactState         &state)
  {
    const auto [slope, curvature, response] = bulk.search_terms(w);
    double         stiffness                = curvature;
    Vector<double> after(residual);
    face.add(-1., response, after);
    // Where pieces meet, friction that turns with the slip contributes to the
    // pressure on the other piece.
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      if (!face.has_plain_friction(node))
        face.add_node_values(
          -(turning_spring(face, node, state, inverse_diagonal) *
            face.node_values(w, node)),
          node,
          after);
    law.predict_bounds(face, after, state);

    double springs = 0.;
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        const Tensor<1, 3> here = face.node_values(w, node);
        springs += here * (truncation.spring[node] * here);
      }
    stiffness += face.sum(springs);
    Vector<double> tilted(response);
    truncation.tilt_equations(face, tilted);
    const double lost = face.dot(w, response) - face.dot(w, tilted);
    if (!(stiffness > 0.) || lost <= loss * stiffness)
      return;
    loss = lost / stiffness;
    if (loss < 1.)
      return;
    std::vector<double> of_nodes;
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      of_nodes.push_back(
        face.node_values(w, node) *
        (face.node_values(response, node) - face.node_values(tilted, node)));
    std::ostringstream text;
    text << "slip loses " << loss
         << " of its stiffness to the pressure that it changes, most at "
         << place_of_largest(of_nodes)
         << " (friction coefficient: " << largest_coefficient << " at most)";
    doubts = text.str();
  }



  bool
  CoulombBounds::damp(const double       error,
                      const unsigned int n_corrections,
                      ContactState      &state)
  {
    if (!rest)
      {
        if (error < 0.5 * least_error)
          {
            least_error   = error;
            last_progress = n_corrections;
          }
        if (n_corrections < last_progress + patience)
          return false;
        rest = true;
        ++n_stalls;
        first_missed = 0.;
        share        = 0.5;
        has_moved    = false;
        return true;
      }
    // Wait until the step is solved for the present bounds.
    if (error - missed > part_of_missed * missed)
      return false;
    if (first_missed == 0.)
      first_missed = missed;
    if (missed < std::pow(near_enough, n_stalls) * first_missed)
      {
        rest          = false;
        least_error   = error;
        last_progress = n_corrections;
        return true;
      }
    if (has_moved)
      {
        // A factor that is not positive would lead back from a fixed point that
        // repels: take the full step.
        if (const auto aitken =
              aitken_factor(face, share, last_missing, missing))
          share = *aitken > 0. ? std::clamp(*aitken, 0.05, 1.) : 1.;
      }
    for (unsigned int p = 0; p < missing.size(); ++p)
      state.bound[p] += share * missing[p];
    last_missing = missing;
    has_moved    = true;
    ++moves;
    return true;
  }



  std::string
  CoulombBounds::place_of_largest(const std::vector<double> &of_nodes) const
  {
    const auto largest = std::max_element(of_nodes.begin(), of_nodes.end());
    const auto of_ranks =
      Utilities::MPI::all_gather(face.communicator,
                                 of_nodes.empty() ?
                                   std::numeric_limits<double>::lowest() :
                                   *largest);
    std::string place;
    if (law.place && !of_nodes.empty())
      place = law.place(largest - of_nodes.begin());
    return Utilities::MPI::broadcast(face.communicator,
                                     place,
                                     std::max_element(of_ranks.begin(),
                                                      of_ranks.end()) -
                                       of_ranks.begin());
  }



  std::string
  CoulombBounds::failure() const
  {
    std::vector<double> of_nodes(face.n_nodes(), 0.);
    for (unsigned int p = 0; p < missing.size(); ++p)
      {
        double &here = of_nodes[face.points[p].node];
        here         = std::max(here, std::abs(missing[p]));
      }
    std::ostringstream message;
    message << "Coulomb's law with the pressure of the step itself may have no "
               "solution near the last step, or several, where the friction "
               "coefficient is large (here up to "
            << largest_coefficient << "); friction and pressure fit worst at "
            << place_of_largest(of_nodes)
            << ". None was found on the way from smaller coefficients, either. "
               "Smaller steps may follow a solution.";
    return message.str();
  }
} // namespace Viscoplastic
