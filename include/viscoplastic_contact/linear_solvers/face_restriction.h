// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/contact/friction_face.h>

#include <vector>

namespace Viscoplastic
{
  /**
   * The restriction R of distributed vectors to the friction face, and its
   * transpose. A face vector is the same on all ranks; each entry of it is one
   * global degree of freedom, owned by one rank.
   */
  class FaceRestriction
  {
  public:
    /// An empty face.
    FaceRestriction() = default;

    /// @p dofs: the global degree of freedom of each entry of a face vector;
    /// @p owned: those of this rank.
    FaceRestriction(FrictionFace                         face,
                    std::vector<types::global_dof_index> dofs,
                    const IndexSet                      &owned,
                    const MPI_Comm                       communicator);

    const FrictionFace &
    face() const
    {
      return friction_face;
    }

    const std::vector<types::global_dof_index> &
    dofs() const
    {
      return global_dofs;
    }

    /// An entry k of face vectors that this rank owns, and the position i of
    /// its degree of freedom among those that this rank owns.
    struct OwnedEntry
    {
      unsigned int k, i;
    };

    const std::vector<OwnedEntry> &
    owned_entries() const
    {
      return owned;
    }

    /// R v. One rank contributes each entry, so the sum over ranks is exact.
    /// Collective.
    Vector<double>
    gather(const DistributedVector &v) const;

    /// Set the entries of @p v on the face to those of @p x.
    void
    set(const Vector<double> &x, DistributedVector &v) const;

    /// v := v + factor R^T x.
    void
    add(const double          factor,
        const Vector<double> &x,
        DistributedVector    &v) const;

    /// Apply the projectors of a truncation, node by node; nothing happens if
    /// it has none.
    void
    project(const FaceTruncation &truncation, DistributedVector &v) const;

    /// y := y + R^T springs R x.
    void
    add_springs(const FaceTruncation    &truncation,
                const DistributedVector &x,
                DistributedVector       &y) const;

  private:
    /// A node whose unknowns this rank owns, and where they are.
    struct OwnedNode
    {
      unsigned int                node, n_dofs;
      std::array<unsigned int, 3> position;
    };

    FrictionFace                         friction_face;
    std::vector<types::global_dof_index> global_dofs;
    MPI_Comm                             communicator = MPI_COMM_SELF;
    std::vector<OwnedEntry>              owned;
    std::vector<OwnedNode>               owned_nodes;
  };
} // namespace Viscoplastic
