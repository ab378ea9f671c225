// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/exceptions.h>
#include <deal.II/base/geometry_info.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/lac/full_matrix.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

// Faces of two bodies in the plane perpendicular to a normal: reference
// coordinates, intersections, and dual basis functions; and faces of curved
// surfaces.

namespace Viscoplastic
{
  using namespace dealii;

  /// A face projected along a normal: d-linear in the perpendicular plane.
  template <int d>
  using PlaneFace = std::array<Point<d>, GeometryInfo<d>::vertices_per_cell>;

  template <int d>
  using Simplex = std::array<Point<d>, d + 1>;



  /// The projection onto coordinates in the plane perpendicular to a normal.
  template <int dim>
  class Projection
  {
  public:
    explicit Projection(const Tensor<1, dim> &normal)
    {
      if constexpr (dim == 2)
        axes[0] = cross_product_2d(normal);
      else
        {
          unsigned int least = 0;
          for (unsigned int d = 1; d < dim; ++d)
            if (std::abs(normal[d]) < std::abs(normal[least]))
              least = d;
          axes[0] = cross_product_3d(normal, Point<dim>::unit_vector(least));
          axes[0] /= axes[0].norm();
          axes[1] = cross_product_3d(normal, axes[0]);
        }
    }

    Point<dim - 1>
    operator()(const Point<dim> &x) const
    {
      Point<dim - 1> result;
      for (unsigned int i = 0; i < dim - 1; ++i)
        result[i] = axes[i] * x;
      return result;
    }

  private:
    std::array<Tensor<1, dim>, dim - 1> axes;
  };



  /// A face of a surface with a normal at each vertex; between vertices,
  /// normals are interpolated like positions and normalized.
  template <int dim>
  struct SurfaceFace
  {
    static constexpr unsigned int n = GeometryInfo<dim>::vertices_per_face;

    std::array<Point<dim>, n>     vertices;
    std::array<Tensor<1, dim>, n> normals;
    /// The vectors from the vertices of the face to the curved surface: not
    /// zero at hanging nodes, which lie in the middle of an edge.
    std::array<Tensor<1, dim>, n> lifts;

    Point<dim>
    position(const Point<dim - 1> &xi) const
    {
      Point<dim> x;
      for (unsigned int v = 0; v < n; ++v)
        x += phi(v, xi) * vertices[v];
      return x;
    }

    Tensor<1, dim>
    normal(const Point<dim - 1> &xi) const
    {
      Tensor<1, dim> result;
      for (unsigned int v = 0; v < n; ++v)
        result += phi(v, xi) * normals[v];
      return result / result.norm();
    }

    /// The vector from the face to the surface: half of the way to the tangent
    /// planes at the vertices (Boubekeur and Alexa, ACM Trans. Graphics 27,
    /// 2008), which is exact for quadrics.
    Tensor<1, dim>
    bulge(const Point<dim - 1> &xi) const
    {
      Tensor<1, dim> lift;
      for (unsigned int v = 0; v < n; ++v)
        lift += phi(v, xi) * lifts[v];
      const Point<dim> x      = position(xi) + lift;
      Tensor<1, dim>   result = lift;
      for (unsigned int v = 0; v < n; ++v)
        result -= 0.5 * phi(v, xi) *
                  ((x - vertices[v] - lifts[v]) * normals[v]) * normals[v];
      return result;
    }

    /// The place on the face from which @p x lies along the normal, or beyond
    /// the face along the normal at its edge. Coordinates are in the plane
    /// perpendicular to @p axis, in which the face is @p seen.
    Point<dim - 1>
    foot_of(const Point<dim>         &x,
            const Tensor<1, dim>     &axis,
            const PlaneFace<dim - 1> &seen) const;

    /// The face projected along a direction.
    PlaneFace<dim - 1>
    seen(const Projection<dim> &along) const
    {
      PlaneFace<dim - 1> result;
      for (unsigned int v = 0; v < n; ++v)
        result[v] = along(vertices[v]);
      return result;
    }

  private:
    static double
    phi(const unsigned int v, const Point<dim - 1> &xi)
    {
      return GeometryInfo<dim - 1>::d_linear_shape_function(xi, v);
    }
  };



