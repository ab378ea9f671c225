// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/discretization/stress_space.h>

#include <array>
#include <vector>

namespace Viscoplastic
{
  /// Return the components of stress @p normal in the section, in 3D all.
  template <int dim>
  Tensor<1, dim>
  in_plane(const SymmetricTensor<2, 3> &stress, const Tensor<1, dim> &normal)
  {
    Tensor<1, dim> traction;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        traction[i] += stress[i][j] * normal[j];
    return traction;
  }



  /// The geometry that spatial error estimators use: shape functions of V_h in
  /// all owned and ghost cells of this rank. Cells that differ by a translation
  /// share them, in bodies of revolution by one along the axis, so that a step
  /// evaluates no finite elements.
  template <int dim>
  class LocalCells
  {
  public:
    static constexpr unsigned int n_vertices = 1u << dim, n_points = 1u << dim,
                                  n_faces       = 2 * dim,
                                  n_face_points = 1u << (dim - 1);

    using Gradients    = std::array<Tensor<1, dim>, n_vertices>;
    using CellIterator = typename DoFHandler<dim>::active_cell_iterator;

    /// Vertex values of a field, and its strain zz if uniform in the section.
    struct NodalValues : std::array<Tensor<1, dim>, n_vertices>
    {
      double axial_strain = 0.;
    };

    /// Return the gradient of a field with these values at the vertices.
    static Tensor<2, dim>
    gradient(const NodalValues &values, const Gradients &shape_gradients)
    {
      Tensor<2, dim> result;
      for (unsigned int v = 0; v < n_vertices; ++v)
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            result[i][j] += values[v][i] * shape_gradients[v][j];
      return result;
    }

    /// u_r/r of u_r = 1 at each vertex; zero except in bodies of revolution.
    using Hoops = std::array<double, n_vertices>;

    /// Return the strain zz of a field with these values: u_r/r in rings.
    double
    strain_zz(const NodalValues &values, const Hoops &hoops) const
    {
      double result = values.axial_strain;
      for (unsigned int v = 0; has_hoops && v < n_vertices; ++v)
        result += values[v][0] * hoops[v];
      return result;
    }

    /// A face or subface at its quadrature points.
    struct FaceShape
    {
      /// The gradients of the vertices' shape functions.
      std::array<Gradients, n_face_points>      gradients;
      std::array<Tensor<1, dim>, n_face_points> normals;
      std::array<Tensor<1, dim>, n_face_points> positions; // from vertex 0
      std::array<double, n_face_points>         weights;
      std::array<Hoops, n_face_points>          hoops;
      double                                    area = 0.;

      void
      reinit(const Point<dim>            &vertex_0,
             const FEFaceValuesBase<dim> &values,
             const bool                   is_of_ring);
    };

    struct Shape
    {
      double                               diameter, volume;
      Gradients                            mean_gradients;
      std::array<Gradients, n_points>      gradients;
      std::array<double, n_points>         weights;
      Hoops                                mean_hoops{};
      std::array<Hoops, n_points>          hoops{};
      std::array<FaceShape, n_faces>       faces;
      std::array<Tensor<1, dim>, n_points> positions; // from vertex 0
    };

    struct LocalCell
    {
      unsigned int             shape, active_index;
      types::global_cell_index global_active_index;
      /// Local indices of the vertices' first components in ghosted vectors.
      std::array<unsigned int, n_vertices> nodes;
      Stiffness                            stiffness;
      Point<dim>                           origin; // vertex 0
      types::material_id                   material_id;
      /// Whether the cell is part of the body in the present stage.
      bool is_present;
    };

    /// Keeps a reference to @p stress_space.
    explicit LocalCells(const StressSpace<dim> &stress_space);

    const StressSpace<dim> &stress_space;
    /// Whether cells are sections of rings.
    const bool         has_hoops;
    std::vector<Shape> shapes;
    /// The owned cells first, in the order of the stress space, then ghosts.
    std::vector<LocalCell> cells;

    /// Return u at a cell's vertices; @p u: local array of a ghosted vector.
    NodalValues
    displacements(const LocalCell &cell, const double *u) const;

    /// Return the mean strain of a field in a cell.
    SymmetricTensor<2, 3>
    mean_strain(const LocalCell &cell, const NodalValues &displacements) const;

    /// The strains at the points of a cell.
    using Strains = std::array<SymmetricTensor<2, 3>, n_points>;

    /// Return the strains of the elastic form at the points of a cell: those of
    /// u_h, under mean dilatation with their mean volumetric part. Set @p
    /// dilatations, if given, to the deviation of div u_h from its mean under
    /// mean dilatation, otherwise to zero.
    Strains
    strains(const LocalCell   &cell,
            const NodalValues &displacements,
            double            *dilatations = nullptr) const;

    /// Return those of the owned cells; @p u with ghosts, Cartesian.
    std::vector<Strains>
    strains(const DistributedVector &u) const;

    /// Return cell means of z in owned cells and ghosts, stored in @p means
    /// unless z itself holds them; null without z. Collective.
    const SymmetricTensor<2, 3> *
    mean_irreversible_stress(const IrreversibleStress &z,
                             IrreversibleStress       &means) const;

    /// Return values of the owned cells by active cell index.
    Vector<double>
    by_active_index(const std::vector<double> &by_cell) const;

  private:
    void
    add_shape(const CellIterator &cell,
              FEValues<dim>      &values,
              FEFaceValues<dim>  &on_face);
  };
} // namespace Viscoplastic
