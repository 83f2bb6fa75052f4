// Which messages a program wants at once.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_INTEREST_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_INTEREST_H

#include <ros/callback_queue.h>
#include <ros/subscribe_options.h>

#include "topics.h"

namespace move_base_abstract::shim {

/** @brief The program has subscribed to @p topic (once more). For who has the turn. */
void noteSubscription(Topic& topic, const ros::SubscribeOptions& options);

/** @brief It does so no more. */
void forgetSubscription(Topic& topic);

/** @brief The calling thread is about to wait for what comes into @p queue. */
void noteWait(const ros::CallbackQueue* queue);

/** @return whether anything is kept for the program until it looks. */
bool keepsUnread();

/**
 * @brief What comes into @p queue is only put by, until the calling thread ends: nobody else can
 * get at it, and who looks for what was put by does so when it has something else to do.
 */
void storeFrom(ros::CallbackQueue* queue);

/** @brief What is put by acts at once from here on: somebody is called back. From any thread. */
void storeNoMore();

/** @brief Put by what has come with a grant, before anybody looks for it: no thread need be woken
 * for that. */
void store();

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_INTEREST_H
