// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/nodal_frame.h>

namespace Viscoplastic
{
  namespace
  {
    /// Directions closer than this (sine of the angle) count as one.
    constexpr double parallel_tolerance = 1e-6;



    /// An orthonormal set of directions that grows.
    template <int dim>
    struct Basis
    {
      std::vector<Tensor<1, dim>> directions;

      /// Orthonormalize and add @p v; false if it depends on the others.
      bool
      add(Tensor<1, dim> v)
      {
        for (unsigned int pass = 0; pass < 2; ++pass) // twice is enough
          for (const auto &q : directions)
            v -= (v * q) * q;
        if (v.norm() < parallel_tolerance)
          return false;
        directions.push_back(v / v.norm());
        return true;
      }
    };



    template <int dim>
    bool
    is_axis(const Tensor<1, dim> &v)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (std::abs(v[d]) == 1.)
          return true;
      return false;
    }



    /// Whether components of a frame are free: no condition fixes them.
    template <int dim>
    std::array<bool, dim>
    free_directions(const NodalFrame<dim> &frame)
    {
      std::array<bool, dim> is_free;
      is_free.fill(true);
      for (unsigned int i = 0; i < frame.n_fixed; ++i)
        is_free[frame.fixed[i]] = false;
      return is_free;
    }



    /// Whether the foundations of two pieces that leave the same slip at a node
    /// move alike there.
    template <int dim>
    bool
    move_alike(const NodalFrame<dim>        &frame,
               const BoundaryCondition<dim> &a,
               const BoundaryCondition<dim> &b)
    {
      if (!a.foundation_motion && !b.foundation_motion)
        return true;
      if (!a.foundation_motion || !b.foundation_motion ||
          !a.foundation_motion->is_written_as(*b.foundation_motion))
        return false;
      // The same motion of pieces at an angle is the same slip if free
      // directions have the same tangential part on both.
      const auto is_free = free_directions(frame);
      for (unsigned int i = 0; i < dim; ++i)
        if (const auto e = column(frame.directions, i);
            is_free[i] &&
            (tangential(e, a.normal) - tangential(e, b.normal)).norm() > 1e-10)
          return false;
      return true;
    }



    /// The friction point of a piece with normal @p nu at a node with the given
    /// frame; without tangents if the other conditions leave no slip.
    template <int dim>
    FrictionPlane<dim>
    make_plane(const NodalFrame<dim>   &frame,
               const Tensor<1, dim>    &nu,
               const types::boundary_id id,
               SymmetricTensor<2, dim> &form)
    {
      // abs(slip)^2 as a quadratic form of the free frame components.
      form               = 0.;
      const auto is_free = free_directions(frame);
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = i; j < dim; ++j)
          if (is_free[i] && is_free[j])
            {
              const auto a = column(frame.directions, i);
              const auto b = column(frame.directions, j);
              form[i][j]   = a * b - (a * nu) * (b * nu);
              if (std::abs(form[i][j]) < 1e-14)
                form[i][j] = 0.;
            }

