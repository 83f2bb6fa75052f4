// Keeps the bytes of the messages between participants, for programs that compare two runs. No ROS.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace move_base_abstract {

/**
 * @brief A file with the type and the bytes of each message, call and response in the event log, in
 * its order. Each of the two is a length (4 bytes, little endian) and as many bytes.
 *
 * The file ends when it would become longer than kLimit, or the disk is full.
 * move_base_abstract_ros/messages/message_fields.py reads it.
 */
class MessageBytes {
 public:
  static constexpr std::uint64_t kLimit = 256U << 20;  // bytes

  /** @throws std::invalid_argument if @p path exists, or cannot be written. */
  explicit MessageBytes(const std::string& path);
  void add(std::string_view type, std::string_view bytes);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
};

}  // namespace move_base_abstract
