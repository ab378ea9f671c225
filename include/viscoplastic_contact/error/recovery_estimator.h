// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/error/local_cells.h>

#include <bitset>
#include <functional>
#include <optional>
#include <utility>

namespace Viscoplastic
{
  /// The estimate of Zienkiewicz and Zhu: the distance of the strain eps_h of
  /// u_h from a continuous one, eps*, whose nodal values are means over the
  /// cells of a material around the node, weighted by 1/width,
  ///
  ///     eta_K^2 = int_K (eps* - eps_h) : E (eps* - eps_h).
  ///
  /// In a body that creeps, the strain, unlike the stress, contains the sum of
  /// the defects of all steps: it grows with the error of the rates. The
  /// estimate is no bound and does not see errors of friction; but it needs no
  /// constant and is exact in the limit of smooth solutions on regular meshes.
  /// Cells of absent materials do not count.
  ///
  /// At singular points, nodal means miss most of the error: of strains like
  /// r^beta, beta > -dim/2, the scales below the cell contain a part that is
  /// unbounded as beta tends to -dim/2, as at corners in power-law creep. It
  /// follows from self-similarity. In the patch of cells twice as large as the
  /// cell K at its singular corner, let D be the variation between cell means
  /// and S the sum of the other cells' errors. Both return within K at each
  /// smaller scale times the share q of K in the energy of the patch's means:
  ///
  ///     eta_K^2 = (q + q^2 + ...) (D + S),   q = 2^(-2 beta - dim).
  template <int dim>
  class RecoveryEstimator
  {
  public:
    /// The data of a dual solution and the tangents C that multiply() uses, at
    /// the points of owned cells, one cell after another.
    struct OfDual
    {
      /// C e_w.
      std::vector<SymmetricTensor<2, 3>> stress;
      /// delta_w/3 and C I delta_w/3; empty without mean dilatation.
      std::vector<double>                dilatation;
      std::vector<SymmetricTensor<2, 3>> of_dilatation;
      /// eps(w_h); empty if the law is linear.
      std::vector<SymmetricTensor<2, 3>> strain;
      /// By part: the boundary vertices (`ends') at which eps* of w_h is
      /// curved, and those at which neither strain is extrapolated.
      std::vector<std::vector<bool>> curved, left;
      /// The sum of the last products of remainders in doubt.
      double in_doubt = 0.;
    };

    /// A creeping body, linearized as one step of backward Euler.
    struct Linearization
    {
      /// The ratio of the step to the creep time, and so of its deviatoric
      /// strain to that of the body. At most 1.
      double share;
      /// The remainder r of a strain error e at a sample, C e minus the change
      /// of stress by the law, and whether it is in doubt since the step
      /// contains only a part of what has crept.
      struct Remainder
      {
        SymmetricTensor<2, 3> stress;
        bool                  is_in_doubt = false;
      };
      /// Return the remainder at a sample of a cell; empty if the law is
      /// linear.
      std::function<Remainder(const std::size_t            cell,
                              const unsigned int           sample,
                              const SymmetricTensor<2, 3> &strain,
                              const SymmetricTensor<2, 3> &e)>
        remainder;
    };

    /// Keeps a reference to @p cells. Collective.
    explicit RecoveryEstimator(const LocalCells<dim> &cells);

    /// Return eta_K^2 by active cell, zero in cells of other ranks; @p u with
    /// ghosts, Cartesian, and @p strains of the owned cells. Set @p deviatoric,
    /// if given, to the sum for strain deviators alone, without singular
    /// points. Collective.
    Vector<double>
    estimate(const DistributedVector                              &u,
             const std::vector<typename LocalCells<dim>::Strains> &strains,
             double *deviatoric = nullptr) const;