  /// A step of Newton's method for the reference coordinates of a place.
  template <int d>
  Tensor<1, d>
  reference_step(const PlaneFace<d> &face,
                 const Point<d>     &x,
                 const Point<d>     &xi)
  {
    Tensor<1, d> residual = x;
    Tensor<2, d> jacobian;
    for (unsigned int v = 0; v < face.size(); ++v)
      {
        residual -= GeometryInfo<d>::d_linear_shape_function(xi, v) * face[v];
        jacobian +=
          outer_product(Tensor<1, d>(face[v]),
                        GeometryInfo<d>::d_linear_shape_function_gradient(xi,
                                                                          v));
      }
    return invert(jacobian) * residual;
  }



  template <int d>
  Point<d>
  reference_center()
  {
    Point<d> xi;
    for (unsigned int i = 0; i < d; ++i)
      xi[i] = 0.5;
    return xi;
  }



  template <int d>
  Point<d>
  reference_position(const PlaneFace<d> &face, const Point<d> &x)
  {
    Point<d> xi = reference_center<d>();
    // One step is exact on parallelograms. After a step of 1e-8, the error is
    // its square, below the rounding of small faces far from the origin.
    double change = 1.;
    for (unsigned int n = 0; change > 1e-8; ++n)
      {
        AssertThrow(n < 50,
                    ExcMessage("A face on an interface between two bodies is "
                               "too distorted."));
        const Tensor<1, d> step = reference_step(face, x, xi);
        xi += step;
        change = step.norm();
      }
    return xi;
  }



  /// The reference position of the place of the face nearest to @p x.
  template <int d>
  Point<d>
  nearest_reference_position(const PlaneFace<d> &face, const Point<d> &x)
  {
    Point<d> xi     = reference_center<d>();
    double   change = 1.;
    for (unsigned int n = 0; n < 20 && change > 1e-8; ++n)
      {
        const Point<d> next = GeometryInfo<d>::project_to_unit_cell(
          xi + reference_step(face, x, xi));
        change = (next - xi).norm();
        xi     = next;
      }
    return xi;
  }



  template <int dim>
  Point<dim - 1>
  SurfaceFace<dim>::foot_of(const Point<dim>         &x,
                            const Tensor<1, dim>     &axis,
                            const PlaneFace<dim - 1> &seen) const
  {
    const Projection<dim> along(axis);
    const double          size = (vertices[n - 1] - vertices[0]).norm();
    Point<dim - 1>        foot = along(x);
    // Going along the normal at the last foot reduces the error by the distance
    // over the radius of curvature.
    double change = size;
    for (unsigned int i = 0; i < 50 && change > 1e-12 * size; ++i)
      {
        const Point<dim - 1> xi = nearest_reference_position(seen, foot);
        const Tensor<1, dim> along_normal = normal(xi);
        const double         distance =
          ((x - position(xi)) * axis) / (along_normal * axis);
        const Point<dim - 1> next = along(x - distance * along_normal);
        change                    = (next - foot).norm();
        foot                      = next;
      }
    return foot;
  }



  /// Whether a place is on a face, or beside it by rounding.
  inline bool
  contains(const PlaneFace<1> &face, const Point<1> &x)
  {
    const double rounding = 1e-10 * std::abs(face[1][0] - face[0][0]);
    return x[0] >= std::min(face[0][0], face[1][0]) - rounding &&
           x[0] <= std::max(face[0][0], face[1][0]) + rounding;
  }



  inline std::vector<Simplex<1>>
  intersection(const PlaneFace<1> &a, const PlaneFace<1> &b)
  {
    const double begin = std::max(std::min(a[0][0], a[1][0]),
                                  std::min(b[0][0], b[1][0])),
                 end   = std::min(std::max(a[0][0], a[1][0]),
                                std::max(b[0][0], b[1][0]));
    if (end <= begin)
      return {};
    Simplex<1> part;
    part[0][0] = begin;
    part[1][0] = end;
    return {part};
  }



