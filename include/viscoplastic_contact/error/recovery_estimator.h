// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/error/local_cells.h>

#include <functional>
#include <optional>
#include <utility>

namespace Viscoplastic
{
  /// The estimate of Zienkiewicz and Zhu: how far the strain eps_h of u_h is
  /// from a continuous one, eps*, whose values at the nodes are means of the
  /// cells around them, weighted by 1/width (materials apart),
  ///
  ///     eta_K^2 = int_K (eps* - eps_h) : E (eps* - eps_h).
  ///
  /// In a body that creeps the strain holds, other than the stress, what all
  /// steps have left out: it grows with the error of the rates. No bound, and
  /// blind to what goes on in the law of friction; but without a constant, and
  /// exact in the limit where solutions are smooth and meshes regular. Cells of
  /// absent materials count for nothing.
  ///
  /// At singular points means around nodes miss most of it: of strains like
  /// r^(beta), beta > -dim/2, the scales below the cell hold a part that has no
  /// bound as beta tends to -dim/2, as it does at the corners of bodies that
  /// creep by a power law. A self-similar strain tells it. What it varies by
  /// between the cells of a patch twice as large as the cell K at its singular
  /// corner, D, and the errors S of the others there, return within K at each
  /// scale times the share q that K has of the energy of means in the patch:
  ///
  ///     eta_K^2 = (q + q^2 + ...) (D + S),   q = 2^(-2 beta - dim).
  template <int dim>
  class RecoveryEstimator
  {
  public:
    /// What multiply() takes of a dual solution and the tangents C, at the
    /// points of owned cells, one cell after another.
    struct OfDual
    {
      /// C e_w.
      std::vector<SymmetricTensor<2, 3>> stress;
      /// delta_w/3 and C I delta_w/3; empty without mean dilatation.
      std::vector<double>                dilatation;
      std::vector<SymmetricTensor<2, 3>> of_dilatation;
      /// E^-1 C eps(w_h); empty if the law is linear.
      std::vector<SymmetricTensor<2, 3>> strain;
      /// By part: the ends at which eps* of w_h is curved, and those from which
      /// neither strain is extrapolated.
      std::vector<std::vector<bool>> curved, left;
    };

    /// The state of a creeping body, linearized as one step of backward Euler.
    struct Linearization
    {
      /// The size of the step as a part of the time that the body has crept,
      /// and so that of its deviatoric strains. At most 1.
      double share;
      /// E r, which a stress error C e at a sample of a cell is beyond E e and
      /// what flows; empty if the law is linear.
      std::function<SymmetricTensor<2, 3>(const std::size_t            cell,
                                          const unsigned int           sample,
                                          const SymmetricTensor<2, 3> &strain,
                                          const SymmetricTensor<2, 3> &e)>
        remainder;
    };

    /// The argument stays in use. Collective.
    explicit RecoveryEstimator(const LocalCells<dim> &cells);

    /// eta_K^2 by active cell, zero in cells of other ranks; @p u with ghosts,
    /// Cartesian. If asked for, also the sum of what deviators alone make of it
    /// (without singular points). Collective.
    Vector<double>
    estimate(const DistributedVector &u, double *deviatoric = nullptr) const;

    /// a(e_u, e_w) by active cell in the form of the tangents C, of the strain
    /// errors of a displacement and a dual solution @p w with their signs;
    /// @p tangents are by sample, or null for those of elasticity, other
    /// arguments and the result as of estimate(). What is taken of w is kept in
    /// @p dual, empty at first.
    ///
    ///     int e_u : C e_w - int r(-e_u) : C eps(w_h)
    ///
    /// since u_h solves the equations of the law and not those of its tangents:
    /// its error is a-orthogonal to w_h but for the remainder r of the law,
    /// which is of the order of the first term. It is that of the way back,
    /// with tangents at the solution u, not at u_h: they are smooth, and so is
    /// the w that eps* of w_h is close to. What tangents of another state miss
    /// is in it, too.
    ///
    /// Signs leave little of the sum, so that two things count here that do not
    /// in squares. Means at a boundary miss half of what a strain varies by in
    /// a cell: eps* is extrapolated there, so that linear strains on boxes are
    /// met everywhere; but not from cells where both are is_curved(), as at the
    /// corners of clamped boundaries, whose product it would take away. A plane
    /// of symmetry is no boundary: strains go on beyond it, mirrored, and have
    /// no shear along it (if materials are isotropic). And under mean
    /// dilatation pressures do work on what div u_h and div w_h vary by in
    /// cells, delta:
    ///
    ///     - int (C e_u + z) : I delta_w/3 - int e_w : C I delta_u/3,
    ///
    /// from the mixed form of displacement and pressure, which that method is:
    /// the body feels what the pressure of z, as of heat, varies by in a cell
    /// (if it does: @p z may be cell means, or empty), the equations do not.
    /// What is recovered of the volume then is the pressure, K tr eps less that
    /// of z: where stress has relaxed it is small beside both. Collective.
    Vector<double>
    multiply(const DistributedVector                  &u,
             const IrreversibleStress                 &z,
             const DistributedVector                  &w,
             const std::vector<SymmetricTensor<4, 3>> *tangents,
             const Linearization                      &law,
             OfDual                                   &dual) const;

  private:
    static constexpr unsigned int n_vertices = LocalCells<dim>::n_vertices,
                                  n_points   = LocalCells<dim>::n_points;
    /// By cell, owned or not.
    using Strains     = std::vector<SymmetricTensor<2, 3>>;
    using NodalVector = LinearAlgebra::distributed::Vector<double>;
    using Cell        = typename LocalCells<dim>::LocalCell;

