// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/source_directory.h>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace Viscoplastic
{
  using namespace dealii;
  namespace fs = std::filesystem;

  namespace
  {
    /// Throw unless @p success, with the reason from errno.
    void
    check_written(const bool success, const std::string &name)
    {
      if (!success)
        refuse("'" + name + "' cannot be written: " + std::strerror(errno) +
               ".");
    }



    std::string
    kind_of(const fs::file_type type)
    {
      switch (type)
        {
          case fs::file_type::directory:
            return "it is a directory";
          case fs::file_type::symlink:
            return "it is a symbolic link";
          case fs::file_type::fifo:
            return "it is a pipe";
          case fs::file_type::regular:
          case fs::file_type::not_found:
          case fs::file_type::none:
            return "";
          default:
            return "it is no regular file";
        }
    }



    // Open without waiting for the other end of a pipe and without following a
    // link, in case one appears after the type has been checked.
    const int for_writing =
      O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_NONBLOCK;



    /// An open file whose every operation is checked. Errors name @p name,
    /// which need not be the name under which it is opened.
    class Descriptor
    {
    public:
      Descriptor(const std::string &name,
                 const std::string &path,
                 const int          flags)
        : name(name)
      {
        if (flags == for_writing)
          require_writable_file(path);
        descriptor = open(path.c_str(), flags | O_CLOEXEC, 0666);
        check_written(descriptor >= 0, name);
      }

      ~Descriptor()
      {
        if (descriptor >= 0)
          ::close(descriptor);
      }

      Descriptor(const Descriptor &) = delete;

      void
      write_all(const std::string &bytes) const
      {
        std::size_t written = 0;
        while (written < bytes.size())
          {
            const ssize_t n =
              write(descriptor, bytes.data() + written, bytes.size() - written);
            check_written(n > 0 || errno == EINTR, name);
            written += std::max<ssize_t>(n, 0);
          }
      }

      void
      synchronize() const
      {
        // EINVAL: some file systems cannot synchronize directories.
        check_written(fsync(descriptor) == 0 || errno == EINVAL, name);
      }

      /// Close the file; network file systems report a full disk only here.
      void
      close()
      {
        check_written(::close(std::exchange(descriptor, -1)) == 0 ||
                        errno == EINTR,
                      name);
      }

    private:
      const std::string name;
      int               descriptor = -1;
    };
  } // namespace



  void
  require_writable_file(const std::string &name)
  {
    std::error_code   none;
    const std::string kind = kind_of(fs::symlink_status(name, none).type());
    if (!kind.empty())
      refuse("'" + name + "' cannot be written: " + kind + ".");
  }



  std::optional<std::string>
  read_file_if_any(const std::string &name)
  {
    std::error_code   none;
    const std::string kind = kind_of(fs::status(name, none).type());
    if (!kind.empty())
      refuse("'" + name + "' cannot be read: " + kind + ".");
    errno = 0;
    std::ifstream file(name, std::ios::binary);
    if (!file && (errno == ENOENT || errno == ENOTDIR))
      return {};
    std::ostringstream bytes;
    // Inserting the buffer of an empty file would set the fail bit.
    if (file && file.peek() != std::ifstream::traits_type::eof())
      bytes << file.rdbuf();
    if (!file || !bytes)
      refuse("'" + name + "' cannot be read: " + std::strerror(errno) + ".");
    return bytes.str();
  }



  void
  write_file(const std::string &name, const std::string &bytes)
  {
    Descriptor file(name, name, for_writing);
    file.write_all(bytes);
    file.synchronize();
    file.close();
  }



  namespace
  {
    /// Replace a file by what @p write writes to its argument.
    template <typename Function>
    void
    replace(const std::string &name, const Function &write)
    {
      require_writable_file(name);
      const std::string part = name + ".part";
      try
        {
          Descriptor file(name, part, for_writing);
          write(file);
          file.close();
          check_written(std::rename(part.c_str(), name.c_str()) == 0, name);
        }
      catch (const std::exception &)
        {
          std::error_code none;
          fs::remove(part, none); // make room
          throw;
        }
    }
  } // namespace



  void
  replace_file(const std::string &name,
               const std::string &bytes,
               const bool         to_disk)
  {
    replace(name, [&](Descriptor &file) {
      file.write_all(bytes);
      if (to_disk)
        file.synchronize();
    });
  }



  void
  replace_file(const std::string                  &name,
               const std::function<std::string()> &next)
  {
    replace(name, [&](Descriptor &file) {
      for (std::string part = next(); !part.empty(); part = next())
        file.write_all(part);
    });
  }



  void
  synchronize(const std::string &file)
  {
    Descriptor(file, file, O_RDONLY).synchronize();
  }



  void
  synchronize_directory(const std::string &name)
  {
    Descriptor(name, name, O_RDONLY | O_DIRECTORY).synchronize();
  }



  DirectoryLock::~DirectoryLock()
  {
    if (descriptor < 0)
      return;
    // Unlink before releasing the lock: a process that opens the file in
    // between finds out in acquire() that it has been unlinked.
    unlink(file.c_str());
    close(descriptor);
  }



  void
  DirectoryLock::acquire(const std::string &directory,
                         const std::string &otherwise)
  {
    if (descriptor >= 0)
      return;
    file = directory + (directory.back() == '/' ? "" : "/") +
           "viscoplastic_contact.lock";
    require_writable_file(file);
    // The previous holder may unlink the file between open() and flock(); then
    // try again with a new file.
    for (unsigned int i = 0; i < 10; ++i)
      {
        const int opened =
          open(file.c_str(),
               O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK,
               0666);
        if (opened < 0)
          return;
        if (flock(opened, LOCK_EX | LOCK_NB) != 0)
          {
            const bool    is_taken = errno == EWOULDBLOCK;
            char          buffer[200];
            const ssize_t n = read(opened, buffer, sizeof(buffer));
            close(opened);
            if (!is_taken)
              {
                unlink(file.c_str()); // it has no effect here
                return;
              }
            const std::string holder =
              excerpt(std::string(buffer, std::max<ssize_t>(n, 0)), 150);
            refuse("Another run" + (holder.empty() ? "" : " (" + holder + ")") +
                   " is writing into '" + directory +
                   "'; wait until it has ended, or " + otherwise + ".");
          }
        struct stat mine, there;
        if (fstat(opened, &mine) == 0 && stat(file.c_str(), &there) == 0 &&
            mine.st_dev == there.st_dev && mine.st_ino == there.st_ino)
          {
            // The holder is only needed for the message above: ignore errors.
            const std::string holder = "process " + std::to_string(getpid()) +
                                       " on " +
                                       Utilities::System::get_hostname();
            if (ftruncate(opened, 0) != 0 ||
                write(opened, holder.data(), holder.size()) < 0)
              errno = 0;
            descriptor = opened;
            return;
          }
        close(opened);
      }
  }



  std::string
  path_of_resource(const std::string &name)
  {
    std::error_code error;
    // Paths relative to the program let an installation be moved.
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    for (const fs::path &directory :
         {program.parent_path().parent_path() / "share/viscoplastic_contact",
          fs::path(VISCOPLASTIC_CONTACT_SOURCE_DIRECTORY)})
      if (fs::exists(directory / name, error))
        return (directory / name).string();
    return "";
  }



  std::uint32_t
  checksum(const std::string &bytes)
  {
    return crc32_z(0,
                   reinterpret_cast<const Bytef *>(bytes.data()),
                   bytes.size());
  }



  std::string
  json_text(const nlohmann::ordered_json &json)
  {
    return json.dump(2,
                     ' ',
                     /* ensure_ascii = */ false,
                     nlohmann::ordered_json::error_handler_t::replace) +
           '\n';
  }
} // namespace Viscoplastic
