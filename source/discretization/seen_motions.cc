// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/discretization/seen_motions.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numeric>
#include <sstream>

namespace Viscoplastic
{
  void
  SeenMotions::add(RigidMotion row)
  {
    for (unsigned int i = 0; i < n; ++i)
      {
        const double length = std::hypot(triangle(i, i), row[i]);
        if (row[i] == 0.)
          continue;
        const double c = triangle(i, i) / length, s = row[i] / length;
        for (unsigned int j = i; j < n; ++j)
          {
            const double above = triangle(i, j);
            triangle(i, j)     = c * above + s * row[j];
            row[j]             = c * row[j] - s * above;
          }
      }
  }



  void
  SeenMotions::join(const MPI_Comm communicator)
  {
    std::vector<double> entries;
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        entries.push_back(triangle(i, j));
    triangle = 0.;
    for (const auto &of_rank :
         Utilities::MPI::all_gather(communicator, entries))
      for (unsigned int i = 0; i < n; ++i)
        {
          RigidMotion row(n);
          for (unsigned int j = 0; j < n; ++j)
            row[j] = of_rank[i * n + j];
          add(row);
        }
  }



  std::vector<RigidMotion>
  SeenMotions::unseen() const
  {
    LAPACKFullMatrix<double> matrix(n, n);
    matrix = triangle;
    matrix.compute_svd();
    const auto              &vt = matrix.get_svd_vt();
    std::vector<RigidMotion> result;
    for (unsigned int e = 0; e < n; ++e)
      if (matrix.singular_value(e) <=
          1e-9 * std::max(matrix.singular_value(0), 1e-300))
        {
          RigidMotion motion(n);
          for (unsigned int a = 0; a < n; ++a)
            motion[a] = vt(e, a);
          result.push_back(motion);
        }
    return result;
  }



  template <int dim>
  std::string
  in_words(std::vector<RigidMotion> motions)
  {
    constexpr unsigned int n = n_rigid_motions<dim>;
    for (RigidMotion &motion : motions)
      {
        RigidMotion most;
        double      largest = -1.;
        for (auto part = motion.begin(); part != motion.end(); part += n)
          if (const double square =
                std::inner_product(part, part + n, part, 0.);
              square > largest + 1e-8)
            {
              largest = square;
              most.assign(part, part + n);
            }
        motion = most;
      }
    const auto is_translation = [](const RigidMotion &motion) {
      for (unsigned int a = dim; a < n; ++a)
        if (std::abs(motion[a]) > 1e-8)
          return false;
      return true;
    };
    const auto n_translations =
      std::count_if(motions.begin(), motions.end(), is_translation);
    std::string result;
    for (const RigidMotion &motion : motions)
      {
        // The largest component gives the motion its name.
        unsigned int largest = 0;
        for (unsigned int a = 1; a < n; ++a)
          if (std::abs(motion[a]) > std::abs(motion[largest]) + 1e-8)
            largest = a;
        const std::string xyz = "xyz";
        result += result.empty() ? "" : " and ";
        // A single translation may have any direction; of several, the
        // axes are a basis.
        if (n_translations == 1 && is_translation(motion) &&
            std::abs(motion[largest]) < 1. - 1e-8)
          {
            std::ostringstream direction;
            direction << std::setprecision(3) << "translation along (";
            const double sign = motion[largest] > 0. ? 1. : -1.;
            for (unsigned int a = 0; a < dim; ++a)
              direction << (a == 0 ? "" : ", ") << sign * motion[a];
            result += direction.str() + ')';
          }
        else if (largest < dim)
          result += std::string("translation along ") + xyz[largest];
        else
          result += std::string("rotation about ") +
                    (dim == 2 ? 'z' : xyz[largest - dim]);
      }
    return result;
  }



  template <int dim>
  std::array<Tensor<1, dim>, n_rigid_motions<dim>>
  rigid_displacements(const Tensor<1, dim> &x)
  {
    std::array<Tensor<1, dim>, n_rigid_motions<dim>> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d][d] = 1.;
    if constexpr (dim == 2)
      {
        result[2][0] = -x[1];
        result[2][1] = x[0];
      }
    else
      for (unsigned int d = 0; d < dim; ++d)
        result[dim + d] = cross_product_3d(Point<dim>::unit_vector(d), x);
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(in_words);
  VISCOPLASTIC_INSTANTIATE(rigid_displacements);
} // namespace Viscoplastic
