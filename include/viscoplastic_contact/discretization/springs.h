// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/admissible_space.h>

#include <map>
#include <vector>

namespace Viscoplastic
{
  /// Springs between pieces of the boundary and the ground, the form
  ///
  ///     sum over the pieces of int k_n u_nu v_nu + k_t u_tau . v_tau,
  ///
  /// which is part of the matrix of a body. The stiffnesses are those of the
  /// points of a 2^(dim-1)-point Gauss rule on each face.
  template <int dim>
  class Springs
  {
  public:
    /// Throws ExcMessage where a stiffness is negative.
    explicit Springs(const AdmissibleSpace<dim> &space);

    /// The integral of the trace of K, comparable with the trace of a stiffness
    /// matrix. Collective.
    double
    total_stiffness() const
    {
      double sum = 0.;
      for_each_point(
        [&sum](const Face &, const auto &, const auto &K) { sum += trace(K); });
      return Utilities::MPI::sum(sum, space.communicator);
    }

    /// Add the form, times a factor, to a matrix in frames. Collective.
    void
    add_to(DistributedMatrix &matrix, const double factor = 1.) const;

    /// Add the force of the springs at a displacement (Cartesian, with ghosts)
    /// on the body, times a factor, to a load in frames. Collective.
    void
    add_force(const DistributedVector &ghosted_u,
              DistributedVector       &load,
              const double             factor = 1.) const;

    /// The forces of springs on the body, by boundary, and their energy.
    struct Summary
    {
      std::map<types::boundary_id, Tensor<1, dim>> forces;
      double                                       energy = 0.;
    };

    /// Collective.
    Summary
    summarize(const DistributedVector &ghosted_u) const;

  private:
    static constexpr unsigned int n_points = 1u << (dim - 1),
                                  n_nodes  = 1u << dim;

    struct Face
    {
      typename DoFHandler<dim>::active_cell_iterator cell;
      unsigned int                                   number;
      /// K times the area of each point.
      std::array<SymmetricTensor<2, dim>, n_points> stiffness;
    };

    /// Call visit(face, shape functions, K times area) at all points of owned
    /// faces.
    template <typename Visitor>
    void
    for_each_point(const Visitor &visit) const
    {
      for (const Face &face : faces)
        for (unsigned int q = 0; q < n_points; ++q)
          visit(face, shape_values[face.number][q], face.stiffness[q]);
    }

    /// u at a point with these shape functions.
    Tensor<1, dim>
    displacement(const DistributedVector           &ghosted_u,
                 const Face                        &face,
                 const std::array<double, n_nodes> &shapes) const;

    const AdmissibleSpace<dim> &space;
    std::vector<Face>           faces; // owned
    /// Shape functions of the nodes at the points of each face of a cell.
    std::array<std::array<std::array<double, n_nodes>, n_points>, 2 * dim>
      shape_values;
  };
} // namespace Viscoplastic