  /// Twice the signed area of a triangle.
  inline double
  area(const Point<2> &a, const Point<2> &b, const Point<2> &c)
  {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  }



  /// Whether a place is on a convex face, or beside it by rounding.
  inline bool
  contains(const PlaneFace<2> &face, const Point<2> &x)
  {
    const std::array<Point<2>, 4> corners{{face[0], face[1], face[3], face[2]}};
    const double                  whole = area(face[0], face[1], face[3]);
    for (unsigned int e = 0; e < 4; ++e)
      if (area(corners[e], corners[(e + 1) % 4], x) / whole < -1e-10)
        return false;
    return true;
  }



  /// Clip one convex quadrilateral at the edges of the other (Sutherland and
  /// Hodgman, Comm. ACM 17, 1974), which is robust to rounding where edges
  /// coincide, and cut the rest into triangles.
  inline std::vector<Simplex<2>>
  intersection(const PlaneFace<2> &a, const PlaneFace<2> &b)
  {
    std::vector<Point<2>>   polygon{a[0], a[1], a[3], a[2]};
    std::array<Point<2>, 4> window{{b[0], b[1], b[3], b[2]}};
    if (area(b[0], b[1], b[3]) < 0.)
      std::reverse(window.begin(), window.end());
    for (unsigned int e = 0; e < 4; ++e)
      {
        const auto side = [&](const Point<2> &x) {
          return area(window[e], window[(e + 1) % 4], x);
        };
        std::vector<Point<2>> rest;
        for (std::size_t i = 0; i < polygon.size(); ++i)
          {
            const Point<2> &p = polygon[i],
                           &q = polygon[(i + 1) % polygon.size()];
            const double at_p = side(p), at_q = side(q);
            if (at_p >= 0.)
              rest.push_back(p);
            if ((at_p > 0. && at_q < 0.) || (at_p < 0. && at_q > 0.))
              rest.push_back(p + at_p / (at_p - at_q) * (q - p));
          }
        polygon = rest;
      }
    std::vector<Simplex<2>> result;
    for (std::size_t i = 2; i < polygon.size(); ++i)
      result.push_back({{polygon[0], polygon[i - 1], polygon[i]}});
    return result;
  }



  inline double
  measure(const Simplex<1> &s)
  {
    return std::abs(s[1][0] - s[0][0]);
  }

  inline double
  measure(const Simplex<2> &s)
  {
    return std::abs(area(s[0], s[1], s[2])) / 2.;
  }



  inline double
  measure(const PlaneFace<2> &face)
  {
    return std::abs(area(face[0], face[1], face[3]) +
                    area(face[0], face[3], face[2])) /
           2.;
  }



  /// Dual basis functions psi_i on a face: their coefficients in the phi_j, and
  /// the integrals of phi_i, by a quadrature in reference coordinates. With any
  /// quadrature, linear functions are reproduced exactly.
  template <int d>
  struct DualBasis
  {
    static constexpr unsigned int n = GeometryInfo<d>::vertices_per_cell;

    /// @p visit calls its argument with each point and its weight.
    template <typename Visit>
    explicit DualBasis(const Visit &visit)
      : coefficients(n, n)
    {
      FullMatrix<double> mass(n, n);
      integrals.fill(0.);
      visit([&](const Point<d> &xi, const double JxW) {
        for (unsigned int i = 0; i < n; ++i)
          {
            const double phi = GeometryInfo<d>::d_linear_shape_function(xi, i);
            integrals[i] += phi * JxW;
            for (unsigned int j = 0; j < n; ++j)
              mass(i, j) +=
                phi * GeometryInfo<d>::d_linear_shape_function(xi, j) * JxW;
          }
      });
      mass.gauss_jordan();
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          coefficients(i, j) = integrals[i] * mass(i, j);
    }

    double
    value(const unsigned int i, const Point<d> &xi) const
    {
      double result = 0.;
      for (unsigned int j = 0; j < n; ++j)
        result +=
          coefficients(i, j) * GeometryInfo<d>::d_linear_shape_function(xi, j);
      return result;
    }

    FullMatrix<double>    coefficients;
    std::array<double, n> integrals;
  };
} // namespace Viscoplastic
