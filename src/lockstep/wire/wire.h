// The frames between the time master and its participants, as bytes. No ROS, no sockets.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_WIRE_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_WIRE_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "lockstep/wire/wire_format.h"

/**
 * The structures of frames and items are made of move_base_abstract/lockstep/wire_format.py.
 *
 * Little endian throughout. A frame is u32 length of what follows, u8 type, body; a text or bytes
 * field is u32 length, then as many bytes; a text is UTF-8. Every std::string_view that a decoder
 * returns lies in the frame that was decoded, and is good as long as that is.
 */
namespace move_base_abstract::wire {

/** @brief What was wrong with a frame: what was got, what is allowed, and where. */
class MalformedFrame : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/** @return the whole frame, its length included. */
std::string encode(const ParticipantFrame& frame);
std::string encode(const MasterFrame& frame);

/** @brief Append one item, so that a frame can be built while its items come up. */
void append(std::string& items, const ReportItem& item);
void append(std::string& items, const GrantItem& item);

/** @return a whole frame around @p items (see append); the items of @p head are left out. */
std::string encodeReport(const Report& head, std::string_view items);
std::string encodeGrant(const Grant& head, std::string_view items);

/** @return whether the frame (type and body) is a REPORT, well-formed or not. */
bool isReport(std::string_view frame);

/**
 * @param frame type and body, without the length (see FrameBuffer).
 * @throws MalformedFrame where it is not exactly one frame of that direction.
 */
ParticipantFrame decodeFromParticipant(std::string_view frame);
MasterFrame decodeFromMaster(std::string_view frame);

/** @brief Puts the frames of one direction of one connection together again. */
class FrameBuffer {
 public:
  void append(std::string_view bytes) { bytes_.append(bytes); }

  /**
   * @return type and body of the next complete frame, if there is one; good until the next call.
   * @throws MalformedFrame where the length is 0 or over @p largest; no frame comes after that.
   */
  std::optional<std::string_view> next(std::uint32_t largest = kLargestFrame);

  /** @return how many bytes of an incomplete frame wait here (after next() had nothing to give). */
  std::size_t waiting() const { return bytes_.size() - begin_; }

 private:
  std::string bytes_;
  std::size_t begin_ = 0;
};

}  // namespace move_base_abstract::wire

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_WIRE_H