    /// A node on the face or edge of a coarser cell.
    struct HangingNode
    {
      unsigned int                                 node;
      std::vector<std::pair<unsigned int, double>> parents;
    };

    /// A material: its owned cells, and what recovery needs at their nodes.
    struct Part
    {
      std::vector<unsigned int> cells;
      double                    largest_share; // q of singular points
      /// By node, of the cells around, each with the inverse of its width: so
      /// linear strains are met also where cells of two sizes meet.
      std::vector<double> inverse_weight;
      /// Of those around a node at the boundary with a vertex inside opposite
      /// to it.
      std::vector<double> inverse_inner_weight;
      /// Those that have the material at all of their parents take what is
      /// between them.
      std::vector<HangingNode> hanging_nodes;
    };

    /// Cells around a node, twice as large as one of them: the energy of their
    /// mean strain, by volume and in all, what their means vary by around it,
    /// and the sum of their eta_K^2.
    struct Patch
    {
      double density, energy, variation, error;
    };

    /// That around the vertex of cell @p c opposite to @p vertex, from what is
    /// recovered and summed; none where cells are not those of a regular mesh.
    std::optional<Patch>
    patch(const unsigned int c, const unsigned int vertex) const;

    /// Whether strains go on from a cell at its vertex to the one across the
    /// patch as they do at singular points: K + O - 2 P of the means in the
    /// cell, across the patch and in it is zero for linear strains, and for
    /// those that vary in one direction, as in bending or around holes. From
    /// what is recovered at the node between them; no where cells are not
    /// those of a regular mesh.
    bool
    is_curved(const unsigned int cell,
              const unsigned int vertex,
              const Strains     &means) const;

    /// Raise eta_K^2 by index of cell at singular points.
    void
    raise_at_singular_points(const Part          &part,
                             const Strains       &means,
                             std::vector<double> &squares) const;

    /// Twice the energy of a strain, by volume.
    double
    energy_density(const unsigned int           cell,
                   const SymmetricTensor<2, 3> &strain) const;

    /// What is recovered at a node.
    SymmetricTensor<2, 3>
    recovered(const unsigned int node) const;

    /// Find the cells across vertices.
    void
    find_across();

    /// The vertex of a cell that is farthest from this one.
    static unsigned int
    opposite(const unsigned int vertex)
    {
      return n_vertices - 1 - vertex;
    }

    /// Set the strains at the nodes of a part to means of its cells.
    /// Collective.
    void
    recover(const Part &part, const Strains &means) const;

    /// Whether strains that have been recovered are curved, for all ends of a
    /// part in turn.
    std::vector<bool>
    curved_ends(const Part &part, const Strains &means) const;

    /// Mirror recovered strains at planes of symmetry, and add to those at the
    /// boundary what the cell means of eps* miss, but for ends that are left.
    /// Collective.
    void
    extrapolate(const Part              &part,
                const Strains           &means,
                const std::vector<bool> &is_left) const;

    /// Set what is taken of @p w in the cells of a part, whose strains have
    /// been recovered.
    void
    renew(const Part                               &part,
          const DistributedVector                  &w,
          const std::vector<SymmetricTensor<4, 3>> *tangents,
          OfDual                                   &dual) const;

    /// Scale strains at owned nodes by numbers for each node.
    void
    scale(NodalVector &strains, const std::vector<double> &factors) const;

    /// Set the shear along planes of symmetry to zero.
    void
    mirror() const;

    /// Set the strains at hanging nodes to what is between their parents.
    void
    interpolate_hanging_nodes(const Part &part) const;

    Strains
    mean_strains(const DistributedVector &u) const;

    /// eps* - eps_h at the points of an owned cell, from what is recovered and
    /// eps_h.
    std::array<SymmetricTensor<2, 3>, n_points>
    defects(const unsigned int                                 cell,
            const std::array<SymmetricTensor<2, 3>, n_points> &strains) const;

    /// The strains that act in an owned cell, and how much div u_h is larger
    /// than its mean at its points: zero without mean dilatation.
    std::array<SymmetricTensor<2, 3>, n_points>
    strains(const unsigned int       cell,
            const DistributedVector &u,
            double                  *dilatations = nullptr) const;

    const LocalCells<dim> &local;
    /// The components that strains have, as SymmetricTensor counts them: in the
    /// plane, in the plane and around an axis, or all.
    const std::vector<unsigned int> components;
    /// Local places of the first component at the vertices of owned cells.
    std::vector<std::array<unsigned int, n_vertices>> nodes;
    /// The vertices of owned cells on faces where the part ends, but for planes
    /// of symmetry, as far as the opposite one is not on such a face.
    std::vector<std::vector<unsigned char>> ends;
    /// The cells that share a vertex of owned cells and nothing else with them,
    /// where the mesh around the vertex is regular; invalid elsewhere.
    std::vector<std::array<unsigned int, n_vertices>> across;
    /// Nodes on planes of symmetry, with the normal.
    std::vector<std::pair<unsigned int, Tensor<1, 3>>> mirrored;
    /// Shape functions at the points of a cell.
    std::array<std::array<double, n_vertices>, n_points> shape_values;
    std::vector<Part>                                    parts;
    /// Of cells, owned or not: the root of their area, or of volume.
    std::vector<double> widths;

    /// eps* at the nodes; kept, since a new vector for each step costs as much
    /// as to fill it.
    mutable NodalVector values;
    /// Sums and maxima over the cells around nodes, for singular points.
    mutable NodalVector sums, maxima;
  };
} // namespace Viscoplastic
