#include "message_bytes.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "clock/little_endian.h"

namespace move_base_abstract {
namespace {

void append(std::string* record, std::string_view text) {
  char length[sizeof(std::uint32_t)];
  putNumber(length, static_cast<std::uint32_t>(text.size()));
  record->append(length, sizeof(length)).append(text);
}

}  // namespace

MessageBytes::MessageBytes(const std::string& path) : file_(std::fopen(path.c_str(), "wbxe")) {
  if (!file_) {
    throw std::invalid_argument(
        "message_bytes must be the path of a file that is not there, got '" + path +
        "': " + std::strerror(errno));
  }
}

void MessageBytes::add(std::string_view type, std::string_view bytes) {
  std::string record;
  append(&record, type);
  append(&record, bytes);
  size_ += record.size();
  if (file_ && (size_ > kLimit ||
                std::fwrite(record.data(), 1, record.size(), file_.get()) != record.size())) {
    file_.reset();  // the file ends here, maybe with a record that is cut off
  }
}

}  // namespace move_base_abstract
