// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/solution_errors.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The fields of one state, sampled at the centers of its cells and on faces,
  /// which do not refer to its mesh: a substitute for the exact solution in
  /// runs on other meshes, with other time steps or numbers of ranks.
  template <int dim>
  struct FieldSamples
  {
    // deal.II sends objects that have serialize() to other ranks.
    struct CellPoint
    {
      Point<dim>     x;
      double         weight; // the volume
      Tensor<1, dim> u;
      Tensor<2, dim> gradient;
      /// The mean of div u over the cell, and the strain zz.
      double dilatation, strain_zz;
      /// The mean over the cell.
      SymmetricTensor<2, 3> stress;

      template <typename Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &x &weight &u &gradient &dilatation &strain_zz &stress;
      }
    };

    struct FacePoint
    {
      Point<dim>     x, inside; // the second is in a cell of its body
      double         weight;    // the area over the number of points
      Tensor<1, dim> multiplier;

      template <typename Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &x &inside &weight &multiplier;
      }
    };

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

  /// Return errors as solution_errors() does, but against samples of a finer
  /// run at the same time, integrated with their weights; `exact' has the norms
  /// of the samples. There is no memory error. Samples outside of this mesh (at
  /// curved boundaries) do not count. Collective.
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
