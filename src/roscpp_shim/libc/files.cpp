// Files: those of random bytes are replaced, those that describe the system label the run, and all
// others are reported, also if the program only asks whether they are there. The time master
// compares which files each participant reads and writes.
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <optional>
#include <string>

#include "chance.h"
#include "libc/devices.h"
#include "libc/instants.h"
#include "lockstep/wire/utf8.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/recorder.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

/** @return the path without links and dots, also if the file does not exist; empty: not known. */
std::string wholePath(const char* path) {
  std::array<char, PATH_MAX> whole{};
  if (::realpath(path, whole.data()) != nullptr) {
    return whole.data();
  }
  const char* const slash = strrchr(path, '/');
  const std::string folder = slash == nullptr ? "." : std::string(path, slash + 1);
  return errno == ENOENT && ::realpath(folder.c_str(), whole.data()) != nullptr
             ? std::string(whole.data()) + '/' + (slash == nullptr ? path : slash + 1)
             : "";
}

/** @return the path as UTF-8 for the time master; other bytes become codes such as \xff. */
std::string asText(const std::string& path) {
  if (isUtf8(path)) {
    return path;
  }
  std::string text;
  for (const char letter : path) {
    std::array<char, 5> shown{letter};
    if ((static_cast<unsigned char>(letter) & 0x80) != 0) {
      snprintf(shown.data(), shown.size(), "\\x%02x", static_cast<unsigned char>(letter));
    }
    text += shown.data();
  }
  return text;
}

/** @return the flags of open() for the mode @p how of fopen(). */
int flagsOf(const char* how) {
  if (how == nullptr || strchr(how, '+') != nullptr) {
    return O_RDWR | O_CLOEXEC;
  }
  return (*how == 'r' ? O_RDONLY : O_WRONLY) | O_CLOEXEC;
}

/** @brief The opening of one file by the program or a library in it. */
class Opening {
 public:
  Opening(const char* path, int flags, const void* caller)
      : path_(path), flags_(flags), caller_(caller) {
    is_seen_ =
        path != nullptr && !Turn::isInside() && !Turn::isInternal() && sees() != Sees::kMachine;
    if (!is_seen_) {
      return;
    }
    file_ = openEntropy(path, flags, caller);
    if (file_ < 0 && isOfSystem(path) && isProgramsOwn(caller)) {
      const std::string folder(path, strcspn(path + 1, "/") + 1);
      tell("a file in " + folder + " is opened: it describes this machine at this moment", caller);
    }
  }

  Opening(const char* path, const char* how, const void* caller)
      : Opening(path, flagsOf(how), caller) {
    noteBag(path, how, caller);
  }

  /** @return whether the file is open already, as file(). */
  bool isDone() const { return file_ >= 0; }
  int file() const { return file_; }

  /** @return @p result of the real function, after the file has been reported. */
  int noted(int result) const {
    note(result >= 0);
    return result;
  }
  FILE* noted(FILE* result) const {
    note(result != nullptr);
    return result;
  }

 private:
  /** A file that cannot be opened is reported as read: another run may find it, or find none. */
  void note(bool is_open) const {
    const int access = flags_ & O_ACCMODE;
    if (!is_seen_ || isRoscpps(caller_)) {
      return;
    }
    const int error = errno;
    const Inside inside;
    const std::string path = wholePath(path_);
    if (!path.empty()) {
      noteFile(asText(path), !is_open || access != O_WRONLY, is_open && access != O_RDONLY);
    }
    errno = error;
  }

  const char* path_;
  int flags_;
  const void* caller_;
  bool is_seen_;
  int file_ = -1;
};

/** @brief Report a file that has a name or has lost one as written, as read if that failed: another
 * run may find it. @return @p result. */
int tellNamed(int result, const char* path, const void* caller) {
  return Opening(path, O_WRONLY, caller).noted(result);
}

