// Files: those of random bytes are replaced, those that describe the system label the run, and all
// others are reported. The time master compares which files each participant reads and writes.
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <array>
#include <cerrno>
#include <string>

#include "chance.h"
#include "libc/devices.h"
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
  /** A missing file that the program wants to read is reported, too: another run may find it. */
  void note(bool is_open) const {
    const int access = flags_ & O_ACCMODE;
    if (!is_seen_ || isRoscpps(caller_) || (!is_open && access != O_RDONLY)) {
      return;
    }
    const int error = errno;
    const Inside inside;
    const std::string path = wholePath(path_);
    if (!path.empty()) {
      noteFile(asText(path), access != O_WRONLY, access != O_RDONLY);
    }
    errno = error;
  }

  const char* path_;
  int flags_;
  const void* caller_;
  bool is_seen_;
  int file_ = -1;
};

/** @brief Report the new name of a renamed file as a file that is written. @return @p result. */
int tellRenamed(int result, const char* to, const void* caller) {
  return Opening(to, O_WRONLY, caller).noted(result);
}

}  // namespace
}  // namespace move_base_abstract::shim

namespace shim = move_base_abstract::shim;
namespace policy = shim;
#include "libc/files.h"

#pragma GCC visibility push(default)
extern "C" {

int rename(const char* from, const char* to) {
  static auto* const function = shim::real(&::rename, "rename");
  return shim::tellRenamed(function(from, to), to, MOVE_BASE_ABSTRACT_CALLER);
}

}  // extern "C"
#pragma GCC visibility pop
