// A file descriptor that is closed with its owner. No ROS.
#pragma once

#include <unistd.h>

#include <utility>

namespace move_base_abstract {

/** @brief The owner of a file descriptor; -1: of none. */
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() {
    if (fd_ >= 0) {
      close(fd_);
    }
  }
  int get() const { return fd_; }
  /** @brief Give the descriptor to the caller, who has to close it. */
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

}  // namespace move_base_abstract