    /// Return the signed products a(e_u, e_w) by active cell, in the form of
    /// the tangents C, of the strain errors of a displacement and a dual
    /// solution @p w. @p tangents: by sample, or null for elasticity; other
    /// arguments and the result as of estimate(). Data of w are kept in @p
    /// dual, initially empty.
    ///
    ///     int e_u : C e_w - int r(-e_u) : eps(w_h)
    ///
    /// Since u_h solves the nonlinear equations instead of their linearization,
    /// its error is a-orthogonal to w_h only up to the remainder r of the law,
    /// which is of the order of the first term. r is taken from u to u_h, with
    /// tangents at u rather than u_h: they are smooth, and so is the w that
    /// eps* of w_h approximates. r also contains the difference to tangents at
    /// another state.
    ///
    /// Since signed terms nearly cancel, two details matter here that do not
    /// for squares. At a boundary, nodal means miss half of the variation in a
    /// cell: eps* is extrapolated there, so that linear strains on boxes are
    /// exact everywhere; but not if both strains are is_curved(), as at corners
    /// of clamped boundaries, where this would remove the product. A plane of
    /// symmetry is no boundary: strains are mirrored there and have no shear
    /// along it (if materials are isotropic). And under mean dilatation
    /// pressures do work on the variation delta of div u_h and div w_h in
    /// cells:
    ///
    ///     - int (C e_u + z) : I delta_w/3 - int e_w : C I delta_u/3,
    ///
    /// from the equivalent mixed form of displacement and pressure: the exact
    /// solution depends on the variation in a cell of the pressure of z, as by
    /// heat, the discrete one does not (@p z may be cell means, or empty). The
    /// recovered volumetric quantity is then the pressure, K tr eps minus that
    /// of z: where stress has relaxed it is small beside both. Collective.
    Vector<double>
    multiply(const DistributedVector                  &u,
             const IrreversibleStress                 &z,
             const DistributedVector                  &w,
             const std::vector<SymmetricTensor<4, 3>> *tangents,
             const Linearization                      &law,
             OfDual                                   &dual) const;

  private:
    static constexpr unsigned int n_vertices   = LocalCells<dim>::n_vertices,
                                  n_points     = LocalCells<dim>::n_points,
                                  n_components = dim == 2 ? 4 : 6;
    // Strains have the first n_components components of SymmetricTensor<2, 3>.

    /// By cell, including ghosts.
    using Strains     = std::vector<SymmetricTensor<2, 3>>;
    using NodalVector = LinearAlgebra::distributed::Vector<double>;
    using Cell        = typename LocalCells<dim>::LocalCell;

    /// A node on the face or edge of a coarser cell.
    struct HangingNode
    {
      unsigned int                                 node;
      std::vector<std::pair<unsigned int, double>> parents;
    };

    /// The owned cells of a material, and data for recovery at their nodes.
    struct Part
    {
      std::vector<unsigned int> cells;
      double                    largest_share; // q of singular points
      /// By node, the inverse of the sum of 1/width of the cells around it;
      /// these weights are exact for linear strains between cells of two sizes.
      std::vector<double> inverse_weight;
      /// The same for cells at a boundary node whose opposite vertex is inside.
      std::vector<double> inverse_inner_weight;
      /// Hanging nodes with the material at all of their parents, from which
      /// their values are interpolated.
      std::vector<HangingNode> hanging_nodes;
    };

    /// The cells around a node, twice as large as one of them: the energy of
    /// their mean strain, the variation of their means around it, and the sum
    /// of their eta_K^2.
    struct Patch
    {
      double energy, variation, error;
    };

    /// Return the patch around the vertex of cell @p c opposite to @p vertex,
    /// from recovered values and sums; none where the mesh is not regular.
    std::optional<Patch>
    patch(const unsigned int c, const unsigned int vertex) const;

    /// Whether strains at a vertex of a cell vary as at singular points: K + O
    /// - 2 P, of the means in the cell, the opposite cell of the patch and the
    /// patch, is zero for linear strains and those that vary in one direction,
    /// as in bending or around holes. Uses values recovered at the node between
    /// the cells; false where the mesh is not regular.
    bool
    is_curved(const unsigned int cell,
              const unsigned int vertex,
              const Strains     &means) const;

