// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/contact/normal_compliance.h>

#include <boost/range/adaptor/filtered.hpp>
#include <boost/range/irange.hpp>

#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// The contact points of Gamma_3 without reference to finite elements: which
  /// displacement components of the face each point constrains, and how. A
  /// friction point resists slip; an obstacle is a unilateral condition that
  /// keeps its node out of the foundation, rigidly or, with normal compliance,
  /// by a force that grows with penetration. Each rank has the nodes that it
  /// owns.
  ///
  /// A face vector holds, node by node, the displacement components that some
  /// point at the node sees (1 to 3). Vectors and matrices of a node are padded
  /// to size 3.
  struct ContactLayout
  {
    struct Point
    {
      unsigned int node;
      /// Independent slip directions, 1 or 2; of an obstacle 1.
      unsigned int n_tangents;
      /// slip_i = map[i] . x with the face components x of the node; map[0] . x
      /// of an obstacle is the displacement along the foundation's normal.
      std::array<Tensor<1, 3>, 2> map;
      /// Whether the point is an obstacle (the unilateral condition u_n <= g)
      /// instead of a point of friction.
      bool is_obstacle = false;
      /// The normal compliance of an obstacle. Rigid obstacles and points of
      /// friction have none: its force, slope and energy are zero.
      NormalCompliance compliance;
    };

    /// Position of each node's first component in face vectors, and their size.
    std::vector<unsigned int> first_dof{0};
    /// The points by node, friction before obstacles, and in compressed row
    /// format the first point of each node, followed by the number of points.
    std::vector<Point>        points;
    std::vector<unsigned int> first_point{0};
    /// Whether there are obstacles on any rank.
    bool     has_obstacles = false;
    MPI_Comm communicator  = MPI_COMM_SELF;

    unsigned int
    n_nodes() const
    {
      return first_dof.size() - 1;
    }

    unsigned int
    n_dofs() const
    {
      return first_dof.back();
    }

    unsigned int
    n_node_dofs(const unsigned int node) const
    {
      return first_dof[node + 1] - first_dof[node];
    }

    /// The first obstacle of a node, or the end of its points.
    unsigned int
    first_obstacle(const unsigned int node) const
    {
      unsigned int p = first_point[node];
      while (p < first_point[node + 1] && !points[p].is_obstacle)
        ++p;
      return p;
    }

    /// Indices of points, to loop over: of all at a node, of its points of
    /// friction, and of its obstacles.
    using Range = boost::integer_range<unsigned int>;

    Range
    node_points(const unsigned int node) const
    {
      return {first_point[node], first_point[node + 1]};
    }

    Range
    friction_points(const unsigned int node) const
    {
      return {first_point[node], first_obstacle(node)};
    }

    Range
    obstacles(const unsigned int node) const
    {
      return {first_obstacle(node), first_point[node + 1]};
    }

    /// The points of friction at all nodes, or the obstacles.
    auto
    points_of_kind(const bool of_obstacles) const
    {
      return boost::adaptors::filter(
        Range(0, points.size()), [this, of_obstacles](const unsigned int p) {
          return points[p].is_obstacle == of_obstacles;
        });
    }

    auto
    friction_points() const
    {
      return points_of_kind(false);
    }

    auto
    obstacles() const
    {
      return points_of_kind(true);
    }

    /// Of obstacles, those that are compliant, or those that are rigid.
    template <typename Obstacles>
    auto
    compliant(const Obstacles &some) const
    {
      return boost::adaptors::filter(some, [this](const unsigned int o) {
        return !points[o].compliance.is_rigid();
      });
    }

    template <typename Obstacles>
    auto
    rigid(const Obstacles &some) const
    {
      return boost::adaptors::filter(some, [this](const unsigned int o) {
        return points[o].compliance.is_rigid();
      });
    }

    /// Whether a node has a single point, or one of friction and an obstacle
    /// across it: false where pieces meet.
    bool
    is_plain(const unsigned int node) const
    {
      const std::size_t n = node_points(node).size();
      return n == 1 || (n == 2 && has_plain_friction(node));
    }

    /// Whether a node has exactly one friction point, and its slip is
    /// orthogonal to the normals of all obstacles there: false where pieces
    /// meet.
    bool
    has_plain_friction(const unsigned int node) const;

    /// The entries of a node, padded by zeros.
    Tensor<1, 3>
    node_values(const Vector<double> &x, const unsigned int node) const
    {
      Tensor<1, 3> result;
      for (unsigned int i = 0; i < n_node_dofs(node); ++i)
        result[i] = x[first_dof[node] + i];
      return result;
    }

    void
    set_node_values(const Tensor<1, 3> &values,
                    const unsigned int  node,
                    Vector<double>     &x) const
    {
      for (unsigned int i = 0; i < n_node_dofs(node); ++i)
        x[first_dof[node] + i] = values[i];
    }

    void
    add_node_values(const Tensor<1, 3> &values,
                    const unsigned int  node,
                    Vector<double>     &x) const
    {
      for (unsigned int i = 0; i < n_node_dofs(node); ++i)
        x[first_dof[node] + i] += values[i];
    }

    /// y := y + factor x for face vectors. (Operations of dealii::Vector refuse
    /// empty vectors, which are ordinary here.)
    void
    add(const double factor, const Vector<double> &x, Vector<double> &y) const
    {
      for (unsigned int k = 0; k < n_dofs(); ++k)
        y[k] += factor * x[k];
    }

    /// The sum of @p part over the ranks of the face. Collective, as are any()
    /// and dot().
    double
    sum(const double part) const
    {
      return Utilities::MPI::sum(part, communicator);
    }

    /// Whether a condition is true on any rank.
    bool
    any(const bool here) const
    {
      return Utilities::MPI::max(here ? 1 : 0, communicator) == 1;
    }

    /// The scalar product of two face vectors.
    double
    dot(const Vector<double> &x, const Vector<double> &y) const
    {
      return sum(x.size() > 0 ? x * y : 0.);
    }
  };


  inline Tensor<2, 3>
  identity()
  {
    return unit_symmetric_tensor<3>();
  }

  /// slip = map x of one point; the second entry is zero for one tangent.
  Tensor<1, 2>
  slip(const ContactLayout::Point &point, const Tensor<1, 3> &x);

  /// map^T multiplier: the node force that balances a point's multiplier.
  Tensor<1, 3>
  node_force(const ContactLayout::Point &point, const Tensor<1, 2> &multiplier);

  /// The multiplier whose node force is the nearest to @p force in the
  /// Euclidean norm (least squares).
  Tensor<1, 2>
  nearest_multiplier(const ContactLayout::Point &point,
                     const Tensor<1, 3>         &force);

  /// The displacement of the node of least norm with this slip. (Rows of `map`
  /// need not have length 1 where pieces meet at an oblique angle.)
  Tensor<1, 3>
  motion_with_slip(const ContactLayout::Point &point, const Tensor<1, 2> &slip);

  /// Return the face vector of motion_with_slip() for the given slips (one per
  /// point); of several points at a node the one that moves it farthest counts.
  Vector<double>
  face_motion(const ContactLayout             &face,
              const std::vector<Tensor<1, 2>> &slips);


  /// The state of contact in a step, by point. Friction, with the slip s_c =
  /// B_c (u - u_prev) - w_c against the foundation of the point, satisfies
  ///
  ///     |lambda_c| <= rho_c,   lambda_c = rho_c s_c/|s_c| where s_c != 0,
  ///
  /// and an obstacle s_c <= d_c, lambda_c >= 0, lambda_c (d_c - s_c) = 0, or,
  /// with normal compliance p, lambda_c = p(s_c - d_c).
  struct ContactState
  {
    /// The friction bound rho_c >= 0 (a force), infinite for glued points; at
    /// obstacles the gap: see gap().
    std::vector<double> bound;
    /// The increment w_c of the displacement of the foundation in the step,
    /// along the slip directions of the point; zero for obstacles.
    std::vector<Tensor<1, 2>> foundation_step;
    /// The slip s_c: the tangential increment of the displacement relative to
    /// the foundation; of an obstacle the normal increment.
    std::vector<Tensor<1, 2>> slip;
    /// The multiplier lambda_c: minus the tangential force on the body, or the
    /// force of the body on the obstacle.
    std::vector<Tensor<1, 2>> multiplier;
    /// The active set: whether the point sticks, or touches the obstacle.
    std::vector<bool> sticks;

    /// Construct a state of rest: all points stick, with zero multipliers.
    explicit ContactState(std::vector<double> bounds = {})
      : bound(std::move(bounds))
      , foundation_step(bound.size())
      , slip(bound.size())
      , multiplier(bound.size())
      , sticks(bound.size(), true)
    {}

    unsigned int
    n_points() const
    {
      return bound.size();
    }

    /// The slip of a point whose node moves by @p change in the step.
    Tensor<1, 2>
    slip_with(const ContactLayout::Point &point,
              const unsigned int          p,
              const Tensor<1, 3>         &change) const
    {
      return Viscoplastic::slip(point, change) - foundation_step[p];
    }

    /// The gap d_c of an obstacle at the beginning of the step, a length.
    double
    gap(const unsigned int o) const
    {
      return bound[o];
    }

    /// The penetration s_c - d_c of an obstacle, a length.
    double
    penetration(const unsigned int o) const
    {
      return slip[o][0] - gap(o);
    }

    // What differs between points of friction, rigid and compliant obstacles:

    /// Whether a point slips against friction that is not zero.
    bool
    slips(const ContactLayout::Point &point, const unsigned int p) const
    {
      return !point.is_obstacle && !sticks[p] && bound[p] > 0.;
    }

    /// Whether a point constrains its node along map: friction that sticks, or
    /// a rigid obstacle in contact.
    bool
    blocks(const ContactLayout::Point &point, const unsigned int p) const
    {
      return sticks[p] && point.compliance.is_rigid();
    }

    /// Whether a point sticks with a friction bound, or touches with pressure.
    bool
    holds(const ContactLayout::Point &point, const unsigned int p) const
    {
      return sticks[p] &&
             (point.is_obstacle ? multiplier[p][0] : bound[p]) > 0.;
    }

    /// How far a point that does not constrain its node lets it move along map
    /// until it does: the open gap of a rigid obstacle, otherwise infinity.
    double
    room(const ContactLayout::Point &point, const unsigned int p) const
    {
      return point.is_obstacle && point.compliance.is_rigid() && !sticks[p] ?
               std::max(0., -penetration(p)) :
               std::numeric_limits<double>::infinity();
    }

    /// The values of map x at which a point that constrains its node holds it.
    Tensor<1, 2>
    place(const ContactLayout::Point &point, const unsigned int p) const
    {
      Tensor<1, 2> result = foundation_step[p];
      if (point.is_obstacle)
        result[0] = gap(p);
      return result;
    }

    /// Set the slip that follows from the motion @p x of the node in the step.
    /// Where friction sticks it is zero, and what does not slip sticks; a
    /// compliant obstacle is touched where the node penetrates it.
    void
    set_slip(const ContactLayout::Point &point,
             const unsigned int          p,
             const Tensor<1, 3>         &x);

    /// The multiplier of a point that does not constrain its node, from its
    /// slip: rho_c s_c/|s_c| or p(s_c - d_c); zero without contact.
    Tensor<1, 2>
    multiplier_of_slip(const ContactLayout::Point &point,
                       const unsigned int          p) const;
  };


  /// How the truncated system treats the face: at each node the projector onto
  /// the directions that no sticking point blocks, and the stiffness against
  /// turning the direction of slip (zero for one tangent) plus that of
  /// compliant obstacles.
  struct FaceTruncation
  {
    std::vector<Tensor<2, 3>> projector, spring;
    /// The 3x3 matrix of each node by which its equations are multiplied before
    /// they are projected, where friction bounds depend on the pressure of the
    /// same system (see CoulombLaw::tilt()): the system is not symmetric then.
    /// Empty where no bound does.
    std::vector<Tensor<2, 3>> tilt;
    /// Whether the transposed system is solved: tilt^T is applied to motions
    /// instead of tilt to equations.
    bool transposed = false;

    /// Whether both constrain the same directions. Collective, as are the next
    /// four functions.
    bool
    blocks_as(const FaceTruncation &other, const ContactLayout &face) const
    {
      return !face.any(projector != other.projector);
    }

    bool
    is_same_as(const FaceTruncation &other, const ContactLayout &face) const
    {
      return !face.any(projector != other.projector || spring != other.spring);
    }

    /// Whether @p other gives the same linear system, including tilts.
    bool
    equals(const FaceTruncation &other, const ContactLayout &face) const
    {
      return !face.any(projector != other.projector || spring != other.spring ||
                       tilt != other.tilt || transposed != other.transposed);
    }

    bool
    has_springs(const ContactLayout &face) const
    {
      bool here = false;
      for (const Tensor<2, 3> &block : spring)
        here |= block.norm() > 0.;
      return face.any(here);
    }

    /// Throw ExcMessage if this is the truncation of another face.
    void
    check_belongs_to(const ContactLayout &face) const
    {
      AssertThrow(!face.any(projector.size() != face.n_nodes() ||
                            spring.size() != face.n_nodes()),
                  ExcMessage(
                    "The state of the preconditioner belongs to another "
                    "contact face."));
    }

    /// x := projector x, node by node.
    void
    project(const ContactLayout &face, Vector<double> &x) const
    {
      // Project twice: rounding of large blocked forces would leave a part
      // outside the truncated space, which no iteration in this space removes.
      for (unsigned int n = 0; n < face.n_nodes(); ++n)
        face.set_node_values(
          projector[n] * (projector[n] * face.node_values(x, n)), n, x);
    }

    /// x := tilt x for equations (residuals) x, or x := tilt^T x for motions x
    /// if the system is transposed.
    void
    tilt_equations(const ContactLayout &face, Vector<double> &x) const
    {
      if (!transposed)
        for (unsigned int n = 0; n < tilt.size(); ++n)
          face.set_node_values(tilt[n] * face.node_values(x, n), n, x);
    }

    void
    tilt_motions(const ContactLayout &face, Vector<double> &x) const
    {
      if (transposed)
        for (unsigned int n = 0; n < tilt.size(); ++n)
          face.set_node_values(face.node_values(x, n) * tilt[n], n, x);
    }
  };
} // namespace Viscoplastic
