// Which messages a program wants at once, and which can be kept for later.
#pragma once

#include <ros/callback_queue.h>
#include <ros/subscribe_options.h>

#include "topics.h"

namespace move_base_abstract::shim {

/** @brief Note that the program has subscribed to @p topic (once more). @pre The thread has the
 * turn. */
void noteSubscription(Topic& topic, const ros::SubscribeOptions& options);

/** @brief Note that the program has unsubscribed. */
void forgetSubscription(Topic& topic);

/** @brief Note that the calling thread is about to wait for callbacks in @p queue. */
void noteWait(const ros::CallbackQueue* queue);

/** @return whether messages may be kept for the program until it looks into its queues. */
bool keepsUnread();

/**
 * @brief Until the calling thread ends, callbacks in @p queue only store their messages.
 *
 * No other thread has access to the queue. Threads that look at the stored data do so when they
 * have something else to do.
 */
void storeFrom(ros::CallbackQueue* queue);

/** @brief From now on stored messages act at once, because storing them calls a function of the
 * program. From any thread. */
void storeNoMore();

/** @brief Store the messages that came with a grant before any thread looks at them. No thread has
 * to be woken for that. */
void store();

}  // namespace move_base_abstract::shim
