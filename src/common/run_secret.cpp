#include "run_secret.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace move_base_abstract {
namespace {

/** @brief An open file, which is closed with this object. */
class File {
 public:
  explicit File(const std::string& path)
      : fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~File() {
    if (fd_ >= 0) {
      close(fd_);
    }
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw std::invalid_argument("lockstep_secret_file must be a file that only its owner can read" +
                              (", got '" + path + "': " + why));
}

std::string trimmed(const std::string& text) {
  constexpr const char* kSpace = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  return begin == std::string::npos ? ""
                                    : text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

std::string contents(const std::string& path) {
  const File file(path);
  struct stat status {};
  if (file.get() < 0 || fstat(file.get(), &status) != 0) {
    refuse(path, std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) {
    refuse(path, "it is no ordinary file");
  }
  if (status.st_uid != geteuid()) {
    refuse(path, "it belongs to another user");
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    refuse(path, "others may use it too; chmod 600 changes that");
  }
  std::string text(kLongestSecret + 3, '\0');  // a line end, and one byte too many
  const ssize_t size = read(file.get(), text.data(), text.size());
  if (size < 0) {
    refuse(path, std::strerror(errno));
  }
  text.resize(static_cast<std::size_t>(size));
  return trimmed(text);
}

}  // namespace

std::string runSecret(const std::string& text, const std::string& file) {
  if (!text.empty() && !file.empty()) {
    throw std::invalid_argument(
        "lockstep_secret and lockstep_secret_file must not be set both: one is enough");
  }
  std::string secret = file.empty() ? trimmed(text) : contents(file);
  const char* const key = file.empty() ? "lockstep_secret" : "lockstep_secret_file";
  if (secret.size() > kLongestSecret || (secret.empty() && !(text.empty() && file.empty()))) {
    throw std::invalid_argument(std::string(key) + " must have from 1 to " +
                                std::to_string(kLongestSecret) + " bytes, got " +
                                (secret.empty() ? "none" : "more"));
  }
  return secret;
}

}  // namespace move_base_abstract
