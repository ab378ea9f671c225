// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/cell_id.h>
#include <deal.II/grid/tria_iterator.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/discretization/bulk_system.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;
    /// Independent nodes and their weights.
    using Combination = std::vector<NodeHierarchy::Parent>;

    constexpr unsigned int hanging = numbers::invalid_unsigned_int;



    /// The nodes at the vertices of this rank's owned and ghost cells.
    template <int dim>
    class VertexNodes
    {
    public:
      explicit VertexNodes(const AdmissibleSpace<dim> &space)
        : space(space)
        , node(space.dof_handler.get_triangulation().n_vertices(),
               numbers::invalid_dof_index)
        , is_at_owned_cell(node.size(), false)
      {
        for (const auto &cell : space.dof_handler.active_cell_iterators())
          if (!cell->is_artificial())
            for (const unsigned int v : cell->vertex_indices())
              {
                const unsigned int vertex = cell->vertex_index(v);
                node[vertex]              = cell->vertex_dof_index(v, 0) / dim;
                if (cell->is_locally_owned())
                  is_at_owned_cell[vertex] = true;
              }
      }

      /// Whether this rank owns the node at a vertex.
      bool
      owns(const unsigned int vertex) const
      {
        return node[vertex] != numbers::invalid_dof_index &&
               space.owned.is_element(node[vertex] * dim);
      }

      unsigned int
      position(const unsigned int vertex) const
      {
        return space.owned.index_within_set(node[vertex] * dim) / dim;
      }

      /// Whether all cells around the vertex are owned or ghosts, so that this
      /// rank knows whether the node hangs.
      bool
      is_known(const unsigned int vertex) const
      {
        return is_at_owned_cell[vertex];
      }

      /// Return the node at a vertex, or its parents if it hangs.
      Combination
      resolve(const unsigned int vertex) const
      {
        Combination result;
        for (const auto &[dof, weight] :
             space.independent_nodes(node[vertex] * dim))
          result.push_back({dof / dim, weight});
        return result;
      }

    private:
      const AdmissibleSpace<dim> &space;
      std::vector<Node>           node;
      std::vector<bool>           is_at_owned_cell;
    };



    /// A new node of a refined cell, by its offset from the first vertex: 0, 1
    /// or 2 half widths in each direction.
    template <int dim>
    struct Midpoint
    {
      std::array<unsigned char, dim> halves;

      /// Return the value here of the linear shape function of a vertex.
      double
      weight(const unsigned int vertex) const
      {
        double result = 1.;
        for (unsigned int d = 0; d < dim; ++d)
          result *=
            ((vertex >> d) & 1U) != 0U ? 0.5 * halves[d] : 1. - 0.5 * halves[d];
        return result;
      }
    };



    /// A vertex, by its number in a refined cell.
    using Question = std::pair<CellId::binary_type, unsigned int>;

    /// Return the nodes at vertices of refined cells that touch no owned cell
    /// of this rank, as known by a rank that owns a cell there. Collective.
    template <int dim>
    std::vector<Combination>
    ask_others(const std::vector<Question> &questions,
               const VertexNodes<dim>      &nodes,
               const AdmissibleSpace<dim>  &space)
    {
      const auto &triangulation =
        dynamic_cast<const parallel::distributed::Triangulation<dim> &>(
          space.dof_handler.get_triangulation());
      std::map<unsigned int, std::vector<Question>>     to_ask;
      std::map<unsigned int, std::vector<unsigned int>> numbers;
      for (unsigned int q = 0; q < questions.size(); ++q)
        {
          const unsigned int rank = rank_at_vertex(triangulation,
                                                   CellId(questions[q].first),
                                                   questions[q].second);
          to_ask[rank].push_back(questions[q]);
          numbers[rank].push_back(q);
        }
      std::map<unsigned int, std::vector<Combination>> to_send;
      for (const auto &[rank, asked] :
           Utilities::MPI::some_to_some(space.communicator, to_ask))
        for (const auto &[id, vertex] : asked)
          to_send[rank].push_back(
            nodes.resolve(triangulation.create_cell_iterator(CellId(id))
                            ->vertex_index(vertex)));
      std::vector<Combination> answers(questions.size());
      for (const auto &[rank, received] :
           Utilities::MPI::some_to_some(space.communicator, to_send))
        for (unsigned int i = 0; i < received.size(); ++i)
          answers[numbers.at(rank)[i]] = received[i];
      return answers;
    }



    /// The refined cell of which a node is a new one.
    template <int dim>
    struct Origin
    {
      int           level = -1, index = 0;
      Midpoint<dim> midpoint;
    };



    /// Return the origin of each owned node, and set the levels of refinement
    /// of independent nodes; hanging nodes have a nonzero level on entry.
    template <int dim>
    std::vector<Origin<dim>>
    find_origins(const VertexNodes<dim>   &nodes,
                 const Triangulation<dim> &triangulation,
                 NodeHierarchy            &hierarchy)
    {
      std::vector<Origin<dim>> origins(hierarchy.first_level.size());
      for (const auto &cell : triangulation.cell_iterators())
        if (cell->has_children())
          for (unsigned int c = 0; c < cell->n_children(); ++c)
            for (const unsigned int v : cell->vertex_indices())
              {
                // Vertex v of child c is a vertex of the cell itself if v is c.
                const unsigned int vertex = cell->child(c)->vertex_index(v);
                if (v == c || !nodes.owns(vertex))
                  continue;
                const unsigned int n = nodes.position(vertex);
                if (hierarchy.first_level[n] != 0) // hanging, or known
                  continue;
                hierarchy.first_level[n] = cell->level() + 1;
                origins[n].level         = cell->level();
                origins[n].index         = cell->index();
                for (unsigned int d = 0; d < dim; ++d)
                  origins[n].midpoint.halves[d] =
                    ((c >> d) & 1U) + ((v >> d) & 1U);
              }
      return origins;
    }



    /// Replace levels of refinement by spaces that are coarsened everywhere at
    /// once: each leaves out all nodes of the next finer one on which no other
    /// node there depends. Collective.
    void
    coarsen_everywhere(const MPI_Comm communicator, NodeHierarchy &hierarchy)
    {
      IndexSet owned(hierarchy.end_of_mesh), others(hierarchy.end_of_mesh);
      owned.add_range(hierarchy.begin, hierarchy.end);
      std::vector<Node> foreign;
      for (const auto &parent : hierarchy.parents)
        if (!owned.is_element(parent.node))
          foreign.push_back(parent.node);
      std::sort(foreign.begin(), foreign.end());
      others.add_indices(foreign.begin(), foreign.end());
      // Spaces are counted from the finest one down here.
      LinearAlgebra::distributed::Vector<double> last_space(owned,
                                                            others,
                                                            communicator);
      const unsigned int finest = hierarchy.n_levels - 1;
      for (unsigned int level = finest; level > 0; --level)
        {
          for (std::size_t n = 0; n < hierarchy.first_level.size(); ++n)
            if (hierarchy.first_level[n] == level)
              for (std::size_t e = hierarchy.row_begin[n];
                   e < hierarchy.row_begin[n + 1];
                   ++e)
                {
                  double &of_parent = last_space(hierarchy.parents[e].node);
                  of_parent =
                    std::max(of_parent, last_space.local_element(n) + 1.);
                }
          last_space.compress(VectorOperation::max);
        }
      for (std::size_t n = 0; n < hierarchy.first_level.size(); ++n)
        if (hierarchy.first_level[n] > 0 && hierarchy.first_level[n] <= finest)
          hierarchy.first_level[n] =
            finest - static_cast<unsigned int>(last_space.local_element(n));
    }
  } // namespace



  template <int dim>
  NodeHierarchy
  make_node_hierarchy(const AdmissibleSpace<dim> &space)
  {
    using CellIterator        = typename Triangulation<dim>::cell_iterator;
    const auto &triangulation = space.dof_handler.get_triangulation();
    const VertexNodes<dim> nodes(space);
    const std::size_t n_owned = space.dof_handler.n_locally_owned_dofs() / dim;

    NodeHierarchy hierarchy;
    hierarchy.end_of_mesh = space.dof_handler.n_dofs() / dim;
    hierarchy.n_levels    = triangulation.n_global_levels();
    hierarchy.begin =
      n_owned > 0 ? space.owned.nth_index_in_set(0) / dim : Node(0);
    hierarchy.end = hierarchy.begin + n_owned;
    hierarchy.first_level.assign(n_owned, 0);
    for (std::size_t n = 0; n < n_owned; ++n)
      if (space.cartesian_hanging_nodes().is_constrained((hierarchy.begin + n) *
                                                         dim))
        hierarchy.first_level[n] = hanging;

    const auto origins = find_origins(nodes, triangulation, hierarchy);

    // Parents that only other ranks can resolve.
    std::vector<Question>                questions;
    std::map<unsigned int, unsigned int> question_of_vertex;
    for (const Origin<dim> &origin : origins)
      if (origin.level >= 0)
        {
          const CellIterator cell(&triangulation, origin.level, origin.index);
          for (const unsigned int v : cell->vertex_indices())
            if (origin.midpoint.weight(v) > 0. &&
                !nodes.is_known(cell->vertex_index(v)) &&
                question_of_vertex
                  .emplace(cell->vertex_index(v), questions.size())
                  .second)
              questions.emplace_back(cell->id().template to_binary<dim>(), v);
        }
    const std::vector<Combination> answers =
      ask_others(questions, nodes, space);

    std::map<Node, double> row;
    hierarchy.row_begin.assign(1, 0);
    hierarchy.row_begin.reserve(n_owned + 1);
    for (const Origin<dim> &origin : origins)
      {
        if (origin.level >= 0)
          {
            const CellIterator cell(&triangulation, origin.level, origin.index);
            row.clear();
            for (const unsigned int v : cell->vertex_indices())
              {
                const double weight = origin.midpoint.weight(v);
                if (weight == 0.)
                  continue;
                const unsigned int vertex = cell->vertex_index(v);
                const Combination  parent =
                  nodes.is_known(vertex) ?
                     nodes.resolve(vertex) :
                     answers[question_of_vertex.at(vertex)];
                AssertThrow(!parent.empty(), ExcInternalError());
                for (const auto &[node, share] : parent)
                  row[node] += weight * share;
              }
            for (const auto &[node, weight] : row)
              hierarchy.parents.push_back({node, weight});
          }
        hierarchy.row_begin.push_back(hierarchy.parents.size());
      }
    hierarchy.parents.shrink_to_fit();
    coarsen_everywhere(space.communicator, hierarchy);
    hierarchy.has_interfaces = !space.mortar_rows.empty();
    for (const auto &of_boundary : space.mortar_rows)
      for (const auto &[node, row] : of_boundary.second)
        if (node >= hierarchy.begin && node < hierarchy.end)
          hierarchy.opposite[node] = row.nodes;
    space.for_each_rotated_node(
      [&](const Node first_dof, const Tensor<2, dim> &directions) {
        Tensor<2, 3> padded;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            padded[i][j] = directions[i][j];
        hierarchy.frames[first_dof / dim] = padded;
      });
    return hierarchy;
  }



  VISCOPLASTIC_INSTANTIATE(make_node_hierarchy);
} // namespace Viscoplastic
