// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output_grid.h"
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/solution_errors.h>
#include <viscoplastic_contact/error/space_estimator.h>
#include <viscoplastic_contact/results/boundary_fields.h>
#include <viscoplastic_contact/results/output.h>

#include <chrono>

namespace Viscoplastic
{
  template <int dim>
  Output<dim>::Output(const Scene<dim> &scene, const MPI_Comm communicator)
    : scene(scene)
    , communicator(communicator)
    , path(results_directory(scene.parameters))
  {
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      refuse_foreign_files();
      write_record<dim>(scene,
                        path,
                        Utilities::MPI::n_mpi_processes(communicator),
                        nullptr);
    });
  }



  template <int dim>
  void
  Output<dim>::record_end(const RunEnd<dim> &end) const
  {
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      write_record(scene,
                   path,
                   Utilities::MPI::n_mpi_processes(communicator),
                   &end);
      remove_unlisted_files();
    });
  }



  template <int dim>
  bool
  Output<dim>::is_due(const TimeStep &step) const
  {
    if (step.n == 0 || step.t >= scene.schedule.end_time())
      return true;
    const OutputParameters &parameters = scene.parameters.output;
    if (parameters.fields_interval > 0.)
      {
        // Whether the step passes a multiple of the interval, up to rounding.
        const double slack = 1e-9 * scene.schedule.end_time();
        return std::floor((step.t + slack) / parameters.fields_interval) >
               std::floor((step.t_old + slack) / parameters.fields_interval);
      }
    return parameters.fields_every > 0 && step.n % parameters.fields_every == 0;
  }



  template <int dim>
  void
  Output<dim>::write_fields(const FlowLaws<dim>    &laws,
                            const State<dim>       &state,
                            const ContactFace<dim> *face,
                            const Vector<double>   *squared_estimate)
  {
    finish();
    times.push_back(state.t);
    if (times.size() == 1)
      write_boundary(laws.stress_space.space);
    write_body(laws, state, squared_estimate);
    if (scene.has_contact())
      write_contact("contact", laws.stress_space, state, face);
    if (scene.has_contact_pairs())
      write_contact("opposite", laws.stress_space, state, face);
    write_in_background();
  }



  template <int dim>
  void
  Output<dim>::write_in_background()
  {
    auto to_write = std::exchange(files, {});
    if (Utilities::MPI::n_mpi_processes(communicator) == 1)
      {
        // Where no thread is to be had, finish() writes.
        writing = std::async(std::launch::async | std::launch::deferred,
                             [to_write]() mutable {
                               for (auto &write : to_write) // frees the data
                                 std::exchange(write, nullptr)();
                             });
        return;
      }
    // One at a time, since ranks write some of the files together.
    for (const auto &write : to_write)
      fail_together(communicator, write);
  }



  template <int dim>
  void
  Output<dim>::report_failure()
  {
    if (writing.valid() &&
        writing.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
      writing.get();
  }



  template <int dim>
  template <typename Grid>
  void
  Output<dim>::write_vtu(const std::string &name,
                         Grid               grid,
                         const bool         is_series)
  {
    // Like DataOutInterface::write_vtu_with_pvtu_record(), whose errors do not
    // name the file.
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    const unsigned int rank    = Utilities::MPI::this_mpi_process(communicator);
    const std::string  record  = record_name(name, times.size() - 1);
    std::vector<std::string> pieces;
    for (unsigned int r = 0; r < n_ranks; ++r)
      pieces.push_back(
        record + '.' +
        Utilities::int_to_string(r, Utilities::needed_digits(n_ranks - 1)) +
        ".vtu");
    const auto of_series = is_series ? list(name) : decltype(list(name))();
    files.push_back([grid = std::make_shared<Grid>(std::move(grid)),
                     path = path,
                     record,
                     pieces,
                     of_series,
                     rank]() {
      unsigned int n = 0;
      replace_file(path + pieces[rank], [&]() { return grid->vtu_part(n++); });
      if (rank != 0)
        return;
      replace_file(path + record + ".pvtu", grid->pvtu_record(pieces));
      if (const auto &[file, text] = of_series; !file.empty())
        replace_file(file, text);
    });
  }



  template <int dim>
  void
  Output<dim>::write_boundary(const AdmissibleSpace<dim> &space)
  {
    OutputGrid<dim - 1, dim> grid;
    grid.add_field(scene, {"boundary_id", 0, Quantity::pure_number}, true);
    for (const auto &cell : space.cells)
      for (const auto &face : cell->face_iterators())
        if (face->at_boundary())
          {
            for (const unsigned int v : face->vertex_indices())
              grid.add_vertex(face->vertex(v));
            grid.fields[0].values.push_back(face->boundary_id());
          }
    write_vtu("boundary", std::move(grid), /* is_series = */ false);
  }



  template <int dim>
  void
  Output<dim>::write_body(const FlowLaws<dim>  &laws,
                          const State<dim>     &state,
                          const Vector<double> *squared_estimate)
  {
    const StressSpace<dim>     &stress_space = laws.stress_space;
    const AdmissibleSpace<dim> &space        = stress_space.space;
    DistributedVector           difference;
    OutputGrid<dim, dim>        grid;
    grid.points.resize(space.relevant.n_elements() / dim);
    const auto add_vector = [&](const RecordedField      field,
                                const DistributedVector &values) {
      grid.add_field(scene, column_of(field), /* is_of_cells = */ false);
      grid.fields.back().values.assign(values.begin(),
                                       values.begin() +
                                         grid.points.size() * dim);
    };
    add_vector(RecordedField::displacement,
               reported_displacement(scene, state, difference));
    add_vector(RecordedField::velocity, state.velocity);

    // All ranks need the same fields, including ranks without cells.
    const std::set<RecordedField> fields = BodyFields<dim>::of_output(scene);
    const BodyFields<dim>         means(laws, state, fields);
    const std::size_t             n_vectors = grid.fields.size();
    for (const FieldColumn &column : columns_of<dim>(fields, false))
      grid.add_field(scene, column, /* is_of_cells = */ true);
    grid.add_field(scene, {"subdomain", 0, Quantity::pure_number}, true);
    std::vector<typename DoFHandler<dim>::active_cell_iterator> present;
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      {
        const auto &cell       = space.cells[c];
        const bool  is_present = scene.is_present(cell->material_id());
        for (const unsigned int v : cell->vertex_indices())
          {
            const unsigned int node = stress_space.nodes_of_cell(c)[v] / dim;
            grid.points[node]       = cell->vertex(v);
            if (is_present)
              grid.vertices.push_back(node);
          }
        if (!is_present)
          continue;
        auto field = grid.fields.begin() + n_vectors;
        for (const double mean : means.means(c))
          (field++)->values.push_back(mean);
        field->values.push_back(cell->subdomain_id());
        present.push_back(cell);
      }
    const auto add_root = [&](const std::string    &name,
                              const Quantity        quantity,
                              const Vector<double> &squares) {
      grid.add_field(scene, {name, 0, quantity}, /* is_of_cells = */ true);
      for (const auto &cell : present)
        grid.fields.back().values.push_back(
          std::sqrt(squares[cell->active_cell_index()]));
    };
    if (squared_estimate != nullptr)
      add_root("estimator", quantity_of_estimator(scene), *squared_estimate);
    if (scene.exact_solution)
      {
        add_root(
          "error_energy",
          Quantity::energy_norm,
          solution_errors(stress_space, state, nullptr).squared_energy_by_cell);
        add_root("recovery",
                 Quantity::energy_norm,
                 squared_recovery_estimate(stress_space, state));
      }

    if constexpr (dim == 2)
      if (const double degrees = scene.parameters.output.revolved_angle;
          degrees > 0.)
        {
          std::vector<std::pair<std::size_t, unsigned int>> edges;
          for (std::size_t c = 0; c < present.size(); ++c)
            for (const unsigned int f : present[c]->face_indices())
              if (!is_on_axis(present[c]->face(f)) &&
                  (present[c]->at_boundary(f) ||
                   !scene.is_present(present[c]->neighbor(f)->material_id())))
                edges.emplace_back(c, f);
          write_vtu("revolved", revolved(grid, edges, degrees));
        }
    if (is_in_hdf5("solution"))
      write_in_hdf5(space, grid, state.t);
    else
      write_vtu("solution", std::move(grid));
  }



  template <int dim>
  void
  Output<dim>::write_contact(const std::string      &name,
                             const StressSpace<dim> &stress_space,
                             const State<dim>       &state,
                             const ContactFace<dim> *face)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    std::set<RecordedField>     fields =
      BoundaryFields<dim>::of_output(scene, face);
    const BoundaryFields<dim> boundary(stress_space, state, face, fields);
    DistributedVector         difference;
    const DistributedVector  &reported =
      reported_displacement(scene, state, difference);
    OutputGrid<dim - 1, dim> grid;
    fields.insert(RecordedField::displacement); // the first one
    for (const RecordedField field : fields)
      grid.add_field(scene, column_of(field), /* is_of_cells = */ false);

    for (std::size_t c = 0; c < space.cells.size(); ++c)
      for (const unsigned int f : space.cells[c]->face_indices())
        {
          const auto cell_face = space.cells[c]->face(f);
          if (!cell_face->at_boundary() ||
              !scene.is_present(space.cells[c]->material_id()))
            continue;
          const auto     id       = cell_face->boundary_id();
          Tensor<1, dim> normal   = boundary.condition_at(id).normal;
          const bool     is_other = scene.is_other_side(id);
          if (is_other)
            normal *= -1.;
          if (name == "opposite" ?
                !is_other :
                space.scene.boundary.at(id).role != BoundaryRole::contact)
            continue;
          for (unsigned int i = 0; i < cell_face->n_vertices(); ++i)
            {
              const unsigned int v =
                GeometryInfo<dim>::face_to_cell_vertices(f, i);
              grid.add_vertex(space.cells[c]->vertex(v));
              const double *u =
                reported.begin() + stress_space.nodes_of_cell(c)[v];
              std::vector<double> values = boundary.values(c, f, v, normal);
              values.insert(values.begin(), u, u + dim);
              const double *value = values.data();
              for (OutputField &field : grid.fields)
                for (unsigned int d = 0; d < (field.is_vector ? dim : 1); ++d)
                  field.values.push_back(*value++);
            }
        }
    std::stable_partition(grid.fields.begin(),
                          grid.fields.end(),
                          [](const auto &field) { return field.is_vector; });
    write_vtu(name, std::move(grid));
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(Output);
} // namespace Viscoplastic
