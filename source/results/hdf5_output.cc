// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output_grid.h"
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/output.h>

#include <filesystem>
#include <iomanip>
#include <numeric>
#include <sstream>
#include <variant>

#ifdef DEAL_II_WITH_HDF5
#  include <hdf5.h>
#endif

// Writes the body to HDF5 files, which all ranks write together, with a
// description in XDMF: vectors have values at nodes, means in cells. deal.II's
// write_hdf5_parallel() is not used: it calls MPI, which a thread must not,
// writes doubles, and reports a full disk in debug builds only.

namespace Viscoplastic
{
  /// The rows of a table on this rank; first_row counts the rows of all ranks.
  struct DataSet
  {
    std::string   name;
    std::uint64_t n_columns, first_row, n_rows;
    std::variant<std::vector<float>, std::vector<types::global_dof_index>>
                values;
    std::string label = {}; // of the unit

    bool
    operator==(const DataSet &other) const
    {
      return first_row == other.first_row && n_rows == other.n_rows &&
             values == other.values;
    }
  };



  namespace
  {
    /// Return the coordinates of nodes, and the nodes of cells in the order of
    /// ParaView. Collective.
    template <int dim>
    std::vector<DataSet>
    mesh_of(const AdmissibleSpace<dim> &space, const OutputGrid<dim, dim> &body)
    {
      const auto n_cells =
        Utilities::MPI::all_gather(space.communicator, body.n_cells());
      const auto own =
        n_cells.begin() + Utilities::MPI::this_mpi_process(space.communicator);
      std::vector<float>                   coordinates;
      std::vector<types::global_dof_index> nodes;
      for (const auto dof : space.owned)
        coordinates.push_back(
          body.points[space.relevant.index_within_set(dof) / dim][dof % dim]);
      for (std::size_t c = 0; c < body.n_cells(); ++c)
        for (const unsigned int v : paraview_order)
          if (v < body.n_vertices)
            nodes.push_back(space.relevant.nth_index_in_set(
                              body.vertices[c * body.n_vertices + v] * dim) /
                            dim);
      return {
        {"nodes",
         dim,
         space.owned.is_empty() ? 0 : *space.owned.begin() / dim,
         space.dof_handler.n_dofs() / dim,
         std::move(coordinates)},
        {"cells",
         body.n_vertices,
         std::accumulate(n_cells.begin(), own, std::uint64_t(0)),
         std::accumulate(n_cells.begin(), n_cells.end(), std::uint64_t(0)),
         std::move(nodes)}};
    }



    /// Return the vectors, with three components, and the cell means.
    template <int dim>
    std::vector<DataSet>
    fields_of(const AdmissibleSpace<dim> &space,
              const OutputGrid<dim, dim> &body,
              const std::vector<DataSet> &mesh)
    {
      std::vector<DataSet> result;
      for (const OutputField &field : body.fields)
        {
          const DataSet     &rows = mesh[field.is_vector ? 0 : 1];
          std::vector<float> values;
          if (field.is_vector)
            for (const auto dof : space.owned)
              {
                values.push_back(
                  field.values[space.relevant.index_within_set(dof)]);
                if (dim == 2 && dof % dim == 1)
                  values.push_back(0.f);
              }
          else
            values = field.values;
          result.push_back({field.name,
                            field.is_vector ? 3u : 1u,
                            rows.first_row,
                            rows.n_rows,
                            std::move(values),
                            field.label});
        }
      return result;
    }



#ifdef DEAL_II_WITH_HDF5
    /// An object of the HDF5 library, which is closed by the destructor.
    struct Handle
    {
      const hid_t id;
      herr_t (*const close)(hid_t);

      ~Handle()
      {
        if (id >= 0)
          close(id);
      }

      operator hid_t() const
      {
        return id;
      }
    };



    bool
    write(const hid_t file, const DataSet &set, const hid_t transfer)
    {
      const int     n_dims    = set.n_columns == 1 ? 1 : 2;
      const hsize_t all[2]    = {set.n_rows, set.n_columns},
                    first[2]  = {set.first_row, 0};
      const auto write_values = [&](const auto &values) {
        using Number       = std::decay_t<decltype(values[0])>;
        const hid_t   type = std::is_same_v<Number, float> ? H5T_NATIVE_FLOAT :
                             sizeof(Number) == 4           ? H5T_NATIVE_UINT32 :
                                                             H5T_NATIVE_UINT64;
        const hsize_t own[2]   = {values.size() / set.n_columns, set.n_columns};
        const Handle  creation = {H5Pcreate(H5P_DATASET_CREATE), H5Pclose},
                     memory    = {H5Screate_simple(n_dims, own, nullptr),
                                  H5Sclose},
                     space = {H5Screate_simple(n_dims, all, nullptr), H5Sclose};
        // Without times, equal data make equal files.
        H5Pset_obj_track_times(creation, false);
        const Handle data = {H5Dcreate2(file,
                                        set.name.c_str(),
                                        type,
                                        space,
                                        H5P_DEFAULT,
                                        creation,
                                        H5P_DEFAULT),
                             H5Dclose};
        H5Sselect_hyperslab(
          space, H5S_SELECT_SET, first, nullptr, own, nullptr);
        if (own[0] == 0)
          H5Sselect_none(space);
        return H5Dwrite(data, type, memory, space, transfer, values.data()) >=
               0;
      };
      return std::visit(write_values, set.values);
    }



