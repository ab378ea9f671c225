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
  /// Read the mesh file @p name, whose suffix gives the format, for a body of
  /// @p dim dimensions; a file with elements of another plane model than @p
  /// plane_model is refused. The result is consistent: indices are in range,
  /// numbers are finite, there are cells, no cell occurs twice, no face belongs
  /// to more than two cells, and faces are on the boundary; other contents are
  /// left out. Throws ExcMessage with a sentence for the user that names the
  /// file and the line. Collective.
  ///
  /// Gmsh's format is read here, other formats are converted to it. GridIn of
  /// deal.II 9.4 is not used: it waits forever for the end of truncated
  /// sections, checks indices in debug mode only, takes the lines of Gmsh's
  /// ABAQUS files for cells, reads ABAQUS coordinates with nine digits, and
  /// reads VTK files of one version only.
  MeshFile
  read_mesh_file(const std::string &name,
                 const unsigned int dim,
                 const PlaneModel   plane_model,
                 const MPI_Comm     communicator);



  /// Return the names of the physical groups in a Gmsh file by dimension and
  /// tag; none if the file has another format or no such section.
  std::map<std::pair<unsigned int, unsigned int>, std::string>
  physical_names(const std::string &file);
} // namespace Viscoplastic
