// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/numerics/rtree.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/cell_order.h>
#include <viscoplastic_contact/mesh/point_location.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    namespace bgi = boost::geometry::index;

    /// The tolerance for rounding errors by which a point may be outside of the
    /// unit cell, in reference coordinates.
    constexpr double slack = 1e-8;



    /// A search tree of points for queries by boxes.
    template <int dim>
    class PointTree
    {
    public:
      explicit PointTree(const std::vector<Point<dim>> &points)
      {
        std::vector<std::pair<Point<dim>, std::size_t>> numbered;
        for (std::size_t i = 0; i < points.size(); ++i)
          numbered.emplace_back(points[i], i);
        tree = pack_rtree(numbered);
      }

      /// Call visit(number) for the points in the bounding box of vertices.
      template <typename Vertices, typename Function>
      void
      for_each_near(const Vertices &vertices, const Function &visit) const
      {
        BoundingBox<dim> box(vertices);
        double           size = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          size = std::max(size, box.side_length(d));
        box.extend(1e-6 * size);
        std::vector<std::pair<Point<dim>, std::size_t>> found;
        tree.query(bgi::intersects(box), std::back_inserter(found));
        for (const auto &pair : found)
          visit(pair.second);
      }

    private:
      RTree<std::pair<Point<dim>, std::size_t>> tree;
    };



    /// The candidate of this rank for the cell of a point; over all ranks, the
    /// candidate with the least key is chosen.
    template <int dim>
    struct Candidate
    {
      /// The distance, then the center of the cell or face.
      std::array<double, dim + 1> key;
      CellPoint<dim>              place;

      Candidate()
      {
        key.fill(std::numeric_limits<double>::infinity());
      }

      void
      offer(const double          distance,
            const Point<dim>     &center,
            const CellPoint<dim> &at)
      {
        std::array<double, dim + 1> offered;
        offered[0] = distance;
        std::copy(center.begin_raw(), center.end_raw(), offered.begin() + 1);
        if (offered < key)
          {
            key   = offered;
            place = at;
          }
      }
    };



    /// Assign each point to the rank with the least key. Collective.
    template <int dim>
    PointLocations<dim>
    elect(const std::vector<Candidate<dim>> &candidates, const MPI_Comm comm)
    {
      const std::size_t   n = candidates.size();
      PointLocations<dim> result;
      result.distances.resize(n);
      std::vector<bool>   wins(n, true);
      std::vector<double> own(n), least(n);
      for (unsigned int k = 0; k <= dim; ++k)
        {
          for (std::size_t i = 0; i < n; ++i)
            own[i] = wins[i] ? candidates[i].key[k] :
                               std::numeric_limits<double>::infinity();
          Utilities::MPI::min(own, comm, least);
          for (std::size_t i = 0; i < n; ++i)
            wins[i] = wins[i] && own[i] == least[i];
          if (k == 0)
            result.distances = least;
        }
      for (std::size_t i = 0; i < n; ++i)
        result.points.push_back(wins[i] && candidates[i].place.is_mine() ?
                                  candidates[i].place :
                                  CellPoint<dim>());
      return result;
    }



    /// Return a point of the face with these vertices.
    template <int dim>
    Point<dim>
    interpolate(const std::vector<Point<dim>> &vertices,
                const Point<dim - 1>          &unit)
    {
      Point<dim> result;
      for (unsigned int v = 0; v < vertices.size(); ++v)
        result +=
          GeometryInfo<dim - 1>::d_linear_shape_function(unit, v) * vertices[v];
      return result;
    }



    /// Return the point of a face that is nearest to x, in unit coordinates.
    template <int dim>
    Point<dim - 1>
    nearest_on_face(const std::vector<Point<dim>> &vertices,
                    const Point<dim>              &x)
    {
      // A face is straight in each coordinate: minimize over one at a time.
      Point<dim - 1> unit;
      for (unsigned int d = 0; d < dim - 1; ++d)
        unit[d] = 0.5;
      for (unsigned int sweep = 0; sweep < (dim == 2 ? 1 : 100); ++sweep)
        {
          double change = 0.;
          for (unsigned int d = 0; d < dim - 1; ++d)
            {
              Point<dim - 1> begin = unit, end = unit;
              begin[d]                      = 0.;
              end[d]                        = 1.;
              const Point<dim>     at_begin = interpolate(vertices, begin);
              const Tensor<1, dim> edge = interpolate(vertices, end) - at_begin;
              const double         new_value = std::min(
                1., std::max(0., (x - at_begin) * edge / edge.norm_square()));
              change  = std::max(change, std::abs(new_value - unit[d]));
              unit[d] = new_value;
            }
          if (change < 1e-12)
            break;
        }
      // An unconverged result is still usable: each sweep reduces the distance,
      // which callers compute.
      return unit;
    }



    /// Return the CellPoint for a point of a face of a cell.
    template <int dim>
    CellPoint<dim>
    on_face(const std::size_t     cell,
            const unsigned int    f,
            const Point<dim - 1> &unit)
    {
      CellPoint<dim>     result;
      const unsigned int normal = f / 2;
      result.cell               = cell;
      result.face               = f;
      result.unit               = Point<dim>();
      // Use the cell's own numbering of the face, whatever its orientation.
      for (unsigned int v = 0; v < GeometryInfo<dim - 1>::vertices_per_cell;
           ++v)
        result.unit += GeometryInfo<dim - 1>::d_linear_shape_function(unit, v) *
                       GeometryInfo<dim>::unit_cell_vertex(
                         GeometryInfo<dim>::face_to_cell_vertices(f, v));
      result.unit[normal] = f % 2;
      return result;
    }



    /// Offer points the nearest place on each boundary face that is wanted: the
    /// points that for_each_near(vertices of the face, visit) visits by their
    /// numbers. With @p only_on_them, only points on the face.
    template <int dim, typename IsWanted, typename ForEachNear>
    void
    offer_faces(const Triangulation<dim>      &mesh,
                const std::vector<Point<dim>> &points,
                const IsWanted                &is_wanted,
                const ForEachNear             &for_each_near,
                const bool                     only_on_them,
                std::vector<Candidate<dim>>   &candidates)
    {
      const auto cells = owned_cells(mesh);
      for (std::size_t c = 0; c < cells.size(); ++c)
        for (const unsigned int f : cells[c]->face_indices())
          {
            const auto face = cells[c]->face(f);
            if (!face->at_boundary() || !is_wanted(face->boundary_id()))
              continue;
            // The vertices in the cell's own numbering of the face.
            std::vector<Point<dim>> vertices;
            for (unsigned int v = 0;
                 v < GeometryInfo<dim - 1>::vertices_per_cell;
                 ++v)
              vertices.push_back(cells[c]->vertex(
                GeometryInfo<dim>::face_to_cell_vertices(f, v)));
            const double size = vertices.front().distance(vertices.back());
            for_each_near(vertices, [&](const std::size_t i) {
              const Point<dim - 1> unit = nearest_on_face(vertices, points[i]);
              const Point<dim>     nearest  = interpolate(vertices, unit);
              double               distance = nearest.distance(points[i]);
              if (only_on_them)
                {
                  if (distance > slack * size)
                    return;
                  distance = 0.;
                }
              candidates[i].offer(distance,
                                  face->center(),
                                  on_face<dim>(c, f, unit));
            });
          }
    }
  } // namespace



  template <int dim>
  PointLocations<dim>
  locate_points(const Triangulation<dim>      &mesh,
                const std::vector<Point<dim>> &points,
                const MaterialFilter          &is_preferred)
  {
    const MappingQ1<dim>        mapping;
    const PointTree<dim>        tree(points);
    std::vector<Candidate<dim>> candidates(points.size());
    const auto                  cells = owned_cells(mesh);
    // The key has this number in place of a distance: 0 in preferred cells.
    const auto rank_of = [&is_preferred](const types::material_id id) {
      return !is_preferred || is_preferred(id) ?
               0. :
               std::numeric_limits<double>::min();
    };
    for (std::size_t c = 0; c < cells.size(); ++c)
      {
        const auto &cell = cells[c];
        std::array<Point<dim>, GeometryInfo<dim>::vertices_per_cell> vertices;
        for (const unsigned int v : cell->vertex_indices())
          vertices[v] = cell->vertex(v);
        tree.for_each_near(vertices, [&](const std::size_t i) {
          CellPoint<dim> place;
          try
            {
              place.unit = mapping.transform_real_to_unit_cell(cell, points[i]);
            }
          catch (const typename Mapping<dim>::ExcTransformationFailed &)
            {
              return; // far outside of a distorted cell
            }
          if (GeometryInfo<dim>::distance_to_unit_cell(place.unit) > slack)
            return;
          place.unit = GeometryInfo<dim>::project_to_unit_cell(place.unit);
          place.cell = c;
          candidates[i].offer(rank_of(cell->material_id()),
                              cell->center(),
                              place);
        });
      }
    const MPI_Comm      comm   = mesh.get_communicator();
    PointLocations<dim> result = elect(candidates, comm);
    for (double &distance : result.distances)
      if (distance <= std::numeric_limits<double>::min())
        distance = 0.;

    // Points outside of the mesh: few, if any.
    std::vector<std::size_t> outside;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (result.distances[i] > 0.)
        outside.push_back(i);
    if (outside.empty())
      return result;
    std::vector<Point<dim>> points_outside;
    for (const std::size_t i : outside)
      points_outside.push_back(points[i]);
    std::vector<Candidate<dim>> places(outside.size());
    offer_faces<dim>(
      mesh,
      points_outside,
      [](const types::boundary_id) { return true; },
      [&outside](const auto &, const auto &visit) {
        for (std::size_t i = 0; i < outside.size(); ++i)
          visit(i);
      },
      /* only_on_them = */ false,
      places);
    const PointLocations<dim> nearest = elect(places, comm);
    for (std::size_t i = 0; i < outside.size(); ++i)
      {
        result.points[outside[i]]    = nearest.points[i];
        result.distances[outside[i]] = nearest.distances[i];
      }
    return result;
  }



  template <int dim>
  PointLocations<dim>
  locate_on_boundary(const Triangulation<dim>           &mesh,
                     const std::vector<Point<dim>>      &points,
                     const std::set<types::boundary_id> &ids)
  {
    const PointTree<dim>        tree(points);
    std::vector<Candidate<dim>> candidates(points.size());
    offer_faces<dim>(
      mesh,
      points,
      [&ids](const types::boundary_id id) { return ids.count(id) == 1; },
      [&tree](const auto &vertices, const auto &visit) {
        tree.for_each_near(vertices, visit);
      },
      /* only_on_them = */ true,
      candidates);
    return elect(candidates, mesh.get_communicator());
  }



  template <int dim>
  void
  check_points(const Triangulation<dim>      &mesh,
               const std::vector<Point<dim>> &points,
               const std::string             &entry)
  {
    if (points.empty())
      return;
    const PointLocations<dim> found = locate_points(mesh, points);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (found.distances[i] > 0.)
        {
          Tensor<1, dim> place;
          if (found.points[i].is_mine())
            {
              const auto cells = owned_cells(mesh);
              place            = MappingQ1<dim>().transform_unit_to_real_cell(
                cells[found.points[i].cell], found.points[i].unit);
            }
          place = Utilities::MPI::sum(place, mesh.get_communicator());
          refuse("'" + entry + "': the point (" + as_text(points[i]) +
                 ") does not lie in the body; the nearest place that does is "
                 "(" +
                 as_text(place) + ").");
        }
  }



  VISCOPLASTIC_INSTANTIATE(locate_points);
  VISCOPLASTIC_INSTANTIATE(locate_on_boundary);
  VISCOPLASTIC_INSTANTIATE(check_points);
} // namespace Viscoplastic