void setTime(timespec* time, Nanoseconds at) { *time = toTimespec(at); }
void setTime(struct statx_timestamp* time, Nanoseconds at) {
  time->tv_sec = at / kSecond;
  time->tv_nsec = static_cast<std::uint32_t>(at % kSecond);
}
void setTimes(struct statx* found, Nanoseconds at) {
  for (auto* const time : {&found->stx_atime, &found->stx_mtime, &found->stx_ctime}) {
    setTime(time, at);
  }
}
template <typename Stat>
void setTimes(Stat* found, Nanoseconds at) {
  for (auto* const time : {&found->st_atim, &found->st_mtim, &found->st_ctim}) {
    setTime(time, at);
  }
}

/** @brief Report a file as read if the program asks whether it is there. @return its path; "": the
 * file does not matter. */
std::string asked(const char* path, const void* caller) {
  if (path == nullptr || *path == '\0' || Turn::isInside() || Turn::isInternal() ||
      sees() == Sees::kMachine || !isProgramsOwn(caller)) {
    return "";
  }
  const int error = errno;
  const Inside inside;
  const std::string text = asText(wholePath(path));
  if (!text.empty()) {
    noteFile(text, true, false);
  }
  errno = error;
  return text;
}

/** @brief The same, and give a file that the program has written the date of the run. */
template <typename Stat>
int asked(int result, const char* path, Stat* found, const void* caller) {
  const std::string text = asked(path, caller);
  const auto at = text.empty() || result != 0 ? std::nullopt : whenWritten(text);
  if (at) {
    setTimes(found, *at);
  }
  return result;
}

}  // namespace
}  // namespace move_base_abstract::shim

#include "libc/files.h"

#pragma GCC visibility push(default)
extern "C" {

int rename(const char* from, const char* to) {
  static auto* const function = shim::real(&::rename, "rename");
  const int result = shim::tellNamed(function(from, to), from, MOVE_BASE_ABSTRACT_CALLER);
  return shim::tellNamed(result, to, MOVE_BASE_ABSTRACT_CALLER);
}

int remove(const char* path) {
  static auto* const function = shim::real(&::remove, "remove");
  return shim::tellNamed(function(path), path, MOVE_BASE_ABSTRACT_CALLER);
}

int unlink(const char* path) {
  static auto* const function = shim::real(&::unlink, "unlink");
  return shim::tellNamed(function(path), path, MOVE_BASE_ABSTRACT_CALLER);
}

// ---- questions about files -------------------------------------------------------------------

int access(const char* path, int mode) {
  static auto* const function = shim::real(&::access, "access");
  shim::asked(path, MOVE_BASE_ABSTRACT_CALLER);
  return function(path, mode);
}

int stat(const char* path, struct stat* found) {
  static auto* const function = shim::real<int(const char*, struct stat*)>("stat");
  return shim::asked(function(path, found), path, found, MOVE_BASE_ABSTRACT_CALLER);
}

int lstat(const char* path, struct stat* found) {
  static auto* const function = shim::real<int(const char*, struct stat*)>("lstat");
  return shim::asked(function(path, found), path, found, MOVE_BASE_ABSTRACT_CALLER);
}

int statx(int folder, const char* path, int flags, unsigned mask, struct statx* found) {
  static auto* const function = shim::real(&::statx, "statx");
  const int result = function(folder, path, flags, mask, found);
  return shim::asked(result, shim::ofNoFolder(folder, path), found, MOVE_BASE_ABSTRACT_CALLER);
}

// Before glibc 2.33 the headers called these.

int __xstat(int version, const char* path, struct stat* found) {
  static auto* const function = shim::real<int(int, const char*, struct stat*)>("__xstat");
  return shim::asked(function(version, path, found), path, found, MOVE_BASE_ABSTRACT_CALLER);
}

int __lxstat(int version, const char* path, struct stat* found) {
  static auto* const function = shim::real<int(int, const char*, struct stat*)>("__lxstat");
  return shim::asked(function(version, path, found), path, found, MOVE_BASE_ABSTRACT_CALLER);
}

// Files of more than 32 bits are the usual ones here.
asm(".globl stat64, lstat64, __xstat64, __lxstat64\n"
    ".set stat64, stat\n.set lstat64, lstat\n.set __xstat64, __xstat\n.set __lxstat64, __lxstat");

}  // extern "C"
#pragma GCC visibility pop
