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
  /// with the width h of the cell across the face, the acoustic tensor
  /// M = nu . E . nu, sigma_h = E eps(u_h) + z_h and z_h the cell means of z.
  /// For smooth solutions on meshes of equal boxes that is the squared error to
  /// leading order: the error is -x (h - x)/2 times the second derivative in
  /// each direction then, whose stress jumps by h between cells and misses the
  /// data by h/2. What is amiss within the cells, b + div sigma_h, says the
  /// same once more (Carstensen and Verfuerth, Edge Residuals Dominate A
  /// Posteriori Error Estimates for Low Order Finite Element Methods, 1999),
  /// but for what b varies by within a cell, which is of second order, and does
  /// not count.
  ///
  /// On Gamma_3 the normal part appears where the normal stress is given. Where
  /// only some components of u are prescribed, the residual of the others
  /// counts with F = 0 (symmetry: the tangential ones).
  ///
  /// The terms of complementarity and of violated bounds are zero at the nodes:
  /// the contact solver's multipliers satisfy the laws of contact to rounding.
  /// Between nodes the density exceeds a bound that jumps, which counts.
  ///
  /// Where contact opens, the whole traction is compared with the density, and
  /// off_the_law() counts besides, like a traction: u_nu - g and the density
  /// between the nodes are not those of one state of the foundation. Such
  /// tractions have no direction of their own, and 1/mu for M^-1.
  ///
  /// Two bodies have r = lambda_h + sigma_h nu on both sides, also of what is
  /// glued: where meshes match, with lambda_h halfway between both tractions,
  /// these two are what an interior face has. off_the_interface() counts
  /// besides.
  ///
  /// The estimate bounds the error of one step for given z; the error that has
  /// accumulated in z is not part of it. An initial stress, which may vary in
  /// cells and balance the loads there, is taken as it is, and not as the cell
  /// means that z holds of it; so is the thermal stress, but with mean
  /// dilatation, where the equations know its means alone. Cells of absent
  /// materials count for nothing, and faces towards them as free ones of
  /// Gamma_2.
  ///
  /// What depends on the mesh alone is kept from step to step, as are data that
  /// do not depend on time.
  template <int dim>
  class ResidualEstimator
  {
  public:
    /// The argument stays in use.
    explicit ResidualEstimator(const LocalCells<dim> &cells);

    /// A displacement and stress field whose residuals are computed.
    struct Fields
    {
      /// The displacement, Cartesian, with ghosts.
      const DistributedVector &u;
      /// Without thermal stress, but with mean dilatation; may be empty.
      const IrreversibleStress &z;
      /// The time at which the loads are evaluated; none for fields without
      /// loads.
      std::optional<double> t;
      /// The nodal field lambda_h on Gamma_3 and on both sides of interfaces,
      /// Cartesian with ghosts; null without contact points and interfaces.
      const DistributedVector *multiplier_density;
      /// Of a strain whose stress has relaxed only this times |sigma|/|E eps|
      /// of the deviatoric means counts of what it varies by within a cell, if
      /// that is less than 1; 0: all of it.
      double memory = 0.;
      /// AdmissibleSpace::make_relative() of u; null without contact between
      /// bodies.
      const DistributedVector *relative_u = nullptr;
      /// The nodal density of a load on the boundary beside that of the data,
      /// Cartesian with ghosts.
      const DistributedVector *load_density = nullptr;
    };

    /// eta_K^2 for each active cell, zero on cells of other ranks. Collective.
    Vector<double>
    estimate(const Fields &fields) const;

    /// What the shapes of curved bodies that touch each other miss of their
    /// geometry, as squared errors by active cell like those of estimate(). The
    /// surfaces in contact, SurfaceFace::bulge(), are off those of the manifold
    /// by delta in the middle of a face, and so is the gap where they touch: as
    /// of prescribed displacements that are wrong by as much,
    ///
    ///     eta_K^2 = sum_e 1/6 h (2 k^2 delta^2/2 mu)_e,   k = 2 mu/h_e.
    ///
    /// Bodies that do not touch, but may within delta, count by the rest.
    Vector<double>
    estimate_geometry(const Fields &fields) const;

    /// Whether estimate_geometry() can have anything. The same on all ranks.
    bool
    has_curved_contact() const
    {
      return largest_offset > 0.;
    }

    /// What multiply() takes of a dual solution.
    struct OfDual
    {
      /// M^-1 r_w at the points of faces times their weights, 1/24 or 1/6 h
      /// included, in the order of visit_residuals().
      std::vector<std::array<Tensor<1, dim>, 1u << (dim - 1)>> weighted;
      /// a(e_w, e_w) for each active cell, zero on cells of other ranks.
      Vector<double> squares;
    };

    /// Collective.
    OfDual
    of_dual(const Fields &dual) const;

    /// The products of the errors of two solutions, with their signs, for each
    /// active cell, zero on cells of other ranks:
    ///
    ///     a(e_u, e_w)_K = sum_e 1/24 h (r_u, M^-1 r_w)_e
    ///                     + sum_e 1/6 h (r_u, M^-1 r_w)_e,
    ///
    /// from the residuals r of both as above. No bound: for products of
    /// errors, which have signs. Collective.
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

    /// A part of a cell's face that hanging nodes bound.
    struct SubfaceSide
    {
      unsigned int cell, table;
    };

    struct InteriorFace
    {
      /// The finer one first: its weights count.
      std::array<unsigned int, 2> cells;
      unsigned int                face;
      /// Position of the first traction of each side.
      std::array<unsigned int, 2> tractions;
      /// The point of the second side at each point of the first.
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
      /// g of contact that opens, if it does not depend on time, and c.
      std::array<double, n_face_points> gaps, compliances;

      /// K of springs, and the root of (I + h_e K/(2 mu))^-1 by which residuals
      /// count beside them: they cannot do more than to the springs alone.
      struct Spring
      {
        SymmetricTensor<2, dim> stiffness, weight;
      };
      /// None without springs.
      std::vector<Spring> springs;
      /// Whether another body has contact with this one here.
      bool is_other_side = false;
      /// How far the curved surface in contact is from the manifold in the
      /// middle of the face.
      double offset = 0.;

      /// Where another body was opposite to a point at first: relevant nodes
      /// with weights, the normal, the distance along it, and h_e/(2 mu) of
      /// both.
      struct Opposite
      {
        std::vector<std::pair<std::size_t, double>> nodes;
        Tensor<1, dim>                              normal;
        double                                      distance, softness;
      };
      /// None without another body; without nodes where nothing is opposite.
      std::vector<Opposite> opposite;
    };

    /// What makes the stress at points of one cell.
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

    /// Add a part of the face @p f of a cell with this number. Returns the
    /// number of its shape.
    unsigned int
    add_subface_side(const Cell           &cell,
                     const unsigned int    number,
                     const unsigned int    f,
                     const unsigned int    subface,
                     FESubfaceValues<dim> &values);

    /// Face @p f of a cell with this number.
    void
    add_boundary_face(const Cell                   &cell,
                      const unsigned int            f,
                      const unsigned int            number,
                      const BoundaryCondition<dim> &condition);

    StressTerms
    stress_terms(const std::size_t            cell,
                 const Fields                &fields,
                 const SymmetricTensor<2, 3> *mean_z) const;

    /// sigma_h nu at the points of a face.
    void
    add_tractions(const FaceShape   &face,
                  const StressTerms &terms,
                  Tensor<1, dim>    *tractions) const;

    /// At the points of a face, and once more for what else is amiss there.
    using Residuals = std::array<Tensor<1, dim>, 2 * n_face_points>;

    /// The contradictions of tractions to the data at the points of a face, and
    /// behind them what is amiss with friction, by how much the density exceeds
    /// its bound, and with contact that opens, off_the_law().
    Residuals
    boundary_residuals(const BoundaryFace   &face,
                       const Fields         &fields,
                       const Tensor<1, dim> *tractions) const;

    /// How far the penetration w = u_nu - g and the pressure p at a point of a
    /// face are from each other by the law of the foundation,
    ///
    ///     min(k |w - w(p)|, |p - p(w)|),   k = 2 mu/h_e,
    ///
    /// in stress: as if the body closed a gap, or left a penetration, like a
    /// spring, or felt another pressure, whichever is less. For a rigid
    /// foundation w(p) = 0, or any w <= 0 without pressure, and p(w) = 0 where
    /// it does not touch: k w of what penetrates, min(k g, p) of a gap.
    double
    off_the_law(const BoundaryFace &face,
                const unsigned int  q,
                const double        k,
                const double        w,
                const double        p) const;

    /// What is amiss with displacements at a point of an interface, in stress:
    /// off_the_law() of contact that opens, and k |delta|, delta being what the
    /// jump between the bodies has beyond the interpolated one of the nodes,
    /// which alone obeys the laws of contact: of meshes that do not match. Its
    /// tangential part says nothing beyond the traction there. k is that of
    /// both bodies one after the other.
    double
    off_the_interface(const BoundaryFace   &face,
                      const unsigned int    q,
                      const Tensor<1, dim> &u,
                      const Tensor<1, dim> &relative_u,
                      const double          gap,
                      const Tensor<1, dim> &density,
                      const Fields         &fields) const;

    /// The residuals on a face, or a part of one, for a cell beside it, of this
    /// rank or a ghost.
    struct LocalResiduals
    {
      std::size_t      cell;
      const FaceShape &face;
      double           share; // of the cell's face
      bool             is_at_boundary;
      const Residuals &values;
      /// Whether those of the last visit are the same, of a cell of the same
      /// material.
      bool are_again = false;
    };

    /// 1/24 or 1/6 h, see above.
    double
    factor(const LocalResiduals &r) const;

    /// Evaluate the residuals and visit(LocalResiduals), in an order that
    /// depends on the mesh alone. Collective.
    template <typename Visitor>
    void
    visit_residuals(const Fields &fields, const Visitor &visit) const;

    /// M^-1 r, see multiply().
    Tensor<1, dim>
    complied(const Stiffness      &stiffness,
             const Tensor<1, dim> &normal,
             const Tensor<1, dim> &r) const;

    const LocalCells<dim>        &local;
    const StressSpace<dim>       &stress_space;
    const std::vector<Shape>     &shapes;
    const std::vector<LocalCell> &cells;

    std::vector<FaceShape>    subface_shapes;
    std::vector<SubfaceSide>  subface_sides;
    std::vector<InteriorFace> interior_faces;
    /// BoundaryFace::offset, of all ranks.
    double                    largest_offset = 0.;
    std::vector<BoundaryFace> boundary_faces;
    /// Shape functions at the points of each face.
    std::array<std::array<std::array<double, n_vertices>, n_face_points>,
               n_faces>
      face_values;
    /// What sigma0 nu at all faces has beyond that of its cell means, which z_h
    /// holds; empty without an initial stress.
    std::vector<Tensor<1, dim>> initial_tractions;

    /// Add the thermal stress at time t. Collective.
    void
    add_thermal_tractions(const double                 t,
                          std::vector<Tensor<1, dim>> &tractions) const;

    /// What call(cell, face) does for all faces, in the order of tractions.
    template <typename Call>
    void
    for_each_face(const Call &call) const;

    /// Where the thermal stress, -E alpha (T - T_0), has a traction nu that the
    /// other side of the face does not balance: at the boundary and where
    /// unlike materials meet.
    struct ThermalPoint
    {
      std::size_t    traction; // position
      Point<dim>     x;
      double         reference; // T_0
      Tensor<1, dim> of_degree; // -E alpha nu
    };
    std::vector<ThermalPoint> thermal_points;
    /// T there, kept if it stays.
    mutable std::optional<std::vector<double>> temperatures;

    /// sigma nu at all faces: kept, since a new array for each step costs as
    /// much as to fill it.
    mutable std::vector<Tensor<1, dim>> traction_buffer;

    /// Only for the construction.
    std::map<std::tuple<unsigned int, unsigned int, unsigned int>, unsigned int>
      subface_shape_of;
  };
} // namespace Viscoplastic
