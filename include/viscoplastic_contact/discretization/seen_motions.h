// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/lac/full_matrix.h>

#include <array>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  template <int dim>
  constexpr unsigned int n_rigid_motions = dim == 2 ? 3 : 6;

  /// A rigid motion: its coefficients for each connected part of the body, one
  /// part after the other.
  using RigidMotion = std::vector<double>;

  /// The displacement in each of the rigid motions of a place @p x, relative to
  /// the center of rotations.
  template <int dim>
  std::array<Tensor<1, dim>, n_rigid_motions<dim>>
  rigid_displacements(const Tensor<1, dim> &x);

  /// Rigid motions in words; for several parts the motion of the one that moves
  /// most.
  template <int dim>
  std::string
  in_words(std::vector<RigidMotion> motions);

  /// The constraints of boundary conditions on the rigid motions, one row each,
  /// kept as the factor R of their QR factorization. (R^T R would not tell the
  /// width of a thin sheet from rounding.)
  class SeenMotions
  {
  public:
    explicit SeenMotions(const unsigned int n)
      : n(n)
      , triangle(n, n)
    {}

    /// Add a row to the triangle by Givens rotations.
    void
    add(RigidMotion row);

    /// Combine the rows of all ranks. Collective.
    void
    join(const MPI_Comm communicator);

    /// An orthonormal basis of the motions that no row constrains, up to the
    /// rounding of coordinates in mesh files.
    std::vector<RigidMotion>
    unseen() const;

  private:
    unsigned int       n;
    FullMatrix<double> triangle;
  };
} // namespace Viscoplastic
