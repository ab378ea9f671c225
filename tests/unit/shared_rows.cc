// SPDX-License-Identifier: LGPL-2.1-or-later

// Products with sparse rows that share values.

#include "body.h"
#include <viscoplastic_contact/linear_solvers/shared_rows.h>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class SharedRowsTest : public testing::Test
  {};
  TYPED_TEST_SUITE(SharedRowsTest, Dimensions, );



  /// A matrix on a ring of nodes, each coupled with the next three on both
  /// sides; the rows of even nodes are equal but for @p noise, and so are those
  /// of odd ones. The last two nodes belong to another rank.
  template <int dim>
  struct Ring
  {
    static constexpr unsigned int n = 41, n_owned = n - 2;

    Ring(const double noise)
    {
      for (unsigned int i = 0; i < n_owned; ++i)
        {
          for (unsigned int j = 0; j < n; ++j)
            if (const unsigned int distance = (j + n - i) % n;
                distance < 4 || distance > n - 4)
              {
                NodeBlock<dim> block;
                for (unsigned int c = 0; c < dim; ++c)
                  for (unsigned int d = 0; d < dim; ++d)
                    block[c][d] = (distance == 0 ?
                                     (c == d ? 20. : 0.5) :
                                     -std::cos(distance + 2. * c + d + i % 2)) *
                                  (1. + noise * std::sin(7. * i + j + c));
                matrix.columns.push_back(j);
                matrix.values.push_back(block);
              }
          matrix.begin.push_back(matrix.columns.size());
        }
    }

    SharedRows<dim>
    shared() const
    {
      SharedRows<dim> rows;
      rows.set_values(matrix, {matrix.columns.begin(), matrix.columns.end()});
      return rows;
    }

    BlockRows<dim> matrix;
  };



  template <int dim>
  void
  check_products(const double noise, const double tolerance)
  {
    const Ring<dim>       ring(noise);
    const SharedRows<dim> rows = ring.shared();
    std::vector<float>    x(ring.n * dim), b(x), y(x), r(x);
    for (unsigned int i = 0; i < x.size(); ++i)
      {
        x[i] = std::sin(3. * i);
        b[i] = std::cos(5. * i);
      }
    rows.residual(y.data(), x.data(), r.data()); // of zero
    rows.residual(r.data(), x.data(), b.data());
    for (unsigned int i = 0; i < ring.n_owned; ++i)
      {
        Tensor<1, dim> expected;
        for (auto e = ring.matrix.begin[i]; e < ring.matrix.begin[i + 1]; ++e)
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim; ++d)
              expected[c] += ring.matrix.values[e][c][d] *
                             x[ring.matrix.columns[e] * dim + d];
        for (unsigned int c = 0; c < dim; ++c)
          {
            EXPECT_NEAR(-y[i * dim + c], expected[c], tolerance);
            EXPECT_NEAR(r[i * dim + c],
                        b[i * dim + c] - expected[c],
                        tolerance);
          }
      }
    for (unsigned int i = ring.n_owned * dim; i < x.size(); ++i)
      EXPECT_EQ(y[i], 0) << "of another rank";
  }



  TYPED_TEST(SharedRowsTest, MultiplyAsTheMatrixDoes)
  {
    constexpr int dim = TypeParam::value;
    check_products<dim>(0., 1e-4);
    check_products<dim>(0.1, 1e-4);
  }



  TYPED_TEST(SharedRowsTest, ShareWhatIsEqualUpToRounding)
  {
    constexpr int dim   = TypeParam::value;
    const auto    count = [](const double noise) {
      return Ring<dim>(noise).shared().n_stored_blocks();
    };
    const std::size_t n_blocks = Ring<dim>(0.).shared().n_blocks();
    EXPECT_EQ(n_blocks, Ring<dim>::n_owned * 6);
    // There are two kinds of rows, with other lower neighbors at the ends.
    EXPECT_LE(count(0.), 20 * 6);
    EXPECT_EQ(count(1e-15), count(0.));
    EXPECT_EQ(count(1e-5), n_blocks);
  }



  TYPED_TEST(SharedRowsTest, DiagonalBlocksAndCouplingsWithOthers)
  {
    constexpr int   dim = TypeParam::value;
    const Ring<dim> ring(0.1);
    SharedRows<dim> rows   = ring.shared();
    const auto     &matrix = ring.matrix;
    for (unsigned int i = 0; i < ring.n_owned; ++i)
      {
        NodeBlock<dim> diagonal;
        Tensor<1, dim> others;
        for (auto e = matrix.begin[i]; e < matrix.begin[i + 1]; ++e)
          if (matrix.columns[e] == i)
            diagonal = matrix.values[e];
          else if (matrix.columns[e] >= ring.n_owned)
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                others[c] += std::abs(matrix.values[e][c][d]);
        const auto found = rows.diagonal_block(i);
        EXPECT_NEAR((found.first - diagonal).norm(), 0., 1e-5);
        EXPECT_NEAR((found.second - others).norm(), 0., 1e-5);
      }
    NodeBlock<dim> spring;
    spring[0][1]                = 3.;
    const NodeBlock<dim> before = rows.diagonal_block(4).first;
    rows.set_row_sum(4, rows.row_sum(4) + spring);
    EXPECT_NEAR((rows.diagonal_block(4).first - before - spring).norm(),
                0.,
                1e-5);
  }



  TYPED_TEST(SharedRowsTest, SweepsSolveTriangularSystems)
  {
    // Forward from zero (D + L) x = b; backward (D + U) x = b - L x_old.
    constexpr int   dim = TypeParam::value;
    const Ring<dim> ring(0.1);
    SharedRows<dim> rows = ring.shared();
    for (unsigned int i = 0; i < ring.n_owned; ++i)
      rows.set_inverse_block(i, invert(rows.diagonal_block(i).first));
    std::vector<float> x(ring.n * dim, 7.), b(x.size());
    for (unsigned int i = 0; i < b.size(); ++i)
      b[i] = std::cos(5. * i);
    const auto row_times = [&](const unsigned int        i,
                               const std::vector<float> &lower,
                               const std::vector<float> &upper) {
      Tensor<1, dim> result;
      const auto    &matrix = ring.matrix;
      for (auto e = matrix.begin[i]; e < matrix.begin[i + 1]; ++e)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            result[c] +=
              matrix.values[e][c][d] * (matrix.columns[e] < i ?
                                          lower :
                                          upper)[matrix.columns[e] * dim + d];
      return result;
    };

    rows.smooth_forward_from_zero(x.data(), b.data());
    std::vector<float> diagonal_only(x);
    for (unsigned int i = 0; i < ring.n_owned; ++i)
      {
        std::fill(diagonal_only.begin(), diagonal_only.end(), 0.);
        std::copy_n(x.begin() + i * dim, dim, diagonal_only.begin() + i * dim);
        const Tensor<1, dim> left = row_times(i, x, diagonal_only);
        for (unsigned int c = 0; c < dim; ++c)
          EXPECT_NEAR(left[c], b[i * dim + c], 1e-5);
      }
    EXPECT_EQ(x.back(), 7.) << "of another rank";

    std::fill(x.begin() + ring.n_owned * dim, x.end(), 0.3);
    const std::vector<float> old(x);
    rows.smooth_backward(x.data(), b.data());
    for (unsigned int i = 0; i < ring.n_owned; ++i)
      {
        const Tensor<1, dim> left = row_times(i, old, x);
        for (unsigned int c = 0; c < dim; ++c)
          EXPECT_NEAR(left[c], b[i * dim + c], 1e-5);
      }
  }



  /// Kernels of both kinds agree up to rounding.
  template <int dim>
  void
  check_kernels(const double tolerance)
  {
    using Table = RowTable<dim>;
    // Blocks are at any position: memory is aligned for two doubles only.
    std::vector<PackedBlock<dim>> blocks(9);
    for (unsigned int k = 0; k < blocks.size(); ++k)
      for (unsigned int p = 0; p < blocks[k].n_parts; ++p)
        for (unsigned int e = 0; e < (dim == 2 ? 4 : 3); ++e)
          blocks[k].parts[p][e] = std::sin(11. * k + 3. * p + e);
    const std::vector<typename Table::Row> rows{{0, 0, 0, 3},
                                                {3, 3, 1, 2},
                                                {0, 1, 0, 1}};
    const std::vector<unsigned int>        columns{1, 2, 3, 0, 3};
    const RowKernels<dim>                  fastest = row_kernels<dim>(),
                          portable = portable_row_kernels<dim>();
    for (const unsigned int shift : {0, 1})
      {
        const PackedBlock<dim> *const begin = blocks.data() + shift;
        const Table        A{3, rows.data(), columns.data(), begin, begin + 5};
        std::vector<float> b(4 * dim), x(b), y(b), z(b);
        for (unsigned int i = 0; i < b.size(); ++i)
          b[i] = std::cos(2. * i);
        const auto expect_equal = [&] {
          for (unsigned int i = 0; i < b.size(); ++i)
            EXPECT_NEAR(y[i], z[i], tolerance) << "shift " << shift;
        };
        fastest.residual(A, y.data(), b.data(), x.data());
        portable.residual(A, z.data(), b.data(), x.data());
        expect_equal();
        fastest.smooth_forward_from_zero(A, begin, y.data(), b.data());
        portable.smooth_forward_from_zero(A, begin, z.data(), b.data());
        expect_equal();
        fastest.smooth_backward(A, begin, y.data(), b.data());
        portable.smooth_backward(A, begin, z.data(), b.data());
        expect_equal();
      }
  }



  TYPED_TEST(SharedRowsTest, KernelsOfEveryProcessorAgree)
  {
    constexpr int dim = TypeParam::value;
    check_kernels<dim>(1e-4);
  }
} // namespace
