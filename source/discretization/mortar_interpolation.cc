// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/bounding_box.h>
#include <deal.II/base/geometry_info.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/numerics/rtree.h>

#include <viscoplastic_contact/discretization/mortar_interpolation.h>
#include <viscoplastic_contact/discretization/plane_faces.h>
#include <viscoplastic_contact/linear_solvers/multigrid_level.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/utility.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;
    using Row  = std::vector<NodeHierarchy::Parent>;

    /// A part of a row that is not covered from the other side, or rounding.
    constexpr double coverage_tolerance = 1e-6;



    /// A face of the primary side, for other ranks; each of its vertices is an
    /// independent node, or what it hangs on.
    template <int dim>
    struct PrimaryFace
    {
      static constexpr unsigned int n = GeometryInfo<dim>::vertices_per_face;

      std::array<Point<dim>, n> vertices;
      std::array<Row, n>        nodes;
      double                    softness = 0.;

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &vertices &nodes &softness;
      }
    };



    /// int psi_p v over the faces at a node, by nodes of the other side, and
    /// int phi_p.
    struct Integrals
    {
      std::map<Node, double> products;
      double                 weight = 0.;

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &products &weight;
      }

      void
      add(const double factor, const Row &row)
      {
        for (const auto &[node, share] : row)
          products[node] += factor * share;
      }

      void
      add(const Integrals &other)
      {
        weight += other.weight;
        for (const auto &[node, value] : other.products)
          products[node] += value;
      }
    };



    template <int dim>
    class Sides
    {
    public:
      Sides(const DoFHandler<dim>           &dof_handler,
            const AffineConstraints<double> &hanging,
            const ContactPair<dim>          &pair)
        : dof_handler(dof_handler)
        , hanging(hanging)
        , pair(pair)
        , project(pair.normal)
        , communicator(dof_handler.get_communicator())
        , owned(dof_handler.locally_owned_dofs())
      {
        const Node n_nodes = dof_handler.n_dofs() / dim;
        // Ranks without nodes begin where the next one does.
        begins = Utilities::MPI::all_gather(communicator,
                                            owned.n_elements() > 0 ?
                                              owned.nth_index_in_set(0) / dim :
                                              n_nodes);
        begins.push_back(n_nodes);
        for (std::size_t r = begins.size() - 1; r-- > 0;)
          begins[r] = std::min(begins[r], begins[r + 1]);
      }

      MortarRows
      rows() const
      {
        std::map<Node, Integrals> integrals = on_owned_nodes(integrate());
        std::map<Node, Row>       rows;
        for (const auto &[node, of_node] : integrals)
          for (const auto &[other, value] : of_node.products)
            rows[node].push_back({other, value / of_node.weight});
        pass_on_hanging_nodes(integrals, rows);

        MortarRows result;
        for (auto &[node, row] : rows)
          {
            double sum = 0.;
            for (const auto &parent : row)
              sum += parent.weight;
            if (hangs(node) || std::abs(sum - 1.) > coverage_tolerance)
              continue;
            for (auto &parent : row)
              parent.weight /= sum;
            result[node] = row;
          }

        std::vector<Node> others;
        for_each_face(
          pair.secondary, 1., [&](const auto &cell, const unsigned int f) {
            for (const unsigned int v : cell->face(f)->vertex_indices())
              if (const Node node = node_at(cell, f, v);
                  !owns(node) && !hangs(node))
                others.push_back(node);
          });
        std::sort(others.begin(), others.end());
        others.erase(std::unique(others.begin(), others.end()), others.end());
        const std::vector<Row> answers =
          ask_owners(others, begins, communicator, [&](const Node node) {
            const auto row = result.find(node);
            return row != result.end() ? row->second : Row();
          });
        for (std::size_t i = 0; i < others.size(); ++i)
          if (!answers[i].empty())
            result[others[i]] = answers[i];
        return result;
      }

      template <typename Softness>
      std::vector<PlaceOpposite<dim>>
      opposite(const std::vector<Point<dim>> &places,
               const Softness                &softness) const
      {
        const std::vector<PrimaryFace<dim>> primary  = primary_faces(softness);
        const std::vector<PlaneFace<d>>     in_plane = projected(primary);
        const auto                          tree     = tree_of(in_plane);
        std::vector<PlaceOpposite<dim>>     result;
        for (const Point<dim> &place : places)
          {
            result.emplace_back();
            const Point<d> x = project(place);
            for (const auto &[box, i] :
                 tree | boost::geometry::index::adaptors::queried(
                          boost::geometry::index::intersects(x)))
              if (contains(in_plane[i], x))
                {
                  const Point<d> xi = reference_position<d>(in_plane[i], x);
                  Integrals      sum;
                  for (unsigned int v = 0; v < n; ++v)
                    {
                      const double phi =
                        GeometryInfo<d>::d_linear_shape_function(xi, v);
                      sum.add(phi, primary[i].nodes[v]);
                      result.back().position += phi * primary[i].vertices[v];
                    }
                  for (const auto &[node, weight] : sum.products)
                    result.back().nodes.push_back({node, weight});
                  result.back().softness = primary[i].softness;
                  break;
                }
          }
        return result;
      }

    private:
      static constexpr unsigned int d = dim - 1;
      static constexpr unsigned int n = GeometryInfo<dim>::vertices_per_face;

      /// Call @p act (cell, face) for the faces with an id, on owned cells and
      /// ghosts, that look along @p sign times the normal.
      template <typename Action>
      void
      for_each_face(const types::boundary_id id,
                    const double             sign,
                    const Action            &act) const
      {
        for (const auto &cell : dof_handler.active_cell_iterators())
          if (!cell->is_artificial())
            for (const unsigned int f : cell->face_indices())
              if (cell->at_boundary(f) && cell->face(f)->boundary_id() == id &&
                  sign * ((cell->face(f)->center() - cell->center()) *
                          pair.normal) >
                    0.)
                act(cell, f);
      }

      template <typename Cell>
      Node
      node_at(const Cell        &cell,
              const unsigned int f,
              const unsigned int v) const
      {
        return cell->face(f)->vertex_dof_index(v, 0) / dim;
      }

      bool
      owns(const Node node) const
      {
        return owned.is_element(node * dim);
      }

      bool
      hangs(const Node node) const
      {
        return hanging.is_constrained(node * dim);
      }

      unsigned int
      owner(const Node node) const
      {
        return std::upper_bound(begins.begin(), begins.end(), node) -
               begins.begin() - 1;
      }

      Row
      resolve(const Node node) const
      {
        if (!hangs(node))
          return {{node, 1.}};
        Row result;
        for (const auto &[dof, weight] :
             *hanging.get_constraint_entries(node * dim))
          result.push_back({dof / dim, weight});
        return result;
      }

      template <typename Cell>
      PlaneFace<d>
      plane_face(const Cell &cell, const unsigned int f) const
      {
        PlaneFace<d> result;
        for (unsigned int v = 0; v < n; ++v)
          result[v] = project(cell->face(f)->vertex(v));
        return result;
      }

      /// The faces of the primary side that may lie opposite to owned faces of
      /// the secondary one. Collective.
      template <typename Softness>
      std::vector<PrimaryFace<dim>>
      primary_faces(const Softness &softness) const
      {
        std::vector<Point<d>> places;
        for_each_face(pair.secondary,
                      1.,
                      [&](const auto &cell, const unsigned int f) {
                        if (cell->is_locally_owned())
                          for (const Point<d> &x : plane_face(cell, f))
                            places.push_back(x);
                      });
        const auto boxes = Utilities::MPI::all_gather(
          communicator,
          places.empty() ? std::vector<BoundingBox<d>>() :
                           std::vector<BoundingBox<d>>{BoundingBox<d>(places)});

        std::map<unsigned int, std::vector<PrimaryFace<dim>>> to_send;
        for_each_face(
          pair.primary, -1., [&](const auto &cell, const unsigned int f) {
            if (!cell->is_locally_owned())
              return;
            const BoundingBox<d> box = box_of<d>(plane_face(cell, f));
            for (unsigned int rank = 0; rank < boxes.size(); ++rank)
              if (!boxes[rank].empty() && boxes[rank][0].get_neighbor_type(
                                            box) != NeighborType::not_neighbors)
                {
                  PrimaryFace<dim> face;
                  face.softness = softness(cell, f);
                  for (unsigned int v = 0; v < n; ++v)
                    {
                      face.vertices[v] = cell->face(f)->vertex(v);
                      face.nodes[v]    = resolve(node_at(cell, f, v));
                    }
                  to_send[rank].push_back(face);
                }
          });
        std::vector<PrimaryFace<dim>> result;
        for (const auto &received :
             Utilities::MPI::some_to_some(communicator, to_send))
          result.insert(result.end(),
                        received.second.begin(),
                        received.second.end());
        return result;
      }

      std::vector<PlaneFace<d>>
      projected(const std::vector<PrimaryFace<dim>> &faces) const
      {
        std::vector<PlaneFace<d>> result(faces.size());
        for (std::size_t i = 0; i < faces.size(); ++i)
          for (unsigned int v = 0; v < n; ++v)
            result[i][v] = project(faces[i].vertices[v]);
        return result;
      }

      static auto
      tree_of(const std::vector<PlaneFace<d>> &faces)
      {
        std::vector<std::pair<BoundingBox<d>, std::size_t>> boxes;
        for (std::size_t i = 0; i < faces.size(); ++i)
          {
            BoundingBox<d> box = box_of<d>(faces[i]);
            box.extend(1e-10 * box.side_length(0)); // see contains()
            boxes.emplace_back(box, i);
          }
        return pack_rtree(boxes);
      }

      /// Over owned faces, for nodes of any rank. Collective.
      std::map<Node, Integrals>
      integrate() const
      {
        const std::vector<PrimaryFace<dim>> primary =
          primary_faces([](const auto &, const unsigned int) { return 0.; });
        const std::vector<PlaneFace<d>> in_plane = projected(primary);
        const auto                      tree     = tree_of(in_plane);
        const QGaussSimplex<d>          quadrature(3);
        std::map<Node, Integrals>       result;
        for_each_face(
          pair.secondary, 1., [&](const auto &cell, const unsigned int f) {
            if (!cell->is_locally_owned())
              return;
            const PlaneFace<d>         face = plane_face(cell, f);
            const DualBasis<d>         dual(face);
            std::array<Integrals *, n> at;
            for (unsigned int v = 0; v < n; ++v)
              {
                at[v] = &result[node_at(cell, f, v)];
                at[v]->weight += dual.integrals[v];
              }
            for (const auto &[box, i] :
                 tree | boost::geometry::index::adaptors::queried(
                          boost::geometry::index::intersects(box_of<d>(face))))
              {
                FullMatrix<double> products(n, n);
                for (const Simplex<d> &part : intersection(face, in_plane[i]))
                  for (unsigned int q = 0; q < quadrature.size(); ++q)
                    {
                      const Point<d> &eta = quadrature.point(q);
                      Point<d>        x   = part[0];
                      for (unsigned int k = 0; k < d; ++k)
                        x += eta[k] * (part[k + 1] - part[0]);
                      const double JxW = measure(part) * quadrature.weight(q) *
                                         (d == 2 ? 2. : 1.);
                      const Point<d> here = reference_position<d>(face, x),
                                     there =
                                       reference_position<d>(in_plane[i], x);
                      for (unsigned int v = 0; v < n; ++v)
                        for (unsigned int w = 0; w < n; ++w)
                          products(v, w) +=
                            dual.value(v, here) *
                            GeometryInfo<d>::d_linear_shape_function(there, w) *
                            JxW;
                    }
                for (unsigned int v = 0; v < n; ++v)
                  for (unsigned int w = 0; w < n; ++w)
                    at[v]->add(products(v, w), primary[i].nodes[w]);
              }
          });
        return result;
      }

      /// The sums over all ranks, at the owners of the nodes. Collective.
      std::map<Node, Integrals>
      on_owned_nodes(const std::map<Node, Integrals> &parts) const
      {
        std::map<unsigned int, std::vector<std::pair<Node, Integrals>>> to_send;
        for (const auto &part : parts)
          to_send[owner(part.first)].push_back(part);
        std::map<Node, Integrals> result;
        for (const auto &received :
             Utilities::MPI::some_to_some(communicator, to_send))
          for (const auto &[node, part] : received.second)
            result[node].add(part);
        return result;
      }

      /// The rows of independent nodes with the part that hanging nodes leave
      /// them. Collective.
      void
      pass_on_hanging_nodes(const std::map<Node, Integrals> &integrals,
                            std::map<Node, Row>             &rows) const
      {
        // Edges with a hanging node: all at owned nodes are known here.
        std::map<Node, std::pair<Node, Node>> edges;
        for_each_face(
          pair.secondary, 1., [&](const auto &cell, const unsigned int f) {
            for (const unsigned int v : cell->face(f)->vertex_indices())
              if (const Node node = node_at(cell, f, v); hangs(node))
                {
                  const Row parents = resolve(node);
                  AssertThrow(parents.size() == 2, ExcNotImplemented());
                  edges[node] = {parents[0].node, parents[1].node};
                }
          });
        if (Utilities::MPI::max(edges.size(), communicator) == 0)
          return;

        // Integrals of basis functions, and rows, also of other ranks' nodes.
        const auto with_weights = [&](const std::map<Node, double> &weights,
                                      const std::set<Node>         &nodes) {
          std::map<Node, Row>     result;
          const std::vector<Node> asked(nodes.begin(), nodes.end());
          const auto              answers =
            ask_owners(asked, begins, communicator, [&](const Node node) {
              Row answer{{node, weights.at(node)}};
              if (const auto row = rows.find(node); row != rows.end())
                answer.insert(answer.end(),
                              row->second.begin(),
                              row->second.end());
              return answer;
            });
          for (std::size_t i = 0; i < asked.size(); ++i)
            result[asked[i]] = answers[i];
          return result;
        };
        std::map<Node, double> weights;
        for (const auto &[node, of_node] : integrals)
          weights[node] = of_node.weight;
        std::set<Node> hanging_here, ends;
        for (const auto &[h, ab] : edges)
          for (const Node a : {ab.first, ab.second})
            if (owns(a))
              {
                hanging_here.insert(h);
                ends.insert(ab.first);
                ends.insert(ab.second);
              }
        const auto of_hanging = with_weights(weights, hanging_here);
        for (const Node h : hanging_here)
          for (const Node a : {edges.at(h).first, edges.at(h).second})
            if (owns(a))
              weights.at(a) += 0.5 * of_hanging.at(h)[0].weight;
        const auto of_ends = with_weights(weights, ends);

        std::map<Node, Integrals> sums;
        for (const Node h : hanging_here)
          {
            const auto &[a, b] = edges.at(h);
            const Row &row_h = of_hanging.at(h), &row_a = of_ends.at(a),
                      &row_b = of_ends.at(b);
            const double c =
              row_h[0].weight / (row_a[0].weight + row_b[0].weight);
            const auto without_weight = [](const Row &row) {
              return Row(row.begin() + 1, row.end());
            };
            for (const Node end : {a, b})
              if (owns(end))
                {
                  sums[end].add(c, without_weight(row_h));
                  sums[end].add(-0.5 * c, without_weight(row_a));
                  sums[end].add(-0.5 * c, without_weight(row_b));
                }
          }
        for (auto &[node, sum] : sums)
          {
            sum.add(1., rows[node]);
            rows[node].clear();
            for (const auto &[other, weight] : sum.products)
              rows[node].push_back({other, weight});
          }
      }

      const DoFHandler<dim>           &dof_handler;
      const AffineConstraints<double> &hanging;
      const ContactPair<dim>          &pair;
      const Projection<dim>            project;
      const MPI_Comm                   communicator;
      const IndexSet                   owned;
      std::vector<Node>                begins;
    };
  } // namespace



  template <int dim>
  MortarRows
  mortar_interpolation(const DoFHandler<dim>           &dof_handler,
                       const AffineConstraints<double> &hanging_nodes,
                       const ContactPair<dim>          &pair)
  {
    return Sides<dim>(dof_handler, hanging_nodes, pair).rows();
  }



  template <int dim>
  std::vector<PlaceOpposite<dim>>
  places_opposite(const DoFHandler<dim>           &dof_handler,
                  const AffineConstraints<double> &hanging_nodes,
                  const ContactPair<dim>          &pair,
                  const std::vector<Point<dim>>   &places,
                  const std::function<double(
                    const typename DoFHandler<dim>::active_cell_iterator &,
                    const unsigned int)>          &softness)
  {
    return Sides<dim>(dof_handler, hanging_nodes, pair)
      .opposite(places, softness);
  }



#define INSTANTIATE(dim)                                                      \
  template MortarRows mortar_interpolation(const DoFHandler<dim> &,           \
                                           const AffineConstraints<double> &, \
                                           const ContactPair<dim> &);         \
  template std::vector<PlaceOpposite<dim>> places_opposite(                   \
    const DoFHandler<dim> &,                                                  \
    const AffineConstraints<double> &,                                        \
    const ContactPair<dim> &,                                                 \
    const std::vector<Point<dim>> &,                                          \
    const std::function<                                                      \
      double(const typename DoFHandler<dim>::active_cell_iterator &,          \
             const unsigned int)> &);

  INSTANTIATE(2)
  INSTANTIATE(3)

#undef INSTANTIATE
} // namespace Viscoplastic
