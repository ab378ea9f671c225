// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/local_cells.h>
#include <viscoplastic_contact/scene/boundary_condition.h>

#include <array>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

namespace Viscoplastic
{
  /// The residual estimator for the inequality of one step,
  ///
  ///     eta_K^2 = sum_e 1/24 h (r, M^-1 r)_e  interior faces,
  ///                     r = [sigma_h nu],
  ///             + sum_e 1/6 h (r, M^-1 r)_e   boundary,
  ///                     r = F - sigma_h nu on Gamma_2,
  ///                     r = lambda_h + (sigma_h nu)_tau, S - sigma_nu on
  ///                         Gamma_3,
  ///
  /// with M = nu . E . nu the acoustic tensor, h the width of the cell across
  /// the face, sigma_h = E eps(u_h) + z_h and z_h the cell means of z. For
  /// smooth solutions on meshes of equal boxes it is the squared error to
  /// leading order: the error is then -x (h - x)/2 times the second derivative
  /// in each direction, whose stress jumps by h between cells and differs from
  /// the data by h/2. The residual within cells, b + div sigma_h, is equivalent
  /// to the jumps (Carstensen and Verfuerth, Edge Residuals Dominate A
  /// Posteriori Error Estimates for Low Order Finite Element Methods, 1999) up
  /// to the variation of b within a cell, which is of second order; it is left
  /// out.
  ///
  /// On Gamma_3 the normal part appears where the normal stress is given. Where
  /// only some components of u are prescribed, the residual of the others
  /// counts with F = 0 (symmetry: the tangential ones).
  ///
  /// The terms of complementarity and of violated bounds are zero at the nodes:
  /// multipliers satisfy the laws of contact to rounding. Between nodes, the
  /// excess of the density over a bound that jumps counts.
  ///
  /// For unilateral contact, the residual is the whole traction plus the
  /// density, and off_the_law() is added like a traction: u_nu - g and the
  /// density violate the law of the foundation between nodes. Such tractions
  /// have no direction of their own, and 1/mu replaces M^-1.
  ///
  /// Two bodies have r = lambda_h + sigma_h nu on both sides, also if glued: on
  /// matching meshes lambda_h is the mean of both tractions, and the two terms
  /// equal that of an interior face. off_the_interface() is added.
  ///
  /// The estimate bounds the error of one step for given z; the error
  /// accumulated in z is not part of it. An initial stress, which may vary in
  /// cells and balance the loads there, enters by its values instead of the
  /// cell means in z; so does the thermal stress, except with mean dilatation,
  /// where the equations contain its means alone. Absent materials do not
  /// count, and faces towards them are free ones of Gamma_2.
  ///
  /// Data that depend on the mesh alone are kept from step to step, as are data
  /// that do not depend on time.
  template <int dim>
  class ResidualEstimator
  {
  public:
    /// Keeps a reference to @p cells.
    explicit ResidualEstimator(const LocalCells<dim> &cells);

    /// A displacement and stress field whose residuals are computed.
    struct Fields
    {
      /// The displacement, Cartesian, with ghosts.
      const DistributedVector &u;
      /// The irreversible stress, including thermal stress only with mean
      /// dilatation; may be empty.
      const IrreversibleStress &z;
      /// The time of the loads; none for fields without loads.
      std::optional<double> t;
      /// The nodal field lambda_h on Gamma_3 and on both sides of interfaces,
      /// Cartesian with ghosts; null without contact points and interfaces.
      const DistributedVector *multiplier_density;
      /// If positive, the variation of relaxed strains within cells counts by
      /// this times |sigma|/|E eps| of the deviatoric means, at most fully.
      double memory = 0.;
      /// AdmissibleSpace::make_relative() of u; null without contact between
      /// bodies.
      const DistributedVector *relative_u = nullptr;
      /// The nodal density of a load on the boundary in addition to the data,
      /// Cartesian with ghosts.
      const DistributedVector *load_density = nullptr;
    };

    /// Return eta_K^2 by active cell, zero on cells of other ranks. Collective.
    Vector<double>
    estimate(const Fields &fields) const;

    /// Return the errors of the geometry of curved bodies in contact, squared,
    /// by active cell like those of estimate(). The surfaces in contact,
    /// SurfaceFace::bulge(), are off those of the manifold by delta in the
    /// middle of a face, and so is the gap in contact. Like an error delta of
    /// prescribed displacements,
    ///
    ///     eta_K^2 = sum_e 1/6 h (2 k^2 delta^2/2 mu)_e,   k = 2 mu/h_e.
    ///
    /// Bodies that are apart by less than delta count with the difference.
    Vector<double>
    estimate_geometry(const Fields &fields) const;

