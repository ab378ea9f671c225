// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/full_matrix.h>

#include <viscoplastic_contact/contact/contact_layout.h>

namespace Viscoplastic
{
  /// The symmetric positive definite matrix F of nonlinear Gauss-Seidel sweeps
  /// over Gamma_3, by which the residual of the face reacts to changes of
  /// single nodes.
  ///
  /// A sweep goes through the nodes stage by stage. Nodes of one stage on
  /// different ranks do not couple, so that a parallel sweep equals a
  /// sequential one.
  class FaceMatrix
  {
  public:
    /// Construct a matrix whose nodes are all swept in one stage.
    explicit FaceMatrix(const ContactLayout &face);
    virtual ~FaceMatrix() = default;

    /// The nodes of this rank in each stage, in the order of a sweep. All ranks
    /// have the same number of stages.
    const std::vector<std::vector<unsigned int>> &
    stages() const
    {
      return nodes_of_stage;
    }

    /// Diagonal block of a node, padded to 3 x 3 by pad_block().
    virtual Tensor<2, 3>
    diagonal_block(const unsigned int node) const = 0;

    /// r := r - F (change at node), on this rank.
    virtual void
    subtract(const unsigned int  node,
             const Tensor<1, 3> &change,
             Vector<double>     &r) const = 0;

    /// At the end of a stage subtract F times the changes of other ranks in it
    /// from r; @p change has those of this rank. Collective.
    virtual void
    subtract_changes_elsewhere(const unsigned int /*stage*/,
                               const Vector<double> & /*change*/,
                               Vector<double> & /*r*/) const
    {}

  protected:
    const ContactLayout                   &face;
    std::vector<std::vector<unsigned int>> nodes_of_stage;
  };


  /// Pad a leading n x n block by a diagonal of the size of its entries.
  void
  pad_block(Tensor<2, 3> &block, const unsigned int n);


  /// A dense face matrix: the Schur complement of the bulk.
  class DenseFaceMatrix : public FaceMatrix
  {
  public:
    DenseFaceMatrix(const ContactLayout &face, FullMatrix<double> &&matrix);

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
    FullMatrix<double> values;
  };
} // namespace Viscoplastic