    /// Write a file: all @p ranks together, or, if absent, this rank alone and
    /// without MPI, so that a thread can do it. Throws ExcMessage on all ranks.
    void
    write_hdf5(const std::string             &file,
               const std::vector<DataSet>    &data_sets,
               const std::optional<MPI_Comm> &ranks)
    {
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
      const std::string part   = file + ".part";
      const Handle      access = {H5Pcreate(H5P_FILE_ACCESS), H5Pclose},
                   transfer    = {H5Pcreate(H5P_DATASET_XFER), H5Pclose};
      if (ranks)
        {
          fail_together(*ranks, [&]() { require_writable_file(file); });
          H5Pset_fapl_mpio(access, *ranks, MPI_INFO_NULL);
          H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
        }
      else // without MPI, in memory
        H5Pset_fapl_core(access, 1 << 16, false);
      std::string bytes;
      bool        good = true;
      {
        const Handle written = {
          H5Fcreate(part.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access),
          H5Fclose};
        // All ranks make the same calls, even after a failure.
        for (const DataSet &set : data_sets)
          good = write(written, set, transfer) && good;
        good = H5Fflush(written, H5F_SCOPE_GLOBAL) >= 0 && good;
        if (!ranks && good)
          {
            bytes.resize(H5Fget_file_image(written, nullptr, 0));
            H5Fget_file_image(written, bytes.data(), bytes.size());
          }
      }
      const auto check = [&]() {
        if (!good)
          refuse("HDF5 cannot write '" + file + "'.");
      };
      if (!ranks)
        {
          check();
          replace_file(file, bytes);
          return;
        }
      fail_together(*ranks, check);
      fail_together(*ranks, [&]() {
        if (Utilities::MPI::this_mpi_process(*ranks) == 0)
          std::filesystem::rename(part, file);
      });
    }
#else
    void
    H5open()
    {}

    void
    write_hdf5(const std::string &,
               const std::vector<DataSet> &,
               const std::optional<MPI_Comm> &)
    {
      Assert(false, ExcInternalError()); // refused by check_output_places()
    }
#endif



    /// Return an XDMF element that refers to a data set in a file.
    std::string
    element(const std::string &name,
            const std::string &attributes,
            const std::string &file,
            const DataSet     &set)
    {
      const bool is_real = set.values.index() == 0;
      return '<' + name + ' ' + attributes +
             "><DataItem Format=\"HDF\" NumberType=\"" +
             (is_real ? "Float" : "UInt") + "\" Precision=\"" +
             std::to_string(is_real ? sizeof(float) :
                                      sizeof(types::global_dof_index)) +
             "\" Dimensions=\"" + std::to_string(set.n_rows) +
             (set.n_columns > 1 ? ' ' + std::to_string(set.n_columns) : "") +
             "\">" + file + ":/" + set.name + "</DataItem></" + name + ">\n";
    }
  } // namespace



  template <int dim>
  void
  Output<dim>::write_in_hdf5(const AdmissibleSpace<dim> &space,
                             const OutputGrid<dim, dim> &body,
                             const double                t)
  {
    using DataSets = std::vector<DataSet>;
    // Not in the thread that writes, since HDF5 registers with MPI.
    H5open();
    const auto mesh_now = std::make_shared<DataSets>(mesh_of(space, body));
    const auto fields =
      std::make_shared<DataSets>(fields_of(space, body, *mesh_now));
    const std::string record = record_name("solution", times.size() - 1);
    const bool        is_new =
      Utilities::MPI::logical_or(mesh == nullptr || *mesh != *mesh_now,
                                 communicator);
    if (is_new)
      {
        mesh      = mesh_now;
        mesh_file = record_name("mesh", times.size() - 1) + ".h5";
      }
    std::ostringstream grid;
    grid << std::setprecision(15)
         << "<Grid Name=\"body\" GridType=\"Uniform\">\n<Time Value=\"" << t
         << "\"/>\n"
         << element("Topology",
                    (dim == 2 ? "TopologyType=\"Quadrilateral\"" :
                                "TopologyType=\"Hexahedron\"") +
                      (" NumberOfElements=\"" +
                       std::to_string((*mesh)[1].n_rows) + '"'),
                    mesh_file,
                    (*mesh)[1])
         << element("Geometry",
                    dim == 2 ? "GeometryType=\"XY\"" : "GeometryType=\"XYZ\"",
                    mesh_file,
                    (*mesh)[0]);
    for (const DataSet &field : *fields)
      grid << element("Attribute",
                      "Name=\"" + field.name + field.label +
                        (field.n_columns == 3 ?
                           "\" AttributeType=\"Vector\" Center=\"Node\"" :
                           "\" AttributeType=\"Scalar\" Center=\"Cell\""),
                      record + ".h5",
                      field);
    grid << "</Grid>\n";

    std::optional<MPI_Comm> ranks;
    if (Utilities::MPI::n_mpi_processes(communicator) > 1)
      ranks = communicator;
    files.push_back(
      [fields,
       ranks,
       name        = path + record,
       new_mesh    = is_new ? mesh : nullptr,
       mesh_file   = path + mesh_file,
       grid        = grid.str(),
       of_series   = list("solution"),
       has_records = Utilities::MPI::this_mpi_process(communicator) == 0]() {
        if (new_mesh)
          write_hdf5(mesh_file, *new_mesh, ranks);
        write_hdf5(name + ".h5", *fields, ranks);
        if (!has_records)
          return;
        replace_file(name + ".xml", grid);
        replace_file(of_series.first, of_series.second);
      });
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, write_in_hdf5);
} // namespace Viscoplastic