      FrictionPlane<dim> plane;
      plane.n_tangents   = 0;
      plane.boundary_ids = {id};
      bool is_diagonal   = true;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = i + 1; j < dim; ++j)
          is_diagonal &= form[i][j] == 0.;
      const auto add_row = [&plane](const Tensor<1, dim> &row) {
        AssertIndexRange(plane.n_tangents, dim - 1);
        plane.map[plane.n_tangents++] = row;
      };
      if (is_diagonal)
        {
          for (unsigned int i = 0; i < dim; ++i)
            if (form[i][i] > parallel_tolerance)
              add_row(std::sqrt(form[i][i]) * Point<dim>::unit_vector(i));
        }
      else
        {
          for (const auto &[value, vector] : eigenvectors(form))
            if (value > parallel_tolerance)
              add_row(std::sqrt(value) * vector);
        }
      return plane;
    }



    template <int dim>
    Obstacle<dim>
    make_obstacle(const NodalFrame<dim> &frame, const Tensor<1, dim> &normal)
    {
      Obstacle<dim> result;
      for (unsigned int i = 0; i < dim; ++i)
        {
          const double along = normal * column(frame.directions, i);
          if (std::abs(along) > 1e-12)
            result.map[i] = along;
        }
      for (unsigned int i = 0; i < frame.n_fixed; ++i)
        std::swap(result.map[frame.fixed[i]], result.fixed[frame.fixed[i]]);
      return result;
    }



    template <int dim>
    using Conditions = std::vector<const BoundaryCondition<dim> *>;



    /// The normal of a piece at a node: @p varying for curved pieces.
    template <int dim>
    const Tensor<1, dim> &
    normal_of(const BoundaryCondition<dim> &condition,
              const Tensor<1, dim>         &varying)
    {
      return condition.normal_varies ? varying : condition.normal;
    }



    /// Set the directions that conditions fix, in @p frame and as the first
    /// ones of @p basis. Where conditions compete, those that fix more come
    /// first.
    template <int dim>
    void
    fix_directions(const Conditions<dim> &conditions,
                   const Tensor<1, dim>  &varying_normal,
                   NodalFrame<dim>       &frame,
                   Basis<dim>            &basis)
    {
      const auto require = [&](const Tensor<1, dim>    &direction,
                               const types::boundary_id id,
                               const unsigned int       component) {
        if (!basis.add(direction))
          return;
        frame.condition_direction[frame.n_fixed] = direction;
        frame.condition_boundary[frame.n_fixed]  = id;
        frame.condition_component[frame.n_fixed] = component;
        ++frame.n_fixed;
      };
      const auto require_axes = [&](const auto &which, const auto &has_axis) {
        for (const auto *condition : conditions)
          if (which(*condition))
            for (unsigned int d = 0; d < dim; ++d)
              if (has_axis(*condition, d))
                require(Point<dim>::unit_vector(d), condition->id, d);
      };
      const auto all_axes = [](const auto &, const unsigned int) {
        return true;
      };
      const auto prescribed = [](const auto &condition, const unsigned int d) {
        return condition.displacement[d].has_value();
      };
      require_axes([](
                     const auto &c) { return c.role == BoundaryRole::clamped; },
                   all_axes);
      require_axes([](const auto &c) { return c.id < first_support_id; },
                   prescribed);
      require_axes([](const auto &c) { return c.is_glued() && !c.against; },
                   all_axes);
      for (const BoundaryRole role :
           {BoundaryRole::symmetry, BoundaryRole::contact})
        for (const auto *condition : conditions)
          if (condition->role == role && condition->is_bilateral() &&
              !condition->is_glued())
            require(normal_of(*condition, varying_normal),
                    condition->id,
                    numbers::invalid_unsigned_int);
      require_axes([](const auto &c) { return c.id >= first_support_id; },
                   prescribed);
      // Glue to another body only fixes what no other condition fixes.
      require_axes([](const auto &c) { return c.is_glued() && c.against; },
                   all_axes);
    }



    /// Complete the basis by the axes that are least represented.
    template <int dim>
    void
    complete(Basis<dim> &basis)
    {
      while (basis.directions.size() < dim)
        {
          unsigned int best   = 0;
          double       length = -1.;
          for (unsigned int d = 0; d < dim; ++d)
            {
              Tensor<1, dim> v = Point<dim>::unit_vector(d);
              for (const auto &q : basis.directions)
                v -= (v * q) * q;
              if (v.norm() > length)
                {
                  length = v.norm();
                  best   = d;
                }
            }
          basis.add(Point<dim>::unit_vector(best));
        }
    }



    /// The friction points of a node with this frame.
    template <int dim>
    void
    add_planes(const Conditions<dim> &conditions,
               const Tensor<1, dim>  &varying_normal,
               NodalFrame<dim>       &frame)
    {
      std::vector<SymmetricTensor<2, dim>> forms;
      Conditions<dim>                      first_of_point;
      for (const auto *condition : conditions)
        if (condition->has_friction())
          {
            SymmetricTensor<2, dim>  form;
            const FrictionPlane<dim> plane =
              make_plane(frame,
                         normal_of(*condition, varying_normal),
                         condition->id,
                         form);
            if (plane.n_tangents == 0)
              continue;
            // Pieces with the same slip share one point, if it is slip against
            // the same foundation.
            unsigned int p = 0;
            while (p < forms.size() &&
                   ((forms[p] - form).norm() > 1e-10 ||
                    !move_alike(frame, *first_of_point[p], *condition)))
              ++p;
            if (p < forms.size())
              frame.planes[p].boundary_ids.push_back(condition->id);
            else
              {
                forms.push_back(form);
                first_of_point.push_back(condition);
                frame.planes.push_back(plane);
              }
          }
    }



    /// The obstacles of a node with this frame.
    template <int dim>
    void
    add_obstacles(const Conditions<dim> &conditions,
                  const Tensor<1, dim>  &varying_normal,
                  NodalFrame<dim>       &frame)
    {
      for (const auto *condition : conditions)
        if (condition->is_unilateral())
          {
            Obstacle<dim> obstacle =
              make_obstacle(frame, normal_of(*condition, varying_normal));
            if (obstacle.map.norm() < parallel_tolerance)
              continue; // other conditions hold it
            obstacle.is_compliant = condition->has_normal_compliance();
            unsigned int o        = 0;
            while (o < frame.obstacles.size() &&
                   (obstacle.is_compliant != frame.obstacles[o].is_compliant ||
                    (frame.obstacles[o].map - obstacle.map).norm() > 1e-10))
              ++o;
            if (o == frame.obstacles.size())
              frame.obstacles.push_back(obstacle);
            frame.obstacles[o].boundary_ids.push_back(condition->id);
          }
    }
  } // namespace



  template <int dim>
  NodalFrame<dim>
  make_nodal_frame(
    const std::vector<const BoundaryCondition<dim> *> &conditions,
    const Tensor<1, dim>                              &varying_normal)
  {
    NodalFrame<dim> frame;
    Basis<dim>      basis;
    fix_directions(conditions, varying_normal, frame, basis);

    // The normals of pieces with given normal stress or unilateral contact come
    // next, so that the slip of a single piece is made of single components.
    bool all_axes = true;
    for (unsigned int i = 0; i < frame.n_fixed; ++i)
      all_axes &= is_axis(frame.condition_direction[i]);
    for (const auto *condition : conditions)
      if (condition->has_contact_points())
        {
          all_axes &= is_axis(normal_of(*condition, varying_normal));
          basis.add(normal_of(*condition, varying_normal));
        }

    if (all_axes || frame.n_fixed == dim)
      {
        frame.is_cartesian = true;
        frame.directions   = unit_symmetric_tensor<dim>();
        // Where all components are fixed, conditions may be oblique.
        for (unsigned int i = 0; i < frame.n_fixed; ++i)
          {
            frame.fixed[i] = i;
            for (unsigned int d = 0; frame.n_fixed < dim && d < dim; ++d)
              if (std::abs(frame.condition_direction[i][d]) == 1.)
                frame.fixed[i] = d;
          }
      }
    else
      {
        frame.is_cartesian = false;
        complete(basis);
        for (unsigned int j = 0; j < dim; ++j)
          for (unsigned int i = 0; i < dim; ++i)
            frame.directions[i][j] = basis.directions[j][i];
        for (unsigned int i = 0; i < frame.n_fixed; ++i)
          frame.fixed[i] = i;
      }
    add_planes(conditions, varying_normal, frame);
    add_obstacles(conditions, varying_normal, frame);
    return frame;
  }



  template <int dim>
  Tensor<2, dim>
  condition_matrix(const NodalFrame<dim> &frame)
  {
    Tensor<2, dim> matrix = unit_symmetric_tensor<dim>();
    for (unsigned int i = 0; i < frame.n_fixed; ++i)
      for (unsigned int j = 0; j < frame.n_fixed; ++j)
        matrix[i][j] = frame.condition_direction[i] *
                       column(frame.directions, frame.fixed[j]);
    return matrix;
  }



  VISCOPLASTIC_INSTANTIATE(make_nodal_frame);
  VISCOPLASTIC_INSTANTIATE(condition_matrix);
} // namespace Viscoplastic
