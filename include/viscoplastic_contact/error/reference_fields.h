// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/solution_errors.h>

#include <array>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The fields of one state at the centers of its cells, free of the mesh: a
  /// stand-in for the exact solution that runs on other meshes, with other time
  /// steps and on other numbers of ranks compare themselves with.
  template <int dim>
  struct FieldSamples
  {
    static constexpr unsigned int n_stresses = dim == 2 ? 4 : 6;

    // x, weight (the volume), u, grad u row by row, the mean of div u over the
    // cell, and the cell mean of the stress in the order of the parameter file.
    static constexpr unsigned int u_index          = dim + 1;
    static constexpr unsigned int gradient_index   = u_index + dim;
    static constexpr unsigned int dilatation_index = gradient_index + dim * dim;
    static constexpr unsigned int zz_index         = dilatation_index + 1;
    static constexpr unsigned int stress_index     = zz_index + 1;
    using CellPoint = std::array<double, stress_index + n_stresses>;

    // x, weight, lambda.
    static constexpr unsigned int multiplier_index = dim + 1;
    using FacePoint = std::array<double, multiplier_index + dim>;

    double                 t = 0.;
    std::vector<CellPoint> cells;
    /// The samples on Gamma_3.
    std::vector<FacePoint> faces;
  };

  /// Sample the owned cells at their centers, where gradients are more accurate
  /// than elsewhere; more points would cost time. @p multiplier_density is null
  /// without contact points.
  template <int dim>
  FieldSamples<dim>
  sample_fields(const StressSpace<dim>  &stress_space,
                const State<dim>        &state,
                const DistributedVector *multiplier_density);

  /// Write the samples of all ranks to one file, whole or not at all. Throws
  /// ExcMessage. Collective.
  template <int dim>
  void
  write_samples(const FieldSamples<dim> &samples,
                const std::string       &file,
                const MPI_Comm           communicator);

  /// Read a file of write_samples(); all samples are on rank 0. Throws
  /// ExcMessage. Collective.
  template <int dim>
  FieldSamples<dim>
  read_samples(const std::string &file, const MPI_Comm communicator);

  /// As solution_errors(), against samples of a finer run at the same time,
  /// by the quadrature of that run; `exact' are its norms. There is no memory
  /// error. Samples outside of this mesh (at curved boundaries) do not count.
  /// Collective.
  template <int dim>
  SolutionErrors
  differences(const FieldSamples<dim> &reference,
              const StressSpace<dim>  &stress_space,
              const State<dim>        &state,
              const DistributedVector *multiplier_density);

  /// The file for the end of a phase of `Time/Phases', counted from 1.
  std::string
  samples_file(const std::string &directory, const unsigned int phase);
} // namespace Viscoplastic
