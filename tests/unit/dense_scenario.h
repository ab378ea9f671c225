// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The system of a bulk in dense algebra, to compare solvers with.

#include <deal.II/lac/lapack_full_matrix.h>

#include "bulk_scenario.h"

namespace Viscoplastic::Testing
{
  /// Matrix and load of a scenario as dense algebra, whole on all ranks.
  struct Dense
  {
    template <int dim>
    explicit Dense(const BulkScenario<dim> &scenario)
      : restriction(scenario.face->restriction())
    {
      for (const auto &part :
           Utilities::MPI::all_gather(MPI_COMM_WORLD, restriction.dofs()))
        face_dofs.insert(face_dofs.end(), part.begin(), part.end());
      const unsigned int  n = scenario.dof_handler.n_dofs();
      std::vector<double> entries(n * n, 0.);
      std::vector<double> is_unknown(n, 0.);
      for (const auto i : scenario.space->owned)
        {
          for (unsigned int j = 0; j < n; ++j)
            entries[i * n + j] = scenario.matrix.el(i, j);
          if (!scenario.space
                 ->excluded()[scenario.space->owned.index_within_set(i)])
            is_unknown[i] = 1.;
        }
      Utilities::MPI::sum(entries, MPI_COMM_WORLD, entries);
      Utilities::MPI::sum(is_unknown, MPI_COMM_WORLD, is_unknown);
      K.reinit(n, n);
      for (unsigned int i = 0; i < n; ++i)
        {
          for (unsigned int j = 0; j < n; ++j)
            K(i, j) = entries[i * n + j];
          if (is_unknown[i] == 1.)
            unknowns.push_back(i);
        }
      load  = gather(scenario.load);
      start = gather(scenario.start);
    }

    Vector<double>
    gather(const DistributedVector &v) const
    {
      std::vector<double> result(v.size(), 0.);
      for (const auto i : v.locally_owned_elements())
        result[i] = v(i);
      Utilities::MPI::sum(result, MPI_COMM_WORLD, result);
      return Vector<double>(result.begin(), result.end());
    }

    /// Solve A x = b on the unknowns, x = 0 elsewhere. A is K plus @p more on
    /// the face, restricted by @p projector P: P A P + (I - P).
    Vector<double>
    solve(const Vector<double>     &b,
          const FullMatrix<double> &projector,
          const FullMatrix<double> &more) const
    {
      const unsigned int n = unknowns.size(), m = face_dofs.size();
      FullMatrix<double> A(n, n), P(n, n), PA(n, n), PAP(n, n);
      std::vector<int>   on_face(K.m(), -1);
      for (unsigned int k = 0; k < m; ++k)
        on_face[face_dofs[k]] = k;
      Vector<double> right_side(n), x(n), result(K.m());
      for (unsigned int i = 0; i < n; ++i)
        {
          right_side[i] = b[unknowns[i]];
          for (unsigned int j = 0; j < n; ++j)
            {
              const int a = on_face[unknowns[i]], c = on_face[unknowns[j]];
              A(i, j) = K(unknowns[i], unknowns[j]);
              P(i, j) = i == j ? 1. : 0.;
              if (a >= 0 && c >= 0)
                {
                  A(i, j) += more(a, c);
                  P(i, j) = projector(a, c);
                }
            }
        }
      P.mmult(PA, A);
      PA.mmult(PAP, P);
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          PAP(i, j) += (i == j ? 1. : 0.) - P(i, j);
      P.vmult(x, right_side);
      LAPACKFullMatrix<double> lapack(n, n);
      lapack = PAP;
      lapack.compute_lu_factorization();
      lapack.solve(x);
      P.vmult(right_side, x);
      for (unsigned int i = 0; i < n; ++i)
        result[unknowns[i]] = right_side[i];
      return result;
    }

    Vector<double>
    solve(const Vector<double> &b) const
    {
      const unsigned int m = face_dofs.size();
      return solve(b,
                   FullMatrix<double>(IdentityMatrix(m)),
                   FullMatrix<double>(m, m));
    }

    /// load - K u on the unknowns.
    Vector<double>
    residual(const Vector<double> &u) const
    {
      Vector<double> r(K.m()), result(K.m());
      K.residual(r, u, load);
      for (const unsigned int i : unknowns)
        result[i] = r[i];
      return result;
    }

    /// The entries of this rank's part of the face.
    Vector<double>
    on_face(const Vector<double> &u) const
    {
      Vector<double> result(restriction.dofs().size());
      for (unsigned int k = 0; k < result.size(); ++k)
        result[k] = u[restriction.dofs()[k]];
      return result;
    }

    Vector<double>
    from_face(const Vector<double> &c) const
    {
      std::vector<double> result(K.m(), 0.);
      for (unsigned int k = 0; k < c.size(); ++k)
        result[restriction.dofs()[k]] = c[k];
      Utilities::MPI::sum(result, MPI_COMM_WORLD, result);
      return Vector<double>(result.begin(), result.end());
    }

    /// The matrix with these blocks of nodes, on the whole face.
    FullMatrix<double>
    from_blocks(const std::vector<Tensor<2, 3>> &blocks) const
    {
      const ContactLayout &face = restriction.face();
      FullMatrix<double>   result(face_dofs.size(), face_dofs.size());
      for (unsigned int node = 0; node < face.n_nodes(); ++node)
        for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
          for (unsigned int j = 0; j < face.n_node_dofs(node); ++j)
            {
              const unsigned int first =
                restriction.global_numbers().nth_index_in_set(
                  face.first_dof[node]);
              result(first + i, first + j) = blocks[node][i][j];
            }
      Utilities::MPI::sum(result, MPI_COMM_WORLD, result);
      return result;
    }

    const FaceRestriction               &restriction;
    std::vector<types::global_dof_index> face_dofs; // of all ranks
    FullMatrix<double>                   K;
    std::vector<unsigned int>            unknowns;
    Vector<double>                       load, start;
  };
} // namespace Viscoplastic::Testing
