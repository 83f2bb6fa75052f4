// Copies of members' messages, which roscpp brings besides: they are meant for those that take no
// part.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_COPIES_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_COPIES_H

#include <ros/datatypes.h>

#include <boost/shared_ptr.hpp>
#include <boost/weak_ptr.hpp>
#include <cstddef>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace move_base_abstract::lockstep::internal {

/**
 * @brief Knows the copies on one topic, also those that come after their sender has left lockstep.
 *
 * What comes over a connection that has brought a member's copies is one: it is the same process.
 * Over a connection that has brought nothing yet, what equals one of the sender's last messages is.
 */
class Copies {
 public:
  using Connection = boost::shared_ptr<ros::M_string>;  // its header, of which roscpp has one each

  /** @return a number for a message that its copy has too; @p has_header: roscpp counts anew. */
  static std::size_t digestOf(std::string_view message, bool has_header);

  /** @brief A message of the member @p sender has come with a grant. */
  void delivered(const std::string& sender, std::size_t digest);
  /** @brief A copy has come over @p connection while its sender was a member. */
  void came(const Connection& connection) { connections_.insert(connection); }
  /** @return whether a message of @p sender, which is no member now, is a copy. */
  bool isCopy(const std::string& sender, const Connection& connection, std::size_t digest);

 private:
  std::set<boost::weak_ptr<ros::M_string>> connections_;
  std::map<std::string, std::deque<std::size_t>> last_;  // of each sender, the latest at the end
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_COPIES_H