    /// Whether estimate_geometry() can be nonzero. The same on all ranks.
    bool
    has_curved_contact() const
    {
      return largest_offset > 0.;
    }

    /// The data of a dual solution that multiply() uses.
    struct OfDual
    {
      /// M^-1 r_w at the face points times their weights and 1/24 or 1/6 h, in
      /// the order of visit_residuals().
      std::vector<std::array<Tensor<1, dim>, 1u << (dim - 1)>> weighted;
      /// a(e_w, e_w) for each active cell, zero on cells of other ranks.
      Vector<double> squares;
    };

    /// Return the data of the dual solution @p dual. Collective.
    OfDual
    of_dual(const Fields &dual) const;

    /// Return the signed products of the errors of two solutions by active
    /// cell, zero on cells of other ranks:
    ///
    ///     a(e_u, e_w)_K = sum_e 1/24 h (r_u, M^-1 r_w)_e
    ///                     + sum_e 1/6 h (r_u, M^-1 r_w)_e,
    ///
    /// from the residuals r of both as above; no bounds. Collective.
    Vector<double>
    multiply(const Fields &state, const OfDual &dual) const;

  private:
    static constexpr unsigned int n_vertices = LocalCells<dim>::n_vertices,
                                  n_points   = LocalCells<dim>::n_points,
                                  n_faces    = LocalCells<dim>::n_faces,
                                  n_face_points =
                                    LocalCells<dim>::n_face_points;

    using NodalValues = typename LocalCells<dim>::NodalValues;
    using Cell        = typename LocalCells<dim>::CellIterator;
    using FaceShape   = typename LocalCells<dim>::FaceShape;
    using Shape       = typename LocalCells<dim>::Shape;
    using LocalCell   = typename LocalCells<dim>::LocalCell;

    /// A part of a cell's face opposite a finer cell.
    struct SubfaceSide
    {
      unsigned int cell, table;
    };

    struct InteriorFace
    {
      /// The finer cell first: its weights are used.
      std::array<unsigned int, 2> cells;
      unsigned int                face;
      /// Index of the first traction of each side.
      std::array<unsigned int, 2> tractions;
      /// The second side's point that coincides with each point of the first.
      std::array<unsigned char, n_face_points> partner;
      /// Whether both cells are of one isotropic material.
      bool is_within_material = false;
    };

    struct BoundaryFace
    {
      unsigned int                          cell, face;
      const BoundaryCondition<dim>         *condition;
      double                                diameter;
      std::array<Point<dim>, n_face_points> positions;
      /// The given traction or normal stress and the friction bound, as far as
      /// they do not depend on time.
      std::array<Tensor<1, dim>, n_face_points> data;
      std::array<double, n_face_points>         bounds;
      /// The gap g of unilateral contact, if it does not depend on time, and c.
      std::array<double, n_face_points> gaps, compliances;

      /// K of springs, and the weight (I + h_e K/(2 mu))^-1/2 of residuals: the
      /// energy norm contains that of the springs.
      struct Spring
      {
        SymmetricTensor<2, dim> stiffness, weight;
      };
      /// Empty without springs.
      std::vector<Spring> springs;
      /// Whether this face is the primary side of an interface.
      bool is_other_side = false;
      /// Distance of the contact surface from the manifold in mid-face.
      double offset = 0.;

      /// The initial position opposite to a point on another body: relevant
      /// nodes with weights, the normal, the distance along it, and the sum of
      /// h_e/(2 mu) of both bodies.
      struct Opposite
      {
        std::vector<std::pair<std::size_t, double>> nodes;
        Tensor<1, dim>                              normal;
        double                                      distance, softness;
      };
      /// Empty without another body; no nodes where nothing is opposite.
      std::vector<Opposite> opposite;
    };

    /// The terms of the stress at points of one cell.
    struct StressTerms
    {
      NodalValues      u;
      const Stiffness *stiffness;
      double           dilatation; // cell mean of div u_h
      Tensor<2, dim>   z;          // in the plane
    };

    void
    make_faces();
    void
    make_face_values();
    void
    make_initial_stress();
    void
    make_thermal_points();
    void
    find_other_bodies();
    void
    compare_with_manifold();

    /// Add the part @p subface of face @p f of the cell with this number.
    /// Returns the number of its shape.
    unsigned int
    add_subface_side(const Cell           &cell,
                     const unsigned int    number,
                     const unsigned int    f,
                     const unsigned int    subface,
                     FESubfaceValues<dim> &values);

    /// Add face @p f of the cell with this number.
    void
    add_boundary_face(const Cell                   &cell,
                      const unsigned int            f,
                      const unsigned int            number,
                      const BoundaryCondition<dim> &condition);

