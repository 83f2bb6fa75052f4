// The frames between the time master and its participants, as bytes. No ROS, no sockets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "lockstep/wire/wire_format.h"

/**
 * The structures of frames and items are generated from move_base_abstract/lockstep/wire_format.py.
 *
 * All numbers are little endian. A frame is a u32 length of the rest, a u8 type, and a body. A text
 * or bytes field is a u32 length, then as many bytes; a text is UTF-8. Every std::string_view that
 * a decoder returns points into the decoded frame, and is valid as long as that exists.
 */
namespace move_base_abstract::wire {

/** @brief A frame is malformed. The text says what was got, what is allowed, and where. */
class MalformedFrame : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/** @return the whole frame, its length included. */
std::string encode(const ParticipantFrame& frame);
std::string encode(const MasterFrame& frame);

/** @brief Append one encoded item to @p items, so that a frame can be built item by item. */
void append(std::string& items, const ReportItem& item);
void append(std::string& items, const GrantItem& item);

/** @return a whole frame with @p items from append(). The items in @p head are ignored. */
std::string encodeReport(const Report& head, std::string_view items);
std::string encodeGrant(const Grant& head, std::string_view items);

/** @return whether @p frame (type and body) is a REPORT, well-formed or not. */
bool isReport(std::string_view frame);

/**
 * @param frame type and body, without the length (see FrameBuffer).
 * @throws MalformedFrame if it is not exactly one frame of that direction.
 */
ParticipantFrame decodeFromParticipant(std::string_view frame);
MasterFrame decodeFromMaster(std::string_view frame);

/** @brief Reassembles the frames of one direction of a connection from pieces of bytes. */
class FrameBuffer {
 public:
  void append(std::string_view bytes) { bytes_.append(bytes); }

  /**
   * @return type and body of the next complete frame, if there is one. It is valid until the next
   * call.
   * @throws MalformedFrame if the length is 0 or over @p largest. No frame comes after that.
   */
  std::optional<std::string_view> next(std::uint32_t largest = kLargestFrame);

  /** @return the number of bytes of an incomplete frame, after next() has returned nothing. */
  std::size_t waiting() const { return bytes_.size() - begin_; }

 private:
  std::string bytes_;
  std::size_t begin_ = 0;
};

}  // namespace move_base_abstract::wire
