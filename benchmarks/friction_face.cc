// SPDX-License-Identifier: LGPL-2.1-or-later

// What the friction face costs by itself: memory, a forward and backward
// nonlinear Gauss-Seidel sweep, and what an iteration of the active set does
// besides (multipliers, certificate, truncation). The face is a square grid of
// nodes, each coupled with those around it as in elasticity, in one stripe a
// rank; its load makes about half of it slip.
//
//     friction_face N        with N x N points
//
// prints points, ranks, megabytes of the rank with most, seconds of the sweeps,
// seconds of the rest.

#include <deal.II/base/mpi.h>
#include <deal.II/base/timer.h>

#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/sparse_face_matrix.h>

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <string>

using namespace Viscoplastic;

namespace
{
  /// Nodes [begin, end) of an n x n grid.
  ContactLayout
  make_face(const unsigned int begin, const unsigned int end)
  {
    ContactLayout face;
    face.communicator = MPI_COMM_WORLD;
    for (unsigned int node = 0; node < end - begin; ++node)
      {
        ContactLayout::Point point{node, 2, {}};
        point.map[0][0] = point.map[1][1] = 1.;
        face.points.push_back(point);
        face.first_dof.push_back(2 * (node + 1));
        face.first_point.push_back(node + 1);
      }
    return face;
  }



  std::vector<SparseFaceMatrix::Entry>
  couplings(const unsigned int n,
            const unsigned int begin,
            const unsigned int end)
  {
    std::vector<SparseFaceMatrix::Entry> entries;
    for (unsigned int node = begin; node < end; ++node)
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
          {
            const int x = node % n + dx, y = node / n + dy;
            if (x < 0 || y < 0 || x >= int(n) || y >= int(n))
              continue;
            const bool is_diagonal = dx == 0 && dy == 0;
            for (unsigned int i = 0; i < 2; ++i)
              for (unsigned int j = 0; j < 2; ++j)
                entries.push_back(
                  {2 * (node - begin) + i,
                   2 * (y * types::global_dof_index(n) + x) + j,
                   i == j ? (is_diagonal ? 9. : -1.) : -0.1 * dx * dy});
          }
    return entries;
  }



  double
  median_seconds(const std::function<void()> &act)
  {
    std::vector<double> seconds;
    for (unsigned int i = 0; i < 9; ++i)
      {
        MPI_Barrier(MPI_COMM_WORLD);
        Timer timer(MPI_COMM_WORLD, /* sync_lap_times = */ true);
        act();
        timer.stop();
        seconds.push_back(timer.wall_time());
      }
    std::nth_element(seconds.begin(), seconds.begin() + 4, seconds.end());
    return seconds[4];
  }



  double
  megabytes()
  {
    // What is allocated; the process may have kept more from what is not.
    const auto stats = mallinfo2();
    return 1e-6 * (stats.uordblks + stats.hblkhd);
  }
} // namespace



int
main(int argc, char **argv)
{
  const Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const unsigned int n       = argc > 1 ? std::stoul(argv[1]) : 316;
  const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  const unsigned int rank    = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  const unsigned int begin   = n * (n * rank / n_ranks),
                     end     = n * (n * (rank + 1) / n_ranks);

  const double        memory_before = megabytes();
  const ContactLayout face          = make_face(begin, end);
  IndexSet            numbers(2 * types::global_dof_index(n) * n);
  numbers.add_range(2 * types::global_dof_index(begin),
                    2 * types::global_dof_index(end));
  const SparseFaceMatrix    matrix(face, numbers, couplings(n, begin, end));
  ContactState              state(std::vector<double>(end - begin, 0.5));
  std::vector<Tensor<2, 3>> diagonal, inverse_diagonal;
  for (unsigned int node = 0; node < face.n_nodes(); ++node)
    {
      diagonal.push_back(matrix.diagonal_block(node));
      inverse_diagonal.push_back(invert(diagonal.back()));
    }
  Vector<double> x(face.n_dofs()), residual(x), change(x), force(x);
  for (unsigned int k = 0; k < face.n_dofs(); ++k)
    residual[k] = std::sin(1e-3 * (2 * begin + k));
  FaceTruncation truncation = make_truncation(face, state, inverse_diagonal);
  const double   memory     = megabytes() - memory_before;

  const auto relax_stage = [&](const unsigned int s, const bool backward) {
    std::vector<unsigned int> nodes = matrix.stages()[s];
    if (backward)
      std::reverse(nodes.begin(), nodes.end());
    change = 0.;
    for (const unsigned int node : nodes)
      {
        const Tensor<1, 3> old = face.node_values(x, node);
        const Tensor<1, 3> now =
          relax_node(face,
                     node,
                     inverse_diagonal[node],
                     face.node_values(residual, node) + diagonal[node] * old,
                     state);
        face.set_node_values(now, node, x);
        face.set_node_values(now - old, node, change);
        matrix.subtract(node, now - old, residual);
      }
    matrix.subtract_changes_elsewhere(s, change, residual);
  };
  const double sweeps = median_seconds([&] {
    for (unsigned int s = 0; s < matrix.stages().size(); ++s)
      relax_stage(s, false);
    for (unsigned int s = matrix.stages().size(); s-- > 0;)
      relax_stage(s, true);
  });
  for (unsigned int p = 0; p < state.n_points(); ++p)
    if (!state.sticks[p])
      state.slip[p] = slip(face.points[p], face.node_values(x, p));
  const double rest = median_seconds([&] {
    fit_multipliers(face, residual, state, force);
    truncation = make_truncation(face, state, inverse_diagonal);
    certify(face, residual, diagonal, state, force, 0.);
  });

  const double most = Utilities::MPI::max(memory, MPI_COMM_WORLD);
  if (rank == 0)
    std::cout << n * n << ' ' << n_ranks << ' ' << most << ' ' << sweeps << ' '
              << rest << std::endl;
  return 0;
}