    StressTerms
    stress_terms(const std::size_t            cell,
                 const Fields                &fields,
                 const SymmetricTensor<2, 3> *mean_z) const;

    /// Set @p tractions to sigma_h nu at the points of a face.
    void
    add_tractions(const FaceShape   &face,
                  const StressTerms &terms,
                  Tensor<1, dim>    *tractions) const;

    /// Residuals at the points of a face, followed by the other defects there.
    using Residuals = std::array<Tensor<1, dim>, 2 * n_face_points>;

    /// Return the residuals of tractions at the points of a face, and behind
    /// them, by point, the excess of the friction density over its bound and
    /// off_the_law() or off_the_interface().
    Residuals
    boundary_residuals(const BoundaryFace   &face,
                       const Fields         &fields,
                       const Tensor<1, dim> *tractions) const;

    /// Return the distance of the penetration w = u_nu - g and the pressure p
    /// at a point of a face from the law of the foundation,
    ///
    ///     min(k |w - w(p)|, |p - p(w)|),   k = 2 mu/h_e,
    ///
    /// in units of stress: the smaller of the errors in w, times the stiffness
    /// k, and in p. For a rigid foundation w(p) = 0, or any w <= 0 without
    /// pressure, and p(w) = 0 if it does not touch: k w for a penetration,
    /// min(k g, p) for a gap.
    double
    off_the_law(const BoundaryFace &face,
                const unsigned int  q,
                const double        k,
                const double        w,
                const double        p) const;

    /// Return the error of displacements at a point of an interface, in units
    /// of stress: off_the_law() for unilateral contact, and k |delta|, where
    /// delta is the difference of the jump between the bodies and its nodal
    /// interpolation, which alone obeys the laws of contact; it is nonzero on
    /// nonmatching meshes. The tangential part is limited by the tangential
    /// density. k: the stiffness of both bodies in series.
    double
    off_the_interface(const BoundaryFace   &face,
                      const unsigned int    q,
                      const Tensor<1, dim> &u,
                      const Tensor<1, dim> &relative_u,
                      const double          gap,
                      const Tensor<1, dim> &density,
                      const Fields         &fields) const;

    /// The residuals on a face, or a part, of an adjacent owned or ghost cell.
    struct LocalResiduals
    {
      std::size_t      cell;
      const FaceShape &face;
      double           share; // of the cell's face
      bool             is_at_boundary;
      const Residuals &values;
      /// Whether the last visit had the same residuals, for a cell of the same
      /// material.
      bool are_again = false;
    };

    /// Return 1/24 or 1/6 h, see the class.
    double
    factor(const LocalResiduals &r) const;

    /// Evaluate the residuals and call visit(LocalResiduals), in an order that
    /// depends on the mesh alone. Collective.
    template <typename Visitor>
    void
    visit_residuals(const Fields &fields, const Visitor &visit) const;

    const LocalCells<dim>        &local;
    const StressSpace<dim>       &stress_space;
    const std::vector<Shape>     &shapes;
    const std::vector<LocalCell> &cells;

    std::vector<FaceShape>    subface_shapes;
    std::vector<SubfaceSide>  subface_sides;
    std::vector<InteriorFace> interior_faces;
    /// The largest BoundaryFace::offset of all ranks.
    double                    largest_offset = 0.;
    std::vector<BoundaryFace> boundary_faces;
    /// Shape functions at the points of each face.
    std::array<std::array<std::array<double, n_vertices>, n_face_points>,
               n_faces>
      face_values;
    /// The difference of sigma0 nu at all faces and that of the cell means in
    /// z_h; empty without an initial stress.
    std::vector<Tensor<1, dim>> initial_tractions;

    /// Add the tractions of the thermal stress at time t. Collective.
    void
    add_thermal_tractions(const double                 t,
                          std::vector<Tensor<1, dim>> &tractions) const;

    /// Call call(cell, face) for all faces, in the order of tractions.
    template <typename Call>
    void
    for_each_face(const Call &call) const;

    /// A point where the thermal stress, -E alpha (T - T_0), has a traction
    /// that the other side of the face does not balance: at the boundary and
    /// between unlike materials.
    struct ThermalPoint
    {
      std::size_t    traction; // position
      Point<dim>     x;
      double         reference; // T_0
      Tensor<1, dim> of_degree; // -E alpha nu
    };
    std::vector<ThermalPoint> thermal_points;
    /// T at these points, kept if it does not depend on time.
    mutable std::optional<std::vector<double>> temperatures;

    /// Subface shapes by cell shape, face and subface; for construction only.
    std::map<std::tuple<unsigned int, unsigned int, unsigned int>, unsigned int>
      subface_shape_of;
  };
} // namespace Viscoplastic
