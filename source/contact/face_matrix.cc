// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/face_matrix.h>

#include <algorithm>

namespace Viscoplastic
{
  namespace
  {
    /// Fill the diagonal behind the leading n x n block: by 1, unless units of
    /// huge or tiny stresses make that too large or too small a stiffness.
    void
    pad(Tensor<2, 3> &block, const unsigned int n)
    {
      double largest = 0.;
      for (unsigned int i = 0; i < n; ++i)
        largest = std::max(largest, block[i][i]);
      const bool is_ordinary = n == 0 || (largest > 1e-6 && largest < 1e18);
      for (unsigned int i = n; i < 3; ++i)
        block[i][i] = is_ordinary ? 1. : largest;
    }
  } // namespace



  DenseFaceMatrix::DenseFaceMatrix(const FrictionFace  &face,
                                   FullMatrix<double> &&matrix)
    : face(face)
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
    pad(result, face.n_node_dofs(node));
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



  SparseFaceMatrix::SparseFaceMatrix(const FrictionFace &face,
                                     std::vector<Entry>  entries)
    : face(face)
    , row_begin(face.n_dofs() + 1, 0)
    , columns(entries.size())
    , values(entries.size())
  {
    std::sort(entries.begin(),
              entries.end(),
              [](const Entry &a, const Entry &b) {
                return a.row != b.row ? a.row < b.row : a.column < b.column;
              });
    for (std::size_t e = 0; e < entries.size(); ++e)
      {
        ++row_begin[entries[e].row + 1];
        columns[e] = entries[e].column;
        values[e]  = entries[e].value;
      }
    for (unsigned int i = 0; i < face.n_dofs(); ++i)
      row_begin[i + 1] += row_begin[i];
  }



  Tensor<2, 3>
  SparseFaceMatrix::diagonal_block(const unsigned int node) const
  {
    Tensor<2, 3>       result;
    const unsigned int first = face.first_dof[node];
    const unsigned int n     = face.n_node_dofs(node);
    for (unsigned int i = 0; i < n; ++i)
      for (std::size_t e = row_begin[first + i]; e < row_begin[first + i + 1];
           ++e)
        if (columns[e] >= first && columns[e] < first + n)
          result[i][columns[e] - first] = values[e];
    pad(result, n);
    return result;
  }



  void
  SparseFaceMatrix::subtract(const unsigned int  node,
                             const Tensor<1, 3> &change,
                             Vector<double>     &r) const
  {
    for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
      {
        const unsigned int row = face.first_dof[node] + i;
        for (std::size_t e = row_begin[row]; e < row_begin[row + 1]; ++e)
          r[columns[e]] -= values[e] * change[i];
      }
  }
} // namespace Viscoplastic
