// SPDX-License-Identifier: LGPL-2.1-or-later

// What steps and new meshes are made of, one by one, on the mesh of a scene
// that geometric multigrid solves.
//
//     kernels DIMENSION scene.prm
//
// prints the degrees of freedom and, of each part, its name, seconds (median of
// nine; of three for what is made once a mesh) and megabytes that it moves at
// least, 0 where that means little.

#include <deal.II/base/mpi.h>
#include <deal.II/base/timer.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/discretization/bulk_system.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/mesh/mesh.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <string>

using namespace Viscoplastic;

namespace
{
  double
  median_seconds(const unsigned int n, const std::function<void()> &act)
  {
    std::vector<double> seconds;
    for (unsigned int i = 0; i < n; ++i)
      {
        Timer timer;
        act();
        timer.stop();
        seconds.push_back(timer.wall_time());
      }
    std::nth_element(seconds.begin(), seconds.begin() + n / 2, seconds.end());
    return seconds[n / 2];
  }



  void
  print(const std::string &name, const double seconds, const double bytes = 0.)
  {
    std::cout << name << ' ' << seconds << ' ' << 1e-6 * bytes << std::endl;
  }



  template <int dim>
  void
  measure(const std::string &file)
  {
    const Parameters                          parameters(file);
    Scene<dim>                                scene(parameters);
    parallel::distributed::Triangulation<dim> triangulation(MPI_COMM_WORLD);
    make_mesh(parameters.geometry, triangulation);
    scene.inspect(triangulation);
    const FESystem<dim> fe(FE_Q<dim>(1), dim);
    DoFHandler<dim>     dof_handler(triangulation);

    print("numbers",
          median_seconds(3, [&] { distribute_nodes(fe, dof_handler); }));
    std::unique_ptr<Discretization<dim>> discretization;
    print("spaces", median_seconds(3, [&] {
            discretization =
              std::make_unique<Discretization<dim>>(dof_handler, scene);
          }));
    const Discretization<dim> &d = *discretization;
    print("matrix",
          median_seconds(3, [&] { discretization->assemble_matrix(); }));
    std::unique_ptr<GeometricMultigrid<dim>> multigrid;
    print("multigrid", median_seconds(3, [&] {
            multigrid.reset();
            multigrid = std::make_unique<GeometricMultigrid<dim>>(
              d.matrix,
              d.space.excluded(),
              make_node_hierarchy(d.space),
              std::vector<DistributedVector>(),
              d.face_restriction(),
              typename GeometricMultigrid<dim>::Options());
          }));

    const double      n = dof_handler.n_dofs();
    DistributedVector x = d.space.owned_vector(), y(x);
    for (std::size_t i = 0; i < d.space.excluded().size(); ++i)
      x.begin()[i] = d.space.excluded()[i] ? 0. : 1. + i % 7;
    print("product",
          median_seconds(9, [&] { d.matrix.vmult(y, x); }),
          12. * d.matrix.n_nonzero_elements() + 16. * n);
    if (multigrid->vmult_matrix(y, x))
      print("shared",
            median_seconds(9, [&] { multigrid->vmult_matrix(y, x); }));
    print("cycle",
          median_seconds(9, [&] { multigrid->vmult_untruncated(y, x); }));
    std::cout << "dofs " << n << " 0" << std::endl;
  }
} // namespace



int
main(int argc, char **argv)
{
  const Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  if (argc != 3)
    {
      std::cerr << "Usage: kernels DIMENSION scene.prm" << std::endl;
      return 2;
    }
  if (std::string(argv[1]) == "2")
    measure<2>(argv[2]);
  else
    measure<3>(argv[2]);
  return 0;
}
