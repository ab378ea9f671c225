// SPDX-License-Identifier: LGPL-2.1-or-later

// The bilinear form: coercivity that does not depend on the mesh, agreement
// with the formula of elasticity, nodal frames and hanging nodes.

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/lac/lapack_full_matrix.h>

#include "body.h"
#include <viscoplastic_contact/discretization/elasticity.h>

#include <cmath>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  // ------------------------------------------------------------ coercivity

  enum class Form
  {
    full,
    mean_dilatation,
    one_point
  };



  /// The unit square in n x n cells, clamped at the top.
  class UnitSquare
  {
  public:
    explicit UnitSquare(const unsigned int n)
      : fe(FE_Q<2>(1), 2)
      , dof_handler(triangulation)
    {
      GridGenerator::subdivided_hyper_cube(triangulation, n);
      distribute_nodes(fe, dof_handler);
      unknown.assign(dof_handler.n_dofs(), numbers::invalid_unsigned_int);
      std::vector<bool> clamped(dof_handler.n_dofs(), false);
      for (const auto &cell : dof_handler.active_cell_iterators())
        for (const unsigned int v : cell->vertex_indices())
          if (cell->vertex(v)[1] > 1. - 1e-10)
            for (unsigned int d = 0; d < 2; ++d)
              clamped[cell->vertex_dof_index(v, d)] = true;
      for (unsigned int i = 0; i < clamped.size(); ++i)
        if (!clamped[i])
          unknown[i] = n_unknowns++;
    }

    LAPACKFullMatrix<double>
    matrix(const Stiffness &stiffness, const Form form) const
    {
      FullMatrix<double> result(n_unknowns, n_unknowns),
        cell_matrix(fe.n_dofs_per_cell(), fe.n_dofs_per_cell());
      FEValues<2>                          fe_values(fe,
                            QGauss<2>(form == Form::one_point ? 1 : 2),
                            update_gradients | update_JxW_values);
      std::vector<types::global_dof_index> dofs(fe.n_dofs_per_cell());
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          fe_values.reinit(cell);
          elastic_cell_matrix(fe_values,
                              stiffness,
                              form == Form::mean_dilatation,
                              cell_matrix);
          cell->get_dof_indices(dofs);
          for (unsigned int i = 0; i < dofs.size(); ++i)
            for (unsigned int j = 0; j < dofs.size(); ++j)
              if (unknown[dofs[i]] != numbers::invalid_unsigned_int &&
                  unknown[dofs[j]] != numbers::invalid_unsigned_int)
                result(unknown[dofs[i]], unknown[dofs[j]]) += cell_matrix(i, j);
        }
      LAPACKFullMatrix<double> lapack(n_unknowns, n_unknowns);
      lapack = result;
      return lapack;
    }

    /// min a(v,v)/b(v,v).
    double
    smallest_eigenvalue(LAPACKFullMatrix<double> a,
                        LAPACKFullMatrix<double> b) const
    {
      Vector<double>              eigenvalues;
      std::vector<Vector<double>> eigenvectors;
      a.compute_generalized_eigenvalues_symmetric(
        b, -1., 1e10, 0., eigenvalues, eigenvectors);
      return eigenvalues[0];
    }

  private:
    Triangulation<2>          triangulation;
    FESystem<2>               fe;
    DoFHandler<2>             dof_handler;
    std::vector<unsigned int> unknown;
    unsigned int              n_unknowns = 0;
  };



  /// E = identity, which makes the form (eps(u), eps(v)).
  const Stiffness strain_product = Stiffness::isotropic(1., 0.);



  TEST(ElasticForm, CoercivityDoesNotDependOnTheMesh)
  {
    const Stiffness stiffness = Stiffness::isotropic(1., 0.3);
    const double    two_mu    = 2. * stiffness.shear_modulus();
    // The one-point rule against the full form, as measured with an
    // independent program.
    const std::map<unsigned int, double> one_point{{4, 0.0124},
                                                   {8, 0.0031},
                                                   {16, 0.00078}};
    for (const auto &[n, known] : one_point)
      {
        const UnitSquare square(n);
        const auto       strains = square.matrix(strain_product, Form::full);
        const auto       full    = square.matrix(stiffness, Form::full);
        EXPECT_GE(square.smallest_eigenvalue(full, strains),
                  two_mu * (1. - 1e-10));
        EXPECT_GE(square.smallest_eigenvalue(
                    square.matrix(stiffness, Form::mean_dilatation), strains),
                  0.515);
        EXPECT_NEAR(square.smallest_eigenvalue(
                      square.matrix(stiffness, Form::one_point), full),
                    known,
                    0.01 * known);
      }
  }



  TEST(ElasticForm, MeanDilatationStaysCoerciveTowardsIncompressibility)
  {
    for (const unsigned int n : {4, 8})
      {
        const UnitSquare square(n);
        const auto       strains = square.matrix(strain_product, Form::full);
        for (const double nu : {0.3, 0.49, 0.4999, 0.49999})
          {
            const double constant =
              square.smallest_eigenvalue(square.matrix(Stiffness::isotropic(1.,
                                                                            nu),
                                                       Form::mean_dilatation),
                                         strains);
            EXPECT_GT(constant, 0.515) << "nu = " << nu << ", n = " << n;
            EXPECT_LT(constant, 0.62) << "nu = " << nu << ", n = " << n;
          }
      }
  }



  // ------------------------------------------------------------ the matrix

  template <typename Dimension>
  class ElasticMatrix : public testing::Test
  {};
  TYPED_TEST_SUITE(ElasticMatrix, Dimensions, );



  /// One affine cell: a skew parallelepiped.
  template <int dim>
  void
  make_parallelepiped(Triangulation<dim> &triangulation)
  {
    Point<dim> corners[dim];
    for (unsigned int d = 0; d < dim; ++d)
      {
        corners[d][d]             = 1. + 0.3 * d;
        corners[d][(d + 1) % dim] = 0.4 - 0.2 * d;
      }
    GridGenerator::parallelepiped(triangulation, corners);
  }



  TYPED_TEST(ElasticMatrix, ThreeDimensionalFormulaOnAnAffineCell)
  {
    constexpr int      dim = TypeParam::value;
    Triangulation<dim> triangulation;
    make_parallelepiped(triangulation);
    const FESystem<dim> fe(FE_Q<dim>(1), dim);
    const double        E = 2.5, nu = 0.37;
    const double        mu     = E / (2. * (1. + nu));
    const double        lambda = E * nu / ((1. + nu) * (1. - 2. * nu));

    const UpdateFlags  flags = update_gradients | update_JxW_values;
    FEValues<dim>      ours(fe, QGauss<dim>(2), flags);
    FEValues<dim>      more(fe, QGauss<dim>(4), flags);
    const unsigned int n = fe.n_dofs_per_cell();
    FullMatrix<double> matrix(n, n), mean(n, n);
    ours.reinit(triangulation.begin_active());
    more.reinit(triangulation.begin_active());
    elastic_cell_matrix(ours, Stiffness::isotropic(E, nu), false, matrix);
    elastic_cell_matrix(ours, Stiffness::isotropic(E, nu), true, mean);

    // Mean dilatation replaces K div div by the product of cell means.
    const double        bulk   = lambda + 2. / 3. * mu;
    double              volume = 0.;
    std::vector<double> divergence(n, 0.);
    for (const unsigned int q : more.quadrature_point_indices())
      {
        volume += more.JxW(q);
        for (unsigned int i = 0; i < n; ++i)
          divergence[i] += more.shape_grad(i, q)[i % dim] * more.JxW(q);
      }
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        {
          double form = 0., product = 0.;
          for (const unsigned int q : more.quadrature_point_indices())
            {
              // mu (grad u : grad v + grad u : grad v^T) + lambda div div
              const unsigned int   ci = i % dim, cj = j % dim;
              const Tensor<1, dim> gi = more.shape_grad(i, q);
              const Tensor<1, dim> gj = more.shape_grad(j, q);
              form += (mu * ((ci == cj ? gi * gj : 0.) + gi[cj] * gj[ci]) +
                       lambda * gi[ci] * gj[cj]) *
                      more.JxW(q);
              product += gi[ci] * gj[cj] * more.JxW(q);
            }
          EXPECT_NEAR(matrix(i, j), form, 1e-13);
          EXPECT_NEAR(mean(i, j),
                      form + bulk * (divergence[i] * divergence[j] / volume -
                                     product),
                      1e-12);
          EXPECT_EQ(matrix(i, j), matrix(j, i));
          EXPECT_EQ(mean(i, j), mean(j, i));
        }

    // Rigid motions have no energy, homogeneous strain |K|/2 E eps : eps.
    Vector<double> rotation(n), stretch(n);
    const auto     cell = triangulation.begin_active();
    for (unsigned int i = 0; i < n; ++i)
      {
        const Point<dim> x = cell->vertex(i / dim);
        if (i % dim == 0)
          rotation[i] = 1. - x[1];
        else if (i % dim == 1)
          rotation[i] = x[0];
        if (i % dim == 0)
          stretch[i] = x[0] + 0.5 * x[1];
      }
    for (const auto *a : {&matrix, &mean})
      {
        EXPECT_NEAR(a->matrix_norm_square(rotation), 0., 1e-13);
        EXPECT_NEAR(a->matrix_norm_square(stretch),
                    volume * (2. * mu * (1. + 2. * 0.0625) + lambda),
                    1e-12);
      }
  }



  /// A rotated box with contact and symmetry planes and hanging nodes on them.
  template <int dim>
  std::unique_ptr<Body<dim>>
  oblique_body(const bool mean_dilatation)
  {
    std::string text =
      box<dim>(2, oblique<dim>()) +
      subsection("Material", "set Young's modulus = 2 + x*y") +
      boundary(0, "set Role = clamped") + boundary(1, "set Role = free") +
      boundary(2,
               "set Role = contact\nset Friction law = tresca\n"
               "set Friction bound = 1") +
      boundary(3, "set Role = free");
    if (dim == 3)
      text +=
        boundary(4, "set Role = symmetry") + boundary(5, "set Role = free");
    auto body = std::make_unique<Body<dim>>(text, true, mean_dilatation);
    const Point<dim> marked = body->triangulation.begin(0)->vertex(0);
    body->refine_where([&marked](const Point<dim> &x) {
      return (x - marked).norm() > 0.9 && (x - marked).norm() < 1.5;
    });
    body->set_up();
    return body;
  }



  TYPED_TEST(ElasticMatrix, EnergyInFramesWithHangingNodes)
  {
    constexpr int dim = TypeParam::value;
    for (const bool mean_dilatation : {false, true})
      {
        const auto body = oblique_body<dim>(mean_dilatation);
        EXPECT_GT(Utilities::MPI::sum(
                    body->space->cartesian_hanging_nodes().n_constraints(),
                    MPI_COMM_WORLD),
                  0u);
        DistributedMatrix matrix;
        assemble_elastic_matrix(*body->space,
                                *body->moduli,
                                mean_dilatation,
                                matrix);
        EXPECT_TRUE(matrix.m() == body->dof_handler.n_dofs());

        const DistributedVector u  = body->rough_vector(0.3),
                                v  = body->rough_vector(1.7);
        DistributedVector u_frames = body->space->owned_vector(),
                          v_frames = u_frames, product = u_frames;
        body->space->to_frames(u, u_frames);
        body->space->to_frames(v, v_frames);
        matrix.vmult(product, u_frames);
        const double form = product * v_frames;

        // The same form from samples of stress and strain, cell by cell.
        std::vector<SymmetricTensor<2, 3>> strain(
          body->stress_space->n_samples);
        std::vector<SymmetricTensor<2, 3>> other(body->stress_space->n_samples);
        double                             expected = 0.;
        for (std::size_t c = 0; c < body->stress_space->n_cells(); ++c)
          {
            body->stress_space->strains(c, u.begin(), strain.data());
            body->stress_space->strains(c, v.begin(), other.data());
            for (unsigned int s = 0; s < strain.size(); ++s)
              expected += body->stress_space->weight(c, s) *
                          ((*body->moduli)(c).stress(strain[s]) * other[s]);
          }
        expected = Utilities::MPI::sum(expected, MPI_COMM_WORLD);
        EXPECT_NEAR(form, expected, 1e-11 * std::abs(expected));

        matrix.vmult(product, v_frames);
        EXPECT_NEAR(form, product * u_frames, 1e-11 * std::abs(expected));
      }
  }



  TYPED_TEST(ElasticMatrix, VirtualWorkIsTheTransposeOfStrain)
  {
    constexpr int dim = TypeParam::value;
    for (const bool mean_dilatation : {false, true})
      {
        const auto body = oblique_body<dim>(mean_dilatation);
        // (z, eps(v)) for z = E eps(u) is a(u, v).
        const DistributedVector u = body->rough_vector(0.3);
        IrreversibleStress      z(body->stress_space->n_cells() *
                             body->stress_space->n_samples);
        for (std::size_t c = 0; c < body->stress_space->n_cells(); ++c)
          {
            auto *samples = &z[c * body->stress_space->n_samples];
            body->stress_space->strains(c, u.begin(), samples);
            for (unsigned int s = 0; s < body->stress_space->n_samples; ++s)
              samples[s] = (*body->moduli)(c).stress(samples[s]);
          }
        DistributedVector work = body->space->owned_vector();
        add_irreversible_load(*body->stress_space, z, work);

        DistributedMatrix matrix;
        assemble_elastic_matrix(*body->space,
                                *body->moduli,
                                mean_dilatation,
                                matrix);
        DistributedVector u_frames = body->space->owned_vector(),
                          product  = u_frames;
        body->space->to_frames(u, u_frames);
        matrix.vmult(product, u_frames);
        const double size = product.linfty_norm();
        work += product; // the load of z is minus (z, eps(v))
        // Rows of hanging nodes are empty in the load and meaningless in the
        // matrix.
        body->set_excluded_to_zero(work);
        EXPECT_LT(work.linfty_norm(), 1e-12 * size);
      }
  }


  /// Assemble the matrix from cell matrices each computed separately.
  template <int dim>
  void
  assemble_one_by_one(const Body<dim> &body, DistributedMatrix &matrix)
  {
    const AdmissibleSpace<dim> &space = *body.space;
    const unsigned int          n     = body.fe.n_dofs_per_cell();
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      {
        FullMatrix<double>                   cell_matrix(n, n);
        std::vector<types::global_dof_index> dofs(n);
        FEValues<dim>                        fe_values(body.fe,
                                QGauss<dim>(2),
                                update_gradients | update_JxW_values);
        fe_values.reinit(space.cells[c]);
        elastic_cell_matrix(fe_values, (*body.moduli)(c), false, cell_matrix);
        space.cells[c]->get_dof_indices(dofs);
        space.add_cell_matrix(dofs, cell_matrix, matrix);
      }
    matrix.compress();
  }



  TYPED_TEST(ElasticMatrix, IsTheSumOfCellMatrices)
  {
    // Cells on the left are translates of each other, those on the right are
    // not, and some are refined; the modulus is constant or varies.
    constexpr int dim = TypeParam::value;
    for (const std::string material : {"", "set Young's modulus = 2 + x"})
      {
        Body<dim> body(box_with<dim>("set Role = clamped\n") +
                       subsection("Material", material));
        GridTools::transform(
          [](Point<dim> x) {
            if (x[0] > 1.1 && x[0] < 1.9)
              x[0] += 0.05 * std::sin(5. * x[1] + 9. * x[dim - 1]);
            return x;
          },
          body.triangulation);
        body.refine_where([](const Point<dim> &x) { return x[1] > 0.5; });
        body.set_up();
        DistributedMatrix matrix, expected;
        assemble_elastic_matrix(*body.space, *body.moduli, false, matrix);
        body.space->reinit(expected);
        assemble_one_by_one(body, expected);
        for (const auto row : body.space->owned)
          {
            const double size = expected.el(row, row);
            for (unsigned int j = 0; j < matrix.m(); ++j)
              EXPECT_NEAR(matrix.el(row, j), expected.el(row, j), 1e-13 * size);
          }
      }
  }
} // namespace
