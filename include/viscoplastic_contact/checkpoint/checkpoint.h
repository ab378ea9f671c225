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
#include <map>
#include <string>
#include <vector>

namespace Viscoplastic
{
  // What a checkpoint holds of mesh and fields, in bytes. Nothing depends on
  // the numbering of cells or degrees of freedom or on the number of ranks:
  // values belong to cells and to vertices of cells, and cells are named by
  // their CellId.
  //
  // deal.II's Triangulation::save() and load() do the same, but end the process
  // on a full disk or a damaged file, since p4est does.

  /// The active cells of this rank, in their order.
  template <int dim>
  std::string
  pack_mesh(const parallel::distributed::Triangulation<dim> &triangulation);

  /// The cells that pack_mesh() has packed. Throws ExcMessage if they are none
  /// of a mesh with @p n_coarse_cells.
  template <int dim>
  std::vector<CellId>
  unpack_mesh(const std::string &bytes, const unsigned int n_coarse_cells);

  /// Throws ExcMessage if false: the checkpoint is damaged or of another mesh.
  void
  require_sense(const bool condition);

  /// Refine and coarsen until the mesh is the one that pack_mesh() has seen on
  /// all ranks together, whose results are @p parts. Throws ExcMessage if that
  /// is no mesh on the present coarse cells. Collective.
  template <int dim>
  void
  restore_mesh(const std::vector<std::string>            &parts,
               parallel::distributed::Triangulation<dim> &triangulation);

  /// What is attached to the cells of this rank and to their vertices:
  /// displacements, fields at samples, the contact points of @p face (null
  /// without), truncations of it, and @p squared_estimate of active cells
  /// (empty without an estimator).
  template <int dim>
  std::string
  pack_fields(const StressSpace<dim>                    &stress_space,
              const ContactFace<dim>                    *face,
              const State<dim>                          &state,
              const std::vector<const FaceTruncation *> &truncations,
              const Vector<double>                      &squared_estimate);

  /// The packed mesh and fields (pack_mesh(), pack_fields()) of some or all
  /// ranks, and which optional fields they contain.
  struct PackedFields
  {
    std::vector<std::string> meshes, fields;
    /// Whether each of the nodal_fields() is contained.
    std::array<bool, 5> has_nodal_field;
    bool                has_estimate;
    /// Whether each of the sample_fields() is contained.
    std::array<bool, 7> has_sample_field;
  };

  /// The inverse, on the same mesh. Sets the fields at nodes, contact and
  /// those at samples of @p state, and as many truncations as were packed.
  /// Returns whether that was all that this rank needs. Throws ExcMessage for
  /// bytes that make no sense. Not collective but for the exchange of ghost
  /// values at its end.
  template <int dim>
  bool
  unpack_fields(const PackedFields                  &packed,
                const StressSpace<dim>              &stress_space,
                const ContactFace<dim>              *face,
                State<dim>                          &state,
                const std::vector<FaceTruncation *> &truncations,
                Vector<double>                      &squared_estimate);

  /// The coarse mesh in a form that can be compared: topology with ids, and
  /// places of the vertices.
  struct CoarseMesh
  {
    std::vector<std::uint8_t> topology;
    std::vector<double>       vertices;

    /// Whether it is the same up to rounding of the vertices.
    bool
    agrees_with(const CoarseMesh &other) const;
  };

  template <int dim>
  CoarseMesh
  describe_coarse_mesh(
    const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
