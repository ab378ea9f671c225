// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/mesh/files/mesh_file.h>
#include <viscoplastic_contact/parameters/choices.h>

#include <mpi.h>

#include <map>
#include <string>
#include <utility>

namespace Viscoplastic
{
  /// Read @p name, whose ending says the format, for a body of @p dim
  /// dimensions; files that say so are refused where it is a section of
  /// something else than @p plane_model. What is returned is consistent:
  /// indices are in range, numbers are finite, there are cells, none of them
  /// twice, no face belongs to more than two of them, and the faces are those
  /// on the boundary; what else a file has is left out. Collective. Throws
  /// ExcMessage with a sentence for the user that names the file and the line.
  ///
  /// Gmsh's format is read here, the others are converted to it. deal.II's
  /// GridIn of version 9.4 is no base for any of them: it waits forever for the
  /// end of truncated sections, checks indices in debug mode only, takes the
  /// lines of Gmsh's ABAQUS files for cells, reads ABAQUS coordinates with nine
  /// digits, and VTK files of one version only.
  MeshFile
  read_mesh_file(const std::string &name,
                 const unsigned int dim,
                 const PlaneModel   plane_model,
                 const MPI_Comm     communicator);



  /// The names of the physical groups of a mesh file of Gmsh, by dimension and
  /// tag; none where the file is of another format or has no such section.
  std::map<std::pair<unsigned int, unsigned int>, std::string>
  physical_names(const std::string &file);
} // namespace Viscoplastic
