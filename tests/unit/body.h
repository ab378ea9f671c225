// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Common parts of unit tests: scenes made from texts, with their meshes, and
// messages of errors.

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/lac/full_matrix.h>

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/elasticity.h>
#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/loads.h>
#include <viscoplastic_contact/discretization/stress_space.h>
#include <viscoplastic_contact/mesh/mesh.h>

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace Viscoplastic::Testing
{
  /// Read parameters from a text, by a separate file on each rank.
  inline std::unique_ptr<Parameters>
  read_parameters(const std::string &text)
  {
    const std::string file = std::filesystem::temp_directory_path() /
                             ("unit_" + std::to_string(getpid()) + ".prm");
    std::ofstream(file) << text;
    struct Remover
    {
      std::string file;
      ~Remover()
      {
        std::remove(file.c_str());
      }
    } const remover{file};
    return std::make_unique<Parameters>(file);
  }



  inline std::string
  subsection(const std::string &name, const std::string &entries)
  {
    return "subsection " + name + "\n" + entries + "\nend\n";
  }



  inline std::string
  boundary(const unsigned int id, const std::string &entries)
  {
    return subsection("Boundary " + std::to_string(id), entries);
  }



  inline std::string
  geometry(const std::string &generator,
           const std::string &arguments,
           const std::string &more = "")
  {
    return subsection("Geometry",
                      "set Generator = " + generator +
                        "\nset Arguments = " + arguments + "\n" + more);
  }



  /// (0,2) x (0,1)^(dim-1) in 2n x n (x n) cells.
  template <int dim>
  std::string
  box(const unsigned int n, const std::string &more = "")
  {
    const std::string m = std::to_string(n);
    return geometry("subdivided_hyper_rectangle",
                    std::to_string(2 * n) + ", " + m +
                      (dim == 2 ? " : 0, 0 : 2, 1 : true" :
                                  ", " + m + " : 0, 0, 0 : 2, 1, 1 : true"),
                    more);
  }



  /// The box in 4 x 2 (x 2) cells, all of whose faces have one role.
  template <int dim>
  std::string
  box_with(const std::string &entries)
  {
    std::string text = box<dim>(2);
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id, entries);
    return text;
  }



  /// A rotation after which no face is along an axis.
  template <int dim>
  std::string
  oblique()
  {
    return dim == 2 ? "set Rotation angle = 30" :
                      "set Rotation angle = 40\n"
                      "set Rotation axis = 1, 2, -0.5";
  }



  /// A scene with its mesh and all objects that depend on the mesh.
  template <int dim>
  struct Body
  {
    explicit Body(const std::string &text,
                  const bool         at_quadrature_points = false,
                  const bool         mean_dilatation      = false)
      : parameters(read_parameters("set Dimension = " + std::to_string(dim) +
                                   "\n" + text))
      , scene(*parameters)
      , triangulation(MPI_COMM_WORLD)
      , fe(FE_Q<dim>(1), dim)
      , dof_handler(triangulation)
      , at_quadrature_points(at_quadrature_points)
      , mean_dilatation(mean_dilatation)
    {
      make_mesh(parameters->geometry, triangulation);
    }

    void
    refine_where(const std::function<bool(const Point<dim> &)> &condition)
    {
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned() && condition(cell->center()))
          cell->set_refine_flag();
      triangulation.execute_coarsening_and_refinement();
    }

    /// Set up all that depends on the mesh, also after a change of it.
    void
    set_up()
    {
      face.reset();
      loads.reset();
      laws.reset();
      stress_space.reset();
      scene.inspect(triangulation);
      distribute_nodes(fe, dof_handler);
      space        = std::make_unique<AdmissibleSpace<dim>>(dof_handler, scene);
      moduli       = std::make_unique<ElasticModuli<dim>>(*space);
      stress_space = std::make_unique<StressSpace<dim>>(*space,
                                                        *moduli,
                                                        at_quadrature_points,
                                                        mean_dilatation);
      laws         = std::make_unique<FlowLaws<dim>>(*stress_space);
      loads        = std::make_unique<Loads<dim>>(*space);
      if (scene.has_contact_points())
        face = std::make_unique<ContactFace<dim>>(*space);
    }

    /// Nodal values of a field: Cartesian, with ghosts.
    DistributedVector
    interpolate(
      const std::function<Tensor<1, dim>(const Point<dim> &)> &field) const
    {
      DistributedVector values  = space->owned_vector(),
                        ghosted = space->ghosted_vector();
      for (const auto &cell : dof_handler.active_cell_iterators())
        if (cell->is_locally_owned())
          for (const unsigned int v : cell->vertex_indices())
            {
              const auto dof = cell->vertex_dof_index(v, 0);
              if (space->owned.is_element(dof))
                for (unsigned int d = 0; d < dim; ++d)
                  values.begin()[space->owned.index_within_set(dof) + d] =
                    field(cell->vertex(v))[d];
            }
      space->distribute_hanging_nodes(values);
      ghosted = values;
      return ghosted;
    }

    /// A field without structure, the same on any number of ranks.
    DistributedVector
    rough_vector(const double phase = 0.) const
    {
      return interpolate([phase](const Point<dim> &x) {
        Tensor<1, dim> u;
        for (unsigned int d = 0; d < dim; ++d)
          u[d] = std::sin(phase + 37. * x[0] + 53. * (d + 1.) * x[1] +
                          71. * x[dim - 1] + d);
        return u;
      });
    }

    /// rough_vector() in nodal frames, zero at excluded components.
    DistributedVector
    rough_unknowns(const double phase = 0.) const
    {
      DistributedVector result = space->owned_vector();
      space->to_frames(rough_vector(phase), result);
      set_excluded_to_zero(result);
      return result;
    }

    void
    set_excluded_to_zero(DistributedVector &in_frames) const
    {
      for (std::size_t i = 0; i < space->excluded().size(); ++i)
        if (space->excluded()[i])
          in_frames.begin()[i] = 0.;
    }

    std::unique_ptr<Parameters>               parameters;
    Scene<dim>                                scene;
    parallel::distributed::Triangulation<dim> triangulation;
    FESystem<dim>                             fe;
    DoFHandler<dim>                           dof_handler;
    const bool                            at_quadrature_points, mean_dilatation;
    std::unique_ptr<AdmissibleSpace<dim>> space;
    std::unique_ptr<ElasticModuli<dim>>   moduli;
    std::unique_ptr<StressSpace<dim>>     stress_space;
    std::unique_ptr<FlowLaws<dim>>        laws;
    std::unique_ptr<Loads<dim>>           loads;
    std::unique_ptr<ContactFace<dim>>     face;
  };



  /// The dimensions for typed suites.
  struct Dim2
  {
    static constexpr int value = 2;
  };
  struct Dim3
  {
    static constexpr int value = 3;
  };
  using Dimensions = testing::Types<Dim2, Dim3>;
} // namespace Viscoplastic::Testing
