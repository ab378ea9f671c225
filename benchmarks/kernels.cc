// SPDX-License-Identifier: LGPL-2.1-or-later

// What steps and new meshes are made of, one by one, on the mesh of a scene
// that geometric multigrid solves.
//
//     kernels DIMENSION scene.prm
//
// prints the degrees of freedom and, of each part, its name, seconds (median of
// nine; of three for what is made once a mesh), the bytes that it moves at
// least, and the bytes that it keeps; 0 where that means little. On several
// ranks each number is that of the rank with most, and so are the last lines:
// degrees of freedom, then those of the contact face.

#include <deal.II/base/mpi.h>
#include <deal.II/base/timer.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/discretization/bulk_system.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/mesh/mesh.h>

#include <malloc.h>

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



  /// What is allocated.
  double
  bytes_in_use()
  {
    const auto stats = mallinfo2();
    return stats.uordblks + stats.hblkhd;
  }



  void
  print(const std::string &name,
        const double       seconds,
        const double       moved = 0.,
        const double       kept  = 0.)
  {
    std::vector<double> most{seconds, moved, kept};
    Utilities::MPI::max(most, MPI_COMM_WORLD, most);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::cout << name << ' ' << most[0] << ' ' << most[1] << ' ' << most[2]
                << std::endl;
  }



  /// What is made once a mesh.
  void
  measure_set_up(
    const std::string           &name,
    const std::function<void()> &make,
    const std::function<void()> &forget = [] {})
  {
    const double before  = bytes_in_use();
    const double seconds = median_seconds(3, [&] {
      forget();
      make();
    });
    print(name, seconds, 0., bytes_in_use() - before);
  }



  template <int dim>
  void
  measure(const std::string &file)
  {
    const Parameters                          parameters(file);
    Scene<dim>                                scene(parameters);
    parallel::distributed::Triangulation<dim> triangulation(MPI_COMM_WORLD);
    const double                              before = bytes_in_use();
    make_mesh(parameters.geometry, triangulation);
    scene.inspect(triangulation);
    const FESystem<dim> fe(FE_Q<dim>(1), dim);
    DoFHandler<dim>     dof_handler(triangulation);
    print("mesh", 0., 0., bytes_in_use() - before);

    measure_set_up("numbers", [&] { distribute_nodes(fe, dof_handler); });
    std::unique_ptr<Discretization<dim>> discretization;
    measure_set_up("spaces", [&] {
      discretization =
        std::make_unique<Discretization<dim>>(dof_handler, scene);
    });
    const Discretization<dim> &d = *discretization;
    measure_set_up("matrix", [&] { discretization->assemble_matrix(); });
    std::unique_ptr<GeometricMultigrid<dim>> multigrid;
    measure_set_up(
      "multigrid",
      [&] {
        multigrid = std::make_unique<GeometricMultigrid<dim>>(
          d.matrix,
          d.space.excluded(),
          make_node_hierarchy(d.space),
          std::vector<DistributedVector>(),
          d.face_restriction(),
          typename GeometricMultigrid<dim>::Options());
      },
      [&] { multigrid.reset(); });

    const double      n = dof_handler.n_locally_owned_dofs();
    DistributedVector x = d.space.owned_vector(), y(x);
    for (std::size_t i = 0; i < d.space.excluded().size(); ++i)
      x.begin()[i] = d.space.excluded()[i] ? 0. : 1. + i % 7;
    print("product", median_seconds(9, [&] { d.matrix.vmult(y, x); }));
    print("cycle",
          median_seconds(9, [&] { multigrid->vmult_untruncated(y, x); }));
    print("dofs", n);
    print("face", d.face_restriction().face().n_dofs());
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
