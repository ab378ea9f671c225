// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/partitioner.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace Viscoplastic
{
  /// Gamma_3 on the mesh: makes the points of a ContactLayout from the nodes
  /// with friction or unilateral contact, the bounds rho_c(t) = int rho(x,t)
  /// phi_c, and the gaps g_c = g(x_c), with the basis functions phi_c that
  /// hanging-node constraints leave. Each rank has the points of the nodes that
  /// it owns, in the order of their positions.
  template <int dim>
  class ContactFace
  {
  public:
    /// Collective.
    explicit ContactFace(const AdmissibleSpace<dim> &space);

    const ContactLayout &
    layout() const
    {
      return face_restriction.face();
    }

    const FaceRestriction &
    restriction() const
    {
      return face_restriction;
    }

    /// The boundaries with a law of contact but no contact points, since other
    /// conditions hold their nodes. The same on all ranks.
    std::set<types::boundary_id>
    held_boundaries() const;

    /// The number of points of friction, or of obstacles, on all ranks.
    /// Collective.
    types::global_dof_index
    n_global_points(const bool of_obstacles = false) const
    {
      const auto points = layout().points_of_kind(of_obstacles);
      const types::global_dof_index n =
        std::distance(points.begin(), points.end());
      return Utilities::MPI::sum(n, space.communicator);
    }

    /// The slip rate of each point, relative to its foundation, for the mean
    /// velocity between two times (Cartesian, with ghosts). Empty if no
    /// friction bound depends on slip rates. Collective.
    std::vector<double>
    slip_rates(const DistributedVector &velocity,
               const double             t_old,
               const double             t) const;

    /// Return rho_c of each friction point at @p slip_rates (empty: zero), and
    /// g_c of each obstacle. Bounds that follow the computed pressure are zero.
    /// Throws ExcMessage for negative bounds. Collective.
    std::vector<double>
    bounds(const double t, const std::vector<double> &slip_rates = {}) const;

    /// Return the bounds of a step to time t, for obstacles the remaining gap
    /// at @p u: the displacement at the beginning of the step (in frames) with
    /// the prescribed values of its end. Collective.
    std::vector<double>
    step_bounds(const double               t,
                const DistributedVector   &u,
                const std::vector<double> &slip_rates = {}) const;

    /// Add rho_c = mu_c p_c of Coulomb's law with the pressures p of @p state.
    /// Collective.
    void
    add_computed_bounds(const double               t,
                        const ContactState        &state,
                        std::vector<double>       &bounds,
                        const std::vector<double> &slip_rates = {}) const;

    /// The coefficients mu_ck by which a unit of force at obstacle k of its
    /// node raises the friction bound of point c:
    /// CoulombCoefficients::of_pressure. Collective.
    std::vector<std::vector<double>>
    bounds_of_pressure(const double               t,
                       const std::vector<double> &slip_rates = {}) const;

    /// The error of lagged friction bounds: their difference between the
    /// pressure and slip rate of the step before, which the step has used, and
    /// those of its end.
    struct MissedBounds
    {
      /// The sums of the bounds at the end of the step, and of the differences.
      double sum = 0., missed = 0.;
      /// The sum of the differences times the slips.
      double work = 0.;
    };

    /// The error of lagged bounds at the end of a step, in @p state.
    /// Collective.
    MissedBounds
    missed_bounds(const State<dim> &state) const;

    /// Whether any friction bound follows the computed pressure, on any rank.
    bool
    has_computed_pressure() const
    {
      return any_computed_pressure;
    }

    bool
    has_obstacles() const
    {
      return any_obstacles;
    }

    /// Whether there are compliant obstacles on any rank.
    bool
    has_normal_compliance() const
    {
      return any_compliance;
    }

    /// Set the distance of each obstacle, and the force of compliant ones, in a
    /// state at rest at @p u (in nodal frames) and time t. Collective.
    void
    set_obstacles(const double             t,
                  const DistributedVector &u,
                  ContactState            &state) const;

    /// Whether @p u (in nodal frames) penetrates the foundation at time t
    /// between the nodes, where it is not constrained. Collective.
    bool
    closes_between_nodes(const double t, const DistributedVector &u) const;

    bool
    bounds_depend_on_time() const
    {
      return bounds_vary;
    }

    /// int phi_c over the pieces of each point: the area it stands for.
    const std::vector<double> &
    weights() const
    {
      return point_weights;
    }

    const Point<dim> &
    position(const unsigned int node) const
    {
      return nodes[node].position;
    }

    types::global_dof_index
    first_dof(const unsigned int node) const
    {
      return nodes[node].first_dof;
    }

    /// The Cartesian force of the multiplier lambda of a point; the body feels
    /// its negative.
    Tensor<1, dim>
    cartesian(const unsigned int point, const Tensor<1, 2> &multiplier) const;

    /// The resultant sum_c lambda_c of friction, or of obstacles. Collective.
    Tensor<1, dim>
    resultant(const ContactState &state, const bool of_obstacles = false) const
    {
      Tensor<1, dim> sum;
      for (const unsigned int p : layout().points_of_kind(of_obstacles))
        sum += cartesian(p, state.multiplier[p]);
      return Utilities::MPI::sum(sum, space.communicator);
    }

    /// The share of a boundary in the force of a point, by its area; 1 where no
    /// other boundary has contact points.
    double
    area_share(const types::boundary_id id, const unsigned int point) const
    {
      return area_shares.empty() ? 1. : area_shares.at(id)[point];
    }

    struct BoundaryForces
    {
      Tensor<1, dim> friction, contact;
    };

    /// The resultant forces on each boundary with contact points, if there are
    /// several of these. The force of a point that lies on several boundaries
    /// is divided in proportion to its area on each. Collective.
    std::map<types::boundary_id, BoundaryForces>
    forces_by_boundary(const ContactState &state) const;

    /// The sum of forces_by_boundary() on rigid foundations, not on other
    /// bodies. Collective.
    Tensor<1, dim>
    resultant_on_foundations(const ContactState &state) const
    {
      Tensor<1, dim> sum;
      for (unsigned int p = 0; p < layout().points.size(); ++p)
        if (!space.scene.boundary.at(boundary_ids[p].front()).against)
          sum += cartesian(p, state.multiplier[p]);
      return Utilities::MPI::sum(sum, space.communicator);
    }

    /// The tangential increment of displacement of each point's foundation
    /// between two times (ContactState::foundation_step). Empty if no
    /// foundation moves.
    std::vector<Tensor<1, 2>>
    foundation_step(const double t_old, const double t) const;

    /// The slip at each point for a change of the displacement (in frames,
    /// owned entries), relative to a step of the foundation (empty: at rest).
    std::vector<Tensor<1, 2>>
    slips(const DistributedVector         &change,
          const std::vector<Tensor<1, 2>> &foundation_step = {}) const;

    /// Return multipliers as a nodal density lambda_c/m_c, Cartesian and with
    /// ghosts; zero off Gamma_3, except for the reverse forces on the primary
    /// side of interfaces. Obstacles are included unless @p of_friction_alone.
    /// Collective.
    DistributedVector
    density(const ContactState &state,
            const bool          of_friction_alone = false) const;

    /// Return the multipliers of a density (Cartesian, with ghosts), for a face
    /// on a new mesh; zero at nodes with points that a density cannot
    /// distinguish.
    std::vector<Tensor<1, 2>>
    multipliers(const DistributedVector &ghosted_density) const;

    /// Return one value per point as a nodal field with ghosts: at the first
    /// component of each node, the mean over its points of friction, or over
    /// its obstacles. Collective.
    DistributedVector
    nodal_field(const std::vector<double> &values,
                const bool                 of_obstacles = false) const;

  private:
    struct Node
    {
      types::global_dof_index       first_dof;
      Point<dim>                    position;
      Tensor<2, dim>                directions; // of the nodal frame
      std::array<unsigned int, dim> components; // of its face entries
    };

    /// A quadrature point of an owned face of Gamma_3.
    struct Sample
    {
      Point<dim>                    x;
      const BoundaryCondition<dim> *condition;
    };

    /// The weight `value` of a sample in the integral over phi_c of a point.
    /// Points of other ranks are numbered after those of this one, see
    /// `numbers`.
    struct Share
    {
      unsigned int sample, point;
      bool         of_obstacle;
      double       value;
    };

    /// The initial distance of the other body from a node along the normal.
    double
    initial_distance(const Node &node, const Tensor<1, dim> &normal) const;

    void
    make_nodes();
    void
    make_shares();
    void
    make_compliance();
    void
    make_area_shares();

    /// Sum the shares of each friction point, or of each obstacle, times
    /// factor(sample) and times the factor of the point's slip rate (null:
    /// none; empty: of rate zero). Without `of_obstacles`, entries of obstacles
    /// are zero, and conversely. Collective.
    std::vector<double>
    sum_shares(const std::function<double(const Sample &)> &factor,
               const bool                       of_obstacles = false,
               const std::vector<double> *const slip_rates   = nullptr) const;
    /// The sums for points of friction and obstacles alike. Collective.
    std::vector<double>
    sum_all_shares(const std::function<double(const Sample &)> &factor) const;

    const AdmissibleSpace<dim>                  &space;
    FaceRestriction                              face_restriction;
    std::vector<Node>                            nodes;
    std::vector<std::vector<types::boundary_id>> boundary_ids;
    /// By boundary, the fraction of each point's area that lies on it; empty
    /// with one contact boundary.
    std::map<types::boundary_id, std::vector<double>> area_shares;
    std::vector<Sample>                               samples;
    std::vector<Share>                                shares;
    /// Numbers the points of this rank, and those of others that get shares
    /// here; null where no rank has points.
    std::shared_ptr<const Utilities::MPI::Partitioner> numbers;
    std::vector<double>                                point_weights;
    /// int phi over the primary boundaries, at first components of nodes.
    LinearAlgebra::distributed::Vector<double> other_side_weights;
    bool bounds_vary, any_obstacles = false, any_compliance = false,
                      any_computed_pressure = false, any_rate = false;
    mutable std::optional<std::vector<double>> constant_bounds;
  };
} // namespace Viscoplastic
