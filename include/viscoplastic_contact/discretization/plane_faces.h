// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/exceptions.h>
#include <deal.II/base/geometry_info.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/lac/full_matrix.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

// Faces of two bodies in the plane across a normal: where they are, what they
// have in common, and the dual basis functions on them.

namespace Viscoplastic
{
  using namespace dealii;

  /// A face seen along the normal: d-linear in the plane across it.
  template <int d>
  using PlaneFace = std::array<Point<d>, GeometryInfo<d>::vertices_per_cell>;

  template <int d>
  using Simplex = std::array<Point<d>, d + 1>;



  /// Coordinates across a normal.
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



  template <int d>
  BoundingBox<d>
  box_of(const PlaneFace<d> &face)
  {
    return BoundingBox<d>(std::vector<Point<d>>(face.begin(), face.end()));
  }



  /// The reference coordinates of a place on a face.
  template <int d>
  Point<d>
  reference_position(const PlaneFace<d> &face, const Point<d> &x)
  {
    Point<d> xi;
    for (unsigned int i = 0; i < d; ++i)
      xi[i] = 0.5;
    // Newton's method; one step where the face is a parallelogram. What a step
    // of this size leaves is its square, below the rounding of small faces far
    // from the origin.
    double change = 1.;
    for (unsigned int n = 0; change > 1e-8; ++n)
      {
        AssertThrow(n < 50,
                    ExcMessage("A face on an interface between two bodies is "
                               "too distorted."));
        Tensor<1, d> residual = x;
        Tensor<2, d> jacobian;
        for (unsigned int v = 0; v < face.size(); ++v)
          {
            residual -=
              GeometryInfo<d>::d_linear_shape_function(xi, v) * face[v];
            jacobian += outer_product(
              Tensor<1, d>(face[v]),
              GeometryInfo<d>::d_linear_shape_function_gradient(xi, v));
          }
        const Tensor<1, d> step = invert(jacobian) * residual;
        xi += step;
        change = step.norm();
      }
    return xi;
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



  /// See above; of convex faces.
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



  /**
   * Clip one convex quadrilateral at the edges of the other (Sutherland and
   * Hodgman, Comm. ACM 17, 1974), which rounding does not trouble where edges
   * coincide, and cut the rest into triangles.
   */
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



  /// Dual basis functions on a face: coefficients of psi_i in phi_j, and the
  /// integrals of phi_i.
  template <int d>
  struct DualBasis
  {
    static constexpr unsigned int n = GeometryInfo<d>::vertices_per_cell;

    explicit DualBasis(const PlaneFace<d> &face)
      : coefficients(n, n)
    {
      FullMatrix<double> mass(n, n);
      integrals.fill(0.);
      const QGauss<d> quadrature(2);
      for (unsigned int q = 0; q < quadrature.size(); ++q)
        {
          const Point<d> &xi = quadrature.point(q);
          Tensor<2, d>    jacobian;
          for (unsigned int v = 0; v < n; ++v)
            jacobian += outer_product(
              Tensor<1, d>(face[v]),
              GeometryInfo<d>::d_linear_shape_function_gradient(xi, v));
          const double JxW =
            std::abs(determinant(jacobian)) * quadrature.weight(q);
          for (unsigned int i = 0; i < n; ++i)
            {
              const double phi =
                GeometryInfo<d>::d_linear_shape_function(xi, i);
              integrals[i] += phi * JxW;
              for (unsigned int j = 0; j < n; ++j)
                mass(i, j) +=
                  phi * GeometryInfo<d>::d_linear_shape_function(xi, j) * JxW;
            }
        }
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
