// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/full_matrix.h>

#include <viscoplastic_contact/contact/friction_face.h>

namespace Viscoplastic
{
  /**
   * The symmetric positive definite matrix by which the face reacts to changes
   * of single nodes: what nonlinear Gauss-Seidel sweeps over Gamma_3 need.
   */
  class FaceMatrix
  {
  public:
    virtual ~FaceMatrix() = default;

    /// Diagonal block of a node, padded by the identity.
    virtual Tensor<2, 3>
    diagonal_block(const unsigned int node) const = 0;

    /// r := r - F (change at node).
    virtual void
    subtract(const unsigned int  node,
             const Tensor<1, 3> &change,
             Vector<double>     &r) const = 0;
  };


  /// A dense one: the Schur complement of the bulk.
  class DenseFaceMatrix : public FaceMatrix
  {
  public:
    DenseFaceMatrix(const FrictionFace &face, FullMatrix<double> &&matrix);

    Tensor<2, 3>
    diagonal_block(const unsigned int node) const override;

    void
    subtract(const unsigned int  node,
             const Tensor<1, 3> &change,
             Vector<double>     &r) const override;

    const FullMatrix<double> &
    matrix() const
    {
      return values;
    }

  private:
    const FrictionFace &face;
    FullMatrix<double>  values;
  };


  /// A sparse one in compressed rows: couplings of face unknowns at fixed bulk.
  class SparseFaceMatrix : public FaceMatrix
  {
  public:
    /// (row, column, value), in any order, each pair once.
    struct Entry
    {
      unsigned int row, column;
      double       value;

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &row &column &value;
      }
    };

    SparseFaceMatrix(const FrictionFace &face, std::vector<Entry> entries);

    Tensor<2, 3>
    diagonal_block(const unsigned int node) const override;

    void
    subtract(const unsigned int  node,
             const Tensor<1, 3> &change,
             Vector<double>     &r) const override;

  private:
    const FrictionFace       &face;
    std::vector<std::size_t>  row_begin;
    std::vector<unsigned int> columns;
    std::vector<double>       values;
  };
} // namespace Viscoplastic
