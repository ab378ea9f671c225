// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/choices.h>

#include <mpi.h>

#include <string>

namespace Viscoplastic
{
  /// What contrib/convert_mesh makes of the mesh file @p name: the same mesh in
  /// Gmsh's format, as text, the same on all ranks. The first rank runs the
  /// script as a process of its own: what a damaged file does to a reader ends
  /// there. Collective. Throws ExcMessage with a sentence for the user that
  /// names the file, also where the elements are not of @p plane_model.
  std::string
  convert_mesh_file(const std::string &name,
                    const PlaneModel   plane_model,
                    const MPI_Comm     communicator);
} // namespace Viscoplastic
