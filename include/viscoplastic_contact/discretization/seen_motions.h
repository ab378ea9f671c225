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

  /// The displacement of a place, relative to the center of rotations, in
  /// each of the rigid motions.
  template <int dim>
  std::array<Tensor<1, dim>, n_rigid_motions<dim>>
  rigid_displacements(const Tensor<1, dim> &x);

  /// Rigid motions in words; of several parts that of the one which moves
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

    /// Givens rotations take a row into the triangle.
    void
    add(RigidMotion row);

    /// The rows of all ranks. Collective.
    void
    join(const MPI_Comm communicator);

    /// An orthonormal basis of the motions that no row sees, but for what
    /// coordinates in mesh files may miss.
    std::vector<RigidMotion>
    unseen() const;

  private:
    unsigned int       n;
    FullMatrix<double> triangle;
  };
} // namespace Viscoplastic