    /// Raise eta_K^2, by cell index, at singular points. Collective.
    void
    raise_at_singular_points(const Part          &part,
                             const Strains       &means,
                             std::vector<double> &squares) const;

    /// Return eps : E eps, twice the energy density of a strain.
    double
    energy_density(const unsigned int           cell,
                   const SymmetricTensor<2, 3> &strain) const;

    /// Return the recovered strain at a node.
    SymmetricTensor<2, 3>
    recovered(const unsigned int node) const;

    /// Set the member `across'.
    void
    find_across();

    /// Return the vertex of a cell farthest from this one.
    static unsigned int
    opposite(const unsigned int vertex)
    {
      return n_vertices - 1 - vertex;
    }

    /// Set the nodal strains of a part to means over its cells. Collective.
    void
    recover(const Part &part, const Strains &means) const;

    /// Return is_curved() of recovered strains for all ends of a part in turn.
    std::vector<bool>
    curved_ends(const Part &part, const Strains &means) const;

    /// Mirror recovered strains at planes of symmetry, and add to boundary
    /// values what the cell means of eps* miss, except at ends in @p is_left.
    /// Collective.
    void
    extrapolate(const Part              &part,
                const Strains           &means,
                const std::vector<bool> &is_left) const;

    /// Set @p dual from @p w, with recovered strains, in the cells of a part.
    void
    renew(const Part                               &part,
          const DistributedVector                  &w,
          const std::vector<SymmetricTensor<4, 3>> *tangents,
          OfDual                                   &dual) const;

    /// Multiply strains at owned nodes by factors by node.
    void
    scale(NodalVector &strains, const std::vector<double> &factors) const;

    /// Set the shear along planes of symmetry to zero.
    void
    mirror() const;

    /// Interpolate the strains at hanging nodes from their parents.
    void
    interpolate_hanging_nodes(const Part &part) const;

    Strains
    mean_strains(const DistributedVector &u) const;

    /// Return eps* - eps_h, from recovered values, at the points of a cell.
    std::array<SymmetricTensor<2, 3>, n_points>
    defects(const unsigned int                                 cell,
            const std::array<SymmetricTensor<2, 3>, n_points> &strains) const;

    /// Return the strains of the elastic form in an owned cell, and set @p
    /// dilatations to the deviation of div u_h from its mean at its points:
    /// zero without mean dilatation.
    std::array<SymmetricTensor<2, 3>, n_points>
    strains(const unsigned int       cell,
            const DistributedVector &u,
            double                  *dilatations = nullptr) const;

    const LocalCells<dim> &local;
    /// Local indices of the first component at the vertices of owned cells.
    std::vector<std::array<unsigned int, n_vertices>> nodes;
    /// The vertices of owned cells on faces where the part ends, except for
    /// planes of symmetry, if the opposite vertex is not on such a face.
    std::vector<std::bitset<n_vertices>> ends;
    /// The cells that share one vertex and no more with an owned cell, where
    /// the mesh around the vertex is regular; invalid elsewhere.
    std::vector<std::array<unsigned int, n_vertices>> across;
    /// Nodes on planes of symmetry, with the normal.
    std::vector<std::pair<unsigned int, Tensor<1, 3>>> mirrored;
    /// Shape functions at the points of a cell.
    std::array<std::array<double, n_vertices>, n_points> shape_values;
    std::vector<Part>                                    parts;
    /// Of cells, including ghosts: the dim-th root of their area or volume.
    std::vector<double> widths;

    /// eps* at the nodes; kept, since allocating the vector in each step costs
    /// as much as filling it.
    mutable NodalVector values;
    /// Sums and maxima over the cells around nodes, for singular points.
    mutable NodalVector sums, maxima;
  };
} // namespace Viscoplastic
