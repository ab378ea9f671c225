// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>

#include <utility>

namespace Viscoplastic
{
  FaceRestriction::FaceRestriction(FrictionFace                         face,
                                   std::vector<types::global_dof_index> dofs,
                                   const IndexSet &owned_dofs,
                                   const MPI_Comm  communicator)
    : friction_face(std::move(face))
    , global_dofs(std::move(dofs))
    , communicator(communicator)
  {
    AssertDimension(global_dofs.size(), friction_face.n_dofs());
    const auto position = [&](const unsigned int k) {
      return static_cast<unsigned int>(
        owned_dofs.index_within_set(global_dofs[k]));
    };
    for (unsigned int k = 0; k < global_dofs.size(); ++k)
      if (owned_dofs.is_element(global_dofs[k]))
        owned.push_back({k, position(k)});
    // All degrees of freedom of a node belong to one rank.
    for (unsigned int n = 0; n < friction_face.n_nodes(); ++n)
      {
        const unsigned int first = friction_face.first_dof[n];
        if (!owned_dofs.is_element(global_dofs[first]))
          continue;
        OwnedNode node{n, friction_face.n_node_dofs(n), {{0, 0, 0}}};
        for (unsigned int i = 0; i < node.n_dofs; ++i)
          node.position[i] = position(first + i);
        owned_nodes.push_back(node);
      }
  }



  Vector<double>
  FaceRestriction::gather(const DistributedVector &v) const
  {
    Vector<double> x(global_dofs.size());
    for (const OwnedEntry &entry : owned)
      x[entry.k] = v.begin()[entry.i];
    if (x.size() > 0)
      Utilities::MPI::sum(ArrayView<const double>(x.begin(), x.size()),
                          communicator,
                          ArrayView<double>(x.begin(), x.size()));
    return x;
  }



  void
  FaceRestriction::set(const Vector<double> &x, DistributedVector &v) const
  {
    for (const OwnedEntry &entry : owned)
      v.begin()[entry.i] = x[entry.k];
  }



  void
  FaceRestriction::add(const double          factor,
                       const Vector<double> &x,
                       DistributedVector    &v) const
  {
    for (const OwnedEntry &entry : owned)
      v.begin()[entry.i] += factor * x[entry.k];
  }



  void
  FaceRestriction::project(const FaceTruncation &truncation,
                           DistributedVector    &v) const
  {
    if (truncation.projector.empty())
      return;
    for (const OwnedNode &node : owned_nodes)
      {
        Tensor<1, 3> values;
        for (unsigned int i = 0; i < node.n_dofs; ++i)
          values[i] = v.begin()[node.position[i]];
        values = truncation.projector[node.node] * values;
        for (unsigned int i = 0; i < node.n_dofs; ++i)
          v.begin()[node.position[i]] = values[i];
      }
  }



  void
  FaceRestriction::add_springs(const FaceTruncation    &truncation,
                               const DistributedVector &x,
                               DistributedVector       &y) const
  {
    for (const OwnedNode &node : owned_nodes)
      for (unsigned int i = 0; i < node.n_dofs; ++i)
        for (unsigned int j = 0; j < node.n_dofs; ++j)
          y.begin()[node.position[i]] +=
            truncation.spring[node.node][i][j] * x.begin()[node.position[j]];
  }
} // namespace Viscoplastic
