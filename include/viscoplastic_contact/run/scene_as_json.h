// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/parameter_file.h>

#include <mpi.h>

#include <string>

namespace Viscoplastic
{
  /// Return a JSON object for programs that vary a scene:
  ///
  ///   version, revision, ranks     of the program
  ///   file, directory, dimension   of the scene; `directory' is for results
  ///   values                       of every entry, without `automatic' where
  ///                                that is replaced when parameters are read
  ///   files                        a checksum of all files that belong to it
  ///   cells, h                     of its first mesh; h is the largest
  ///                                diameter of a cell over sqrt(dim)
  ///   volumetric_integration       what `automatic' stands for
  ///   names                        of places, if any
  ///
  /// and @p with_means, see SceneData:
  ///
  ///   means                 by entry, `over_space' and `over_time'; of data
  ///                         that are not their own means
  ///   areas                 of contact boundaries, by id
  ///   nearest_isotropic     Young's modulus and Poisson's ratio, by section of
  ///                         anisotropic materials, of the isotropic tensor
  ///                         nearest in the Frobenius norm
  ///
  /// Collective. Throws ExcMessage.
  std::string
  scene_as_json(const Parameters &scene,
                const bool        with_means,
                const MPI_Comm    communicator);
} // namespace Viscoplastic
