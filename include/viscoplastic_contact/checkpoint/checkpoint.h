// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>
#include <deal.II/grid/cell_id.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/base/binary_archive.h>
#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/state.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace Viscoplastic
{
  // Mesh and fields of a checkpoint, packed into bytes. They do not depend on
  // the numbering of cells or degrees of freedom or on the number of ranks:
  // values belong to cells, identified by their CellId, and to vertices of
  // cells.
  //
  // Triangulation::save() and load() of deal.II do the same, but p4est aborts
  // the process on a full disk or a damaged file.

  /// Pack the active cells owned by this rank, in their order.
  template <int dim>
  std::string
  pack_mesh(const parallel::distributed::Triangulation<dim> &triangulation);

  /// The cells packed by pack_mesh(). Throws ExcMessage if they are not cells
  /// of a mesh with @p n_coarse_cells coarse cells.
  template <int dim>
  std::vector<CellId>
  unpack_mesh(const std::string &bytes, const unsigned int n_coarse_cells);

  /// Throws ExcMessage if false: the checkpoint is damaged or of another mesh.
  void
  require_sense(const bool condition);

  /// Refine and coarsen until the mesh is the one of @p parts, the results of
  /// pack_mesh() on all ranks. Throws ExcMessage if that is no mesh with the
  /// present coarse cells. Collective.
  template <int dim>
  void
  restore_mesh(const std::vector<std::string>            &parts,
               parallel::distributed::Triangulation<dim> &triangulation);

  /// Pack the data at owned cells and their vertices: displacements, fields at
  /// samples, the contact points of @p face (null without) and truncations of
  /// it, and @p squared_estimate of active cells (empty without an estimator).
  template <int dim>
  std::string
  pack_fields(const StressSpace<dim>                    &stress_space,
              const ContactFace<dim>                    *face,
              const State<dim>                          &state,
              const std::vector<const FaceTruncation *> &truncations,
              const Vector<double>                      &squared_estimate);

  /// Packed meshes and fields (pack_mesh(), pack_fields()) of some or all
  /// ranks, and the optional fields that they contain.
  struct PackedFields
  {
    std::vector<std::string> meshes, fields;
    /// Whether each of the nodal_fields() is contained.
    std::array<bool, 5> has_nodal_field;
    bool                has_estimate;
    /// Whether each field of for_each_sample_field() is contained.
    std::array<bool, n_sample_fields> has_sample_field;
  };

  /// The inverse of pack_fields(), on the same mesh. Sets nodal fields, contact
  /// and fields at samples of @p state, and as many truncations as were packed.
  /// Returns whether @p packed has all data of this rank. Throws ExcMessage for
  /// inconsistent bytes. Only the exchange of ghost values at the end is
  /// collective.
  template <int dim>
  bool
  unpack_fields(const PackedFields                  &packed,
                const StressSpace<dim>              &stress_space,
                const ContactFace<dim>              *face,
                State<dim>                          &state,
                const std::vector<FaceTruncation *> &truncations,
                Vector<double>                      &squared_estimate);

  /// The coarse mesh in a form that can be compared: topology with ids, and
  /// positions of the vertices.
  struct CoarseMesh
  {
    std::vector<std::uint8_t> topology;
    std::vector<double>       vertices;

    /// Whether both meshes are equal up to rounding of the vertices.
    bool
    agrees_with(const CoarseMesh &other) const;
  };

  template <int dim>
  CoarseMesh
  describe_coarse_mesh(
    const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
