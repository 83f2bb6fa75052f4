// Copies of members' messages, which roscpp delivers in addition. They are meant for nodes that do
// not take part.
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
 * @brief Recognizes the copies on one topic, also those that come after their sender has left
 * lockstep.
 *
 * Every message over a connection that has brought copies of a member is a copy, because it comes
 * from the same process. Over a connection that has brought nothing yet, a message is a copy if it
 * equals one of the sender's last messages.
 */
class Copies {
 public:
  using Connection = boost::shared_ptr<ros::M_string>;  // by its header: roscpp has one for each

  /**
   * @return a number that is equal for a message and its copy. @param has_header whether the
   * message begins with a sequence number, which roscpp counts anew for copies.
   */
  static std::size_t digestOf(std::string_view message, bool has_header);

  /** @brief Note that a message of the member @p sender has come with a grant. */
  void delivered(const std::string& sender, std::size_t digest);
  /** @brief Note that a copy has come over @p connection while its sender was a member. */
  void came(const Connection& connection) { connections_.insert(connection); }
  /** @return whether a message of @p sender, which is not a member now, is a copy. */
  bool isCopy(const std::string& sender, const Connection& connection, std::size_t digest);

 private:
  std::set<boost::weak_ptr<ros::M_string>> connections_;
  std::map<std::string, std::deque<std::size_t>> last_;  // by sender, the latest at the end
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_COPIES_H
