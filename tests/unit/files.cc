// SPDX-License-Identifier: LGPL-2.1-or-later

// Files that are replaced, cannot be read or written, and locks.

#include "folder.h"
#include "refusals.h"
#include <viscoplastic_contact/base/files.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace
{
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  /// Call @p function in a child process; return whether it has thrown.
  template <typename Function>
  bool
  throws_in_child(const Function &function)
  {
    const pid_t child = fork();
    if (child == 0)
      {
        try
          {
            function();
          }
        catch (const std::exception &)
          {
            _exit(1);
          }
        _exit(0);
      }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status));
    return WEXITSTATUS(status) == 1;
  }



  TEST(Files, WhatIsWrittenIsRead)
  {
    const Folder      folder;
    const std::string name = folder.path / "a", bytes("a\0\n\xff", 4);
    EXPECT_FALSE(read_file_if_any(name));
    for (const std::string &text : {bytes, std::string()})
      {
        write_file(name, text);
        EXPECT_EQ(read_file_if_any(name), text);
        replace_file(name, "other");
        EXPECT_EQ(read_file_if_any(name), "other");
        replace_file(name, text, /* to_disk = */ true);
        EXPECT_EQ(read_file_if_any(name), text);
      }
    EXPECT_FALSE(std::filesystem::exists(name + ".part"));
  }



  TEST(Files, WhatCannotBeReadIsNotAbsent)
  {
    const Folder folder;
    const auto   link = folder.path / "link";
    std::filesystem::create_symlink(link, link);
    for (const auto &name : {folder.path, link})
      expect_refusal([&] { read_file_if_any(name); },
                     "'" + name.string() + "' cannot be read: ");
  }



  TEST(Files, OnlyRegularFiles)
  {
    // No call waits for the other end of a pipe, and targets of symbolic links
    // are not changed.
    const Folder      folder;
    const std::string pipe = folder.path / "pipe", link = folder.path / "link",
                      other = folder.add("other", "of somebody else");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0666), 0);
    std::filesystem::create_symlink(other, link);
    for (const auto &[name, kind] :
         {std::make_pair(pipe, std::string("pipe")),
          std::make_pair(link, std::string("symbolic link")),
          std::make_pair(folder.path.string(), std::string("directory"))})
      {
        const std::string sentence =
          "'" + name + "' cannot be written: it is a " + kind + ".";
        expect_refusal([&] { write_file(name, "a"); }, sentence);
        expect_refusal([&] { replace_file(name, "a"); }, sentence);
        expect_refusal([&] { require_writable_file(name); }, sentence);
      }
    expect_refusal([&] { read_file_if_any(pipe); },
                   "'" + pipe + "' cannot be read: it is a pipe.");
    EXPECT_EQ(read_file_if_any(link), "of somebody else");

    // The temporary file and the lock must not be links, either.
    const std::string name = folder.path / "a",
                      lock = folder.path / "viscoplastic_contact.lock";
    std::filesystem::create_symlink(other, name + ".part");
    expect_refusal([&] { replace_file(name, "a"); }, "it is a symbolic link.");
    std::filesystem::create_symlink(other, lock);
    expect_refusal([&] { DirectoryLock().acquire(folder.path); },
                   "it is a symbolic link.");
    EXPECT_EQ(read_file_if_any(other), "of somebody else");
  }



  TEST(Files, OldFileStaysUntilTheNewOneIsThere)
  {
    const Folder      folder;
    const std::string name = folder.add("a", "old");
    EXPECT_TRUE(throws_in_child([&] {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{100, 100};
      setrlimit(RLIMIT_FSIZE, &limit);
      replace_file(name, std::string(101, 'x'));
    }));
    EXPECT_EQ(read_file_if_any(name), "old");
    EXPECT_FALSE(std::filesystem::exists(name + ".part"));
  }



  TEST(Files, LockKeepsOthersOut)
  {
    const Folder folder;
    const auto   is_free = [&] {
      return !throws_in_child([&] { DirectoryLock().acquire(folder.path); });
    };
    {
      DirectoryLock lock;
      lock.acquire(folder.path);
      lock.acquire(folder.path); // again: no effect
      expect_refusal([&] { DirectoryLock().acquire(folder.path); },
                     "Another run (process " + std::to_string(getpid()) +
                       " on ");
      EXPECT_FALSE(is_free());
    }
    EXPECT_TRUE(is_free());
    EXPECT_TRUE(std::filesystem::is_empty(folder.path));
    // An absent directory is neither locked nor an error.
    DirectoryLock().acquire(folder.path / "absent");
  }



  TEST(Files, LockVanishesWithItsProcess)
  {
    const Folder folder;
    int          is_ready[2];
    ASSERT_EQ(pipe(is_ready), 0);
    const pid_t child = fork();
    if (child == 0)
      {
        DirectoryLock lock;
        lock.acquire(folder.path);
        if (write(is_ready[1], "x", 1) == 1)
          pause();
        _exit(1);
      }
    char    x;
    ssize_t n = read(is_ready[0], &x, 1);
    EXPECT_EQ(n, 1);
    DirectoryLock lock;
    expect_refusal([&] { lock.acquire(folder.path); }, "Another run");
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    EXPECT_TRUE(
      std::filesystem::exists(folder.path / "viscoplastic_contact.lock"));
    lock.acquire(folder.path);
    close(is_ready[0]);
    close(is_ready[1]);
  }
} // namespace
