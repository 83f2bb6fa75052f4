// Which messages a program wants at once: the listener of tf2 only puts them by.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_HEARING_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_HEARING_H

#include <ros/callback_queue.h>
#include <ros/subscribe_options.h>

#include "topics.h"

namespace move_base_abstract::shim {

/** @brief The program has subscribed to @p topic (once more). For who has the turn. */
void noteSubscription(Topic& topic, const ros::SubscribeOptions& options);

/** @brief It does so no more. */
void forgetSubscription(Topic& topic);

/** @brief A thread is about to wait for what comes into @p queue; @p last: on which it has last. */
void noteWait(const void** last, const ros::CallbackQueue* queue);

/** @return whether anything is kept for the program until it looks. */
bool hearsUnread();

/** @brief A loop of tf2's own handles what is in @p queue: nobody else can get at it. */
void becomeListener(ros::CallbackQueue* queue);

/** @brief A loop is over; nothing where it was that of no listener. */
void forgetListener(const void* queue);

/** @brief A buffer of the program's is to call back what waits for transforms. */
void beginCallingBack();

/** @brief Put by what has come with a grant, before anybody looks for it: no thread of a listener
 * need be woken for that. */
void putTransformsBy();

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_HEARING_H
