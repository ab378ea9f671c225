// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/geometry_info.h>
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/discretization/interface_sides.h>
#include <viscoplastic_contact/discretization/mortar_interpolation.h>
#include <viscoplastic_contact/linear_solvers/multigrid_level.h>

#include <boost/serialization/map.hpp>
#include <boost/serialization/utility.hpp>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;
    using Row  = std::vector<NodeHierarchy::Parent>;

    /// The part of a face that need not be covered from the other side, for
    /// rounding; more where sides are curved, whose projections are not exact.
    constexpr double coverage_tolerance = 1e-6, curved_tolerance = 0.05;

    /// The node number of the entry with MortarRow::bulge in a row, which ranks
    /// and hanging nodes pass on like other entries.
    constexpr Node bulge_entry = numbers::invalid_dof_index;



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



    /// Assembles the rows of MortarRows.
    template <int dim>
    class MortarAssembly : private InterfaceSides<dim>
    {
    public:
      using InterfaceSides<dim>::InterfaceSides;

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
            double    sum = 0.;
            MortarRow split;
            for (const auto &parent : row)
              if (parent.node == bulge_entry)
                split.bulge = parent.weight;
              else
                {
                  split.nodes.push_back(parent);
                  sum += parent.weight;
                }
            if (hangs(node) || std::abs(sum - 1.) > coverage_tolerance)
              continue;
            for (auto &parent : split.nodes)
              parent.weight /= sum;
            result[node] = split;
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
            return row != result.end() ? row->second.nodes : Row();
          });
        for (std::size_t i = 0; i < others.size(); ++i)
          if (!answers[i].empty())
            result[others[i]].nodes = answers[i];
        return result;
      }

    private:
      using Sides = InterfaceSides<dim>;
      using Sides::begins;
      using Sides::box_before;
      using Sides::communicator;
      using Sides::d;
      using Sides::faces;
      using Sides::for_each_face;
      using Sides::hangs;
      using Sides::n;
      using Sides::node_at;
      using Sides::owner;
      using Sides::owns;
      using Sides::pair;
      using Sides::primary_faces;
      using Sides::project;
      using Sides::resolve;
      using Sides::surface_face;
      using Sides::tree_of;

      /// A face of the primary side in the plane of one of the secondary side.
      PlaneFace<d>
      in_plane_of(const SurfaceFace<dim> &here,
                  const Tensor<1, dim>   &normal,
                  const PlaneFace<d>     &in_plane,
                  const PrimaryFace<dim> &other) const
      {
        if (pair.normals == nullptr)
          return other.seen(project);
        PlaneFace<d> result;
        for (unsigned int v = 0; v < n; ++v)
          result[v] = here.foot_of(other.vertices[v], normal, in_plane);
        return result;
      }

      /// A quadrature point in the intersection of two faces.
      struct Sample
      {
        const PrimaryFace<dim> *other;
        Point<d>                here, there;
        double                  JxW, bulge;
      };

      /// Add samples in the intersection of two faces; returns its measure.
      double
      add_samples(const SurfaceFace<dim> &here,
                  const Tensor<1, dim>   &normal,
                  const PlaneFace<d>     &face,
                  const PrimaryFace<dim> &other,
                  std::vector<Sample>    &samples) const
      {
        const QGaussSimplex<d> quadrature(3);
        const PlaneFace<d>     window = in_plane_of(here, normal, face, other);
        double                 result = 0.;
        for (const Simplex<d> &part : intersection(face, window))
          {
            result += measure(part);
            for (unsigned int q = 0; q < quadrature.size(); ++q)
              {
                const Point<d> &eta = quadrature.point(q);
                Point<d>        x   = part[0];
                for (unsigned int k = 0; k < d; ++k)
                  x += eta[k] * (part[k + 1] - part[0]);
                Sample sample{&other,
                              reference_position<d>(face, x),
                              {},
                              measure(part) * quadrature.weight(q) *
                                (d == 2 ? 2. : 1.),
                              0.};
                sample.JxW *=
                  extent(pair.scene.plane_model(), here.position(sample.here));
                if (pair.normals == nullptr)
                  sample.there = reference_position<d>(window, x);
                else
                  {
                    const Tensor<1, dim>  n_x = here.normal(sample.here);
                    const Projection<dim> along(n_x);
                    sample.there =
                      reference_position<d>(other.seen(along),
                                            along(here.position(sample.here)));
                    sample.bulge = n_x * (other.bulge(sample.there) -
                                          here.bulge(sample.here));
                  }
                samples.push_back(sample);
              }
          }
        return result;
      }

      /// Integrate over owned faces, for nodes of any rank. Collective.
      std::map<Node, Integrals>
      integrate() const
      {
        const std::vector<PrimaryFace<dim>> primary =
          primary_faces([](const auto &, const unsigned int) { return 0.; });
        const auto                tree = tree_of(primary);
        std::map<Node, Integrals> result;
        for_each_face(
          pair.secondary, 1., [&](const auto &cell, const unsigned int f) {
            if (!cell->is_locally_owned())
              return;
            const SurfaceFace<dim> here   = surface_face(cell, f);
            const Tensor<1, dim>   normal = here.normal(reference_center<d>());
            const PlaneFace<d>     face   = here.seen(
              pair.normals != nullptr ? Projection<dim>(normal) : project);
            std::array<Integrals *, n> at;
            for (unsigned int v = 0; v < n; ++v)
              at[v] = &result[node_at(cell, f, v)];
            std::vector<Sample> samples;
            double              covered = 0.;
            for (const auto &[box, i] :
                 tree | boost::geometry::index::adaptors::queried(
                          boost::geometry::index::intersects(box_before(here))))
              if (faces(normal, primary[i]))
                covered += add_samples(here, normal, face, primary[i], samples);
            if (const double area = measure(face);
                std::abs(covered - area) > (pair.normals != nullptr ?
                                              curved_tolerance :
                                              coverage_tolerance) *
                                             area)
              {
                // Rows that lack products do not sum to 1 and are dropped.
                for (Integrals *const of_node : at)
                  of_node->weight += area / n;
                return;
              }
            const DualBasis<d> dual([&](const auto &visit) {
              for (const Sample &sample : samples)
                visit(sample.here, sample.JxW);
            });
            for (unsigned int v = 0; v < n; ++v)
              {
                at[v]->weight += dual.integrals[v];
                for (const Sample &sample : samples)
                  {
                    const double psi = dual.value(v, sample.here) * sample.JxW;
                    for (unsigned int w = 0; w < n; ++w)
                      at[v]->add(psi * GeometryInfo<d>::d_linear_shape_function(
                                         sample.there, w),
                                 sample.other->nodes[w]);
                    if (pair.normals != nullptr)
                      at[v]->products[bulge_entry] += psi * sample.bulge;
                  }
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

      /// Add the contributions of hanging nodes to the rows of independent
      /// nodes, see mortar_interpolation(). Collective.
      void
      pass_on_hanging_nodes(const std::map<Node, Integrals> &integrals,
                            std::map<Node, Row>             &rows) const
      {
        // Edges by hanging node; all that end at owned nodes are known here.
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

        // Rows of nodes of any rank, preceded by the nodes' integrals of phi.
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
    };
  } // namespace



  template <int dim>
  MortarRows
  mortar_interpolation(const DoFHandler<dim>           &dof_handler,
                       const AffineConstraints<double> &hanging_nodes,
                       const ContactPair<dim>          &pair)
  {
    return MortarAssembly<dim>(dof_handler, hanging_nodes, pair).rows();
  }



  template <int dim>
  std::vector<PlaceOpposite<dim>>
  places_opposite(const DoFHandler<dim>                  &dof_handler,
                  const AffineConstraints<double>        &hanging_nodes,
                  const ContactPair<dim>                 &pair,
                  const std::vector<InterfacePlace<dim>> &places,
                  const std::function<double(
                    const typename DoFHandler<dim>::active_cell_iterator &,
                    const unsigned int)>                 &softness)
  {
    using Sides              = InterfaceSides<dim>;
    constexpr unsigned int d = Sides::d;
    const Sides            sides(dof_handler, hanging_nodes, pair);
    const auto             primary = sides.primary_faces(softness);
    const auto             tree    = sides.tree_of(primary);

    std::vector<PlaceOpposite<dim>> result;
    for (const InterfacePlace<dim> &place : places)
      {
        result.emplace_back();
        const Projection<dim> along(place.normal);
        const Point<d>        x = along(place.position);
        for (const auto &[box, i] :
             tree | boost::geometry::index::adaptors::queried(
                      boost::geometry::index::intersects(sides.box_before(
                        place.position, place.normal, place.reach))))
          {
            const PrimaryFace<dim> &other = primary[i];
            const PlaneFace<d>      seen  = other.seen(along);
            if (!sides.faces(place.normal, other) || !contains(seen, x))
              continue;
            const Point<d> xi = reference_position<d>(seen, x);
            std::map<typename Sides::Node, double> weights;
            for (unsigned int v = 0; v < Sides::n; ++v)
              for (const auto &[node, share] : other.nodes[v])
                weights[node] +=
                  GeometryInfo<d>::d_linear_shape_function(xi, v) * share;
            for (const auto &[node, weight] : weights)
              result.back().nodes.push_back({node, weight});
            result.back().distance = other.position(xi) - place.position;
            if (pair.normals != nullptr)
              result.back().distance += other.bulge(xi);
            result.back().softness = other.softness;
            break;
          }
      }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(mortar_interpolation);
  VISCOPLASTIC_INSTANTIATE(places_opposite);
} // namespace Viscoplastic
