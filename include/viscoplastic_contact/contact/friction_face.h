// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/lac/vector.h>

#include <array>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /**
   * The friction points of Gamma_3 without finite elements: which unknowns of
   * the face they see, and how. Each rank has the nodes that it owns, so that
   * the part of a rank is small where there are many of them.
   *
   * A face vector holds, node by node, the displacement components that some
   * friction point at the node sees (1 to 3). Blocks of a node are padded to
   * size 3.
   */
  struct FrictionFace
  {
    struct Point
    {
      unsigned int node;
      /// Independent slip directions, 1 or 2.
      unsigned int n_tangents;
      /// slip_i = map[i] . x over the face components of the node.
      std::array<Tensor<1, 3>, 2> map;
    };

    /// Position of each node's first component in face vectors, and the end.
    std::vector<unsigned int> first_dof{0};
    /// The points node by node, and each node's first one, and the end.
    std::vector<Point>        points;
    std::vector<unsigned int> first_point{0};
    /// The ranks that share the face.
    MPI_Comm communicator = MPI_COMM_SELF;

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

    unsigned int
    n_node_points(const unsigned int node) const
    {
      return first_point[node + 1] - first_point[node];
    }

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

    /// y := y + factor x for face vectors. (Vector's own operations refuse
    /// empty ones, which are ordinary here.)
    void
    add(const double factor, const Vector<double> &x, Vector<double> &y) const;

    /// A sum over all ranks of what each adds to it. Collective, as the
    /// next ones.
    double
    sum(const double part) const;

    /// Whether something holds on some rank.
    bool
    any(const bool here) const;

    /// The scalar product of two face vectors.
    double
    dot(const Vector<double> &x, const Vector<double> &y) const;
  };


  /// slip = map x of one point; the second entry is zero for one tangent.
  Tensor<1, 2>
  slip(const FrictionFace::Point &point, const Tensor<1, 3> &x);

  /// map^T multiplier: the node force that balances a point's multiplier.
  Tensor<1, 3>
  node_force(const FrictionFace::Point &point, const Tensor<1, 2> &multiplier);


  /**
   * What friction does in a step, point by point. It satisfies
   *
   *     |lambda_c| <= rho_c,   lambda_c = rho_c s_c/|s_c| where s_c != 0.
   */
  struct FrictionState
  {
    /// The bound rho_c >= 0; infinite for glued points.
    std::vector<double> bound;
    /// The slip s_c: the tangential increment of the displacement relative to
    /// the foundation.
    std::vector<Tensor<1, 2>> slip;
    /// The multiplier lambda_c: minus the tangential force on the body.
    std::vector<Tensor<1, 2>> multiplier;
    /// The active set: whether the point sticks.
    std::vector<bool> sticks;

    /// All points stick and nothing pulls at them.
    explicit FrictionState(std::vector<double> bounds = {})
      : bound(std::move(bounds))
      , slip(bound.size())
      , multiplier(bound.size())
      , sticks(bound.size(), true)
    {}

    unsigned int
    n_points() const
    {
      return bound.size();
    }
  };


  /**
   * How the truncated system treats the face: at each node the projector onto
   * the directions that no sticking point blocks, and the stiffness against
   * turning the slip direction of slipping points (zero for one tangent).
   */
  struct FaceTruncation
  {
    std::vector<Tensor<2, 3>> projector, spring;

    /// Whether another one blocks the same. Collective, as the next.
    bool
    blocks_as(const FaceTruncation &other, const FrictionFace &face) const;

    bool
    is_same_as(const FaceTruncation &other, const FrictionFace &face) const;

    bool
    has_springs(const FrictionFace &face) const;

    /// Throw ExcMessage if it is that of another face.
    void
    check_belongs_to(const FrictionFace &face) const;

    /// x := projector x, node by node.
    void
    project(const FrictionFace &face, Vector<double> &x) const;
  };
} // namespace Viscoplastic
