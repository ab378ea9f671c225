// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/state.h>

#include <cstdint>
#include <string>
#include <vector>

namespace Viscoplastic
{
  // Mesh and fields in a form that does not depend on the numbering of cells or
  // degrees of freedom or on the number of ranks: cells are known by their
  // CellId, values stand cell by cell in the order of p4est, of which each rank
  // owns a part without gaps.
  //
  // Triangulation::save() and load() of deal.II do the same, but p4est aborts
  // the process on a full disk.

  /// The CellIds of the owned cells as numbers.
  template <int dim>
  std::vector<unsigned int>
  pack_mesh(const parallel::distributed::Triangulation<dim> &triangulation);

  /// Refine and coarsen until the mesh is the one of @p parts, the results of
  /// pack_mesh() on all ranks. Throws ExcMessage if that is no mesh with the
  /// present coarse cells. Collective.
  template <int dim>
  void
  restore_mesh(const std::vector<std::vector<unsigned int>> &parts,
               parallel::distributed::Triangulation<dim>    &triangulation);

  /// A checksum of the coarse mesh: its vertices, cells and ids.
  template <int dim>
  std::string
  checksum_of_coarse_mesh(
    const parallel::distributed::Triangulation<dim> &triangulation);

  /// Which of the nodal_fields() and of the fields of for_each_sample_field()
  /// are there on any rank. Collective.
  template <int dim>
  std::vector<bool>
  fields_present(const State<dim> &state, const MPI_Comm communicator);

  /// Numbers, cell by cell, and how many each cell has.
  struct CellValues
  {
    std::vector<double>        values;
    std::vector<std::uint32_t> sizes;

    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      archive &values &sizes;
    }
  };

  /// The values at the owned cells: fields of @p state, the contact points of
  /// @p face (null without) and truncations of it, and the @p squared_estimate
  /// of active cells (empty without an estimator).
  template <int dim>
  CellValues
  pack_fields(const StressSpace<dim>                    &stress_space,
              const ContactFace<dim>                    *face,
              const State<dim>                          &state,
              const std::vector<const FaceTruncation *> &truncations,
              const Vector<double>                      &squared_estimate);

  /// The inverse of pack_fields(), for fields that were @p present. Throws
  /// ExcMessage on all ranks if the values do not fit. Collective.
  template <int dim>
  void
  unpack_fields(const CellValues                    &packed,
                const std::vector<bool>             &present,
                const StressSpace<dim>              &stress_space,
                const ContactFace<dim>              *face,
                State<dim>                          &state,
                const std::vector<FaceTruncation *> &truncations,
                Vector<double>                      &squared_estimate);
} // namespace Viscoplastic
