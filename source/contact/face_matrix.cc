// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/face_matrix.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Viscoplastic
{
  FaceMatrix::FaceMatrix(const ContactLayout &face)
    : face(face)
    , nodes_of_stage(1)
  {
    nodes_of_stage[0].resize(face.n_nodes());
    std::iota(nodes_of_stage[0].begin(), nodes_of_stage[0].end(), 0);
  }



  void
  pad_block(Tensor<2, 3> &block, const unsigned int n)
  {
    double largest = 0.;
    for (unsigned int i = 0; i < n; ++i)
      largest = std::max(largest, block[i][i]);
    // A power of two, whose inverse is exact.
    for (unsigned int i = n; i < 3; ++i)
      block[i][i] = n > 0 ? std::ldexp(1., std::ilogb(largest)) : 1.;
  }



  DenseFaceMatrix::DenseFaceMatrix(const ContactLayout &face,
                                   FullMatrix<double> &&matrix)
    : FaceMatrix(face)
    , values(std::move(matrix))
  {
    AssertDimension(values.m(), face.n_dofs());
  }



  Tensor<2, 3>
  DenseFaceMatrix::diagonal_block(const unsigned int node) const
  {
    Tensor<2, 3>       result;
    const unsigned int first = face.first_dof[node];
    for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
      for (unsigned int j = 0; j < face.n_node_dofs(node); ++j)
        result[i][j] = values(first + i, first + j);
    pad_block(result, face.n_node_dofs(node));
    return result;
  }



  void
  DenseFaceMatrix::subtract(const unsigned int  node,
                            const Tensor<1, 3> &change,
                            Vector<double>     &r) const
  {
    // Rows instead of columns: the matrix is symmetric, rows are contiguous.
    for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
      {
        const double *row = &values(face.first_dof[node] + i, 0);
        for (unsigned int j = 0; j < r.size(); ++j)
          r[j] -= row[j] * change[i];
      }
  }
} // namespace Viscoplastic
