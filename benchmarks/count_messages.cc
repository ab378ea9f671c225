// SPDX-License-Identifier: LGPL-2.1-or-later

// Linked with the program's own main(), count what its ranks say to each other:
// MPI's profiling interface lets these functions stand before those of MPI, for
// deal.II, Trilinos and p4est as well. At its end the program prints
//
//     counted MESSAGES BYTES COLLECTIVES COLLECTIVE_BYTES PARTNERS
//
// each of the rank with most: messages sent to single ranks, their bytes,
// collective calls, the bytes that a rank gets of them, and the number of ranks
// that it sends to.

#include <mpi.h>

#include <array>
#include <cstdio>
#include <set>

namespace
{
  std::array<double, 5> counts;
  std::set<int>         partners;

  double
  size_of(const int n, const MPI_Datatype type)
  {
    int size = 0;
    PMPI_Type_size(type, &size);
    return static_cast<double>(n) * size;
  }

  void
  send(const int          n,
       const MPI_Datatype type,
       const int          rank,
       const MPI_Comm     comm)
  {
    // Numbers of ranks are those of the communicator, nearly always the
    // world's.
    (void)comm;
    partners.insert(rank);
    counts[0] += 1;
    counts[1] += size_of(n, type);
  }

  void
  meet(const int n, const MPI_Datatype type)
  {
    counts[2] += 1;
    counts[3] += size_of(n, type);
  }

  int
  n_ranks(const MPI_Comm comm)
  {
    int n = 0;
    PMPI_Comm_size(comm, &n);
    return n;
  }

  int
  sum(const int *n, const MPI_Comm comm)
  {
    int result = 0;
    for (int rank = 0; rank < n_ranks(comm); ++rank)
      result += n[rank];
    return result;
  }
} // namespace

extern "C"
{
#define COUNT_SEND(name)                                \
  int MPI_##name(const void        *data,               \
                 const int          n,                  \
                 const MPI_Datatype type,               \
                 const int          rank,               \
                 const int          tag,                \
                 const MPI_Comm     comm)               \
  {                                                     \
    send(n, type, rank, comm);                          \
    return PMPI_##name(data, n, type, rank, tag, comm); \
  }
#define COUNT_REQUEST(name)                                      \
  int MPI_##name(const void        *data,                        \
                 const int          n,                           \
                 const MPI_Datatype type,                        \
                 const int          rank,                        \
                 const int          tag,                         \
                 const MPI_Comm     comm,                        \
                 MPI_Request       *request)                     \
  {                                                              \
    send(n, type, rank, comm);                                   \
    return PMPI_##name(data, n, type, rank, tag, comm, request); \
  }
#define COUNT_REDUCTION(name)                        \
  int MPI_##name(const void        *from,            \
                 void              *to,              \
                 const int          n,               \
                 const MPI_Datatype type,            \
                 const MPI_Op       op,              \
                 const MPI_Comm     comm)            \
  {                                                  \
    meet(n, type);                                   \
    return PMPI_##name(from, to, n, type, op, comm); \
  }

  COUNT_SEND(Send)
  COUNT_SEND(Bsend)
  COUNT_SEND(Rsend)
  COUNT_SEND(Ssend)
  COUNT_REQUEST(Isend)
  COUNT_REQUEST(Issend)
  COUNT_REQUEST(Irsend)
  COUNT_REDUCTION(Allreduce)
  COUNT_REDUCTION(Scan)
  COUNT_REDUCTION(Exscan)

  int
  MPI_Sendrecv(const void        *from,
               const int          n,
               const MPI_Datatype type,
               const int          rank,
               const int          tag,
               void              *to,
               const int          n_to,
               const MPI_Datatype type_to,
               const int          rank_to,
               const int          tag_to,
               const MPI_Comm     comm,
               MPI_Status        *status)
  {
    send(n, type, rank, comm);
    return PMPI_Sendrecv(from,
                         n,
                         type,
                         rank,
                         tag,
                         to,
                         n_to,
                         type_to,
                         rank_to,
                         tag_to,
                         comm,
                         status);
  }

  int
  MPI_Reduce(const void        *from,
             void              *to,
             const int          n,
             const MPI_Datatype type,
             const MPI_Op       op,
             const int          root,
             const MPI_Comm     comm)
  {
    meet(n, type);
    return PMPI_Reduce(from, to, n, type, op, root, comm);
  }

  int
  MPI_Reduce_scatter(const void        *from,
                     void              *to,
                     const int         *n,
                     const MPI_Datatype type,
                     const MPI_Op       op,
                     const MPI_Comm     comm)
  {
    meet(sum(n, comm), type);
    return PMPI_Reduce_scatter(from, to, n, type, op, comm);
  }

  int
  MPI_Bcast(void              *data,
            const int          n,
            const MPI_Datatype type,
            const int          root,
            const MPI_Comm     comm)
  {
    meet(n, type);
    return PMPI_Bcast(data, n, type, root, comm);
  }

  int
  MPI_Barrier(const MPI_Comm comm)
  {
    meet(0, MPI_BYTE);
    return PMPI_Barrier(comm);
  }

  int
  MPI_Ibarrier(const MPI_Comm comm, MPI_Request *request)
  {
    meet(0, MPI_BYTE);
    return PMPI_Ibarrier(comm, request);
  }

  int
  MPI_Allgather(const void        *from,
                const int          n,
                const MPI_Datatype type,
                void              *to,
                const int          n_to,
                const MPI_Datatype type_to,
                const MPI_Comm     comm)
  {
    meet(n_to * n_ranks(comm), type_to);
    return PMPI_Allgather(from, n, type, to, n_to, type_to, comm);
  }

  int
  MPI_Allgatherv(const void        *from,
                 const int          n,
                 const MPI_Datatype type,
                 void              *to,
                 const int         *n_to,
                 const int         *begin,
                 const MPI_Datatype type_to,
                 const MPI_Comm     comm)
  {
    meet(sum(n_to, comm), type_to);
    return PMPI_Allgatherv(from, n, type, to, n_to, begin, type_to, comm);
  }

  int
  MPI_Alltoall(const void        *from,
               const int          n,
               const MPI_Datatype type,
               void              *to,
               const int          n_to,
               const MPI_Datatype type_to,
               const MPI_Comm     comm)
  {
    meet(n_to * n_ranks(comm), type_to);
    return PMPI_Alltoall(from, n, type, to, n_to, type_to, comm);
  }

  int
  MPI_Gather(const void        *from,
             const int          n,
             const MPI_Datatype type,
             void              *to,
             const int          n_to,
             const MPI_Datatype type_to,
             const int          root,
             const MPI_Comm     comm)
  {
    meet(n_ranks(comm) * n, type);
    return PMPI_Gather(from, n, type, to, n_to, type_to, root, comm);
  }

  int
  MPI_Finalize()
  {
    counts[4] = partners.size();
    std::array<double, 5> most{};
    int                   rank = 0;
    PMPI_Reduce(
      counts.data(), most.data(), 5, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
    PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank == 0)
      std::printf("counted %.0f %.0f %.0f %.0f %.0f\n",
                  most[0],
                  most[1],
                  most[2],
                  most[3],
                  most[4]);
    std::fflush(stdout);
    return PMPI_Finalize();
  }
}
