// What holds leaps of time back: pause, step, run until, the speed limit.
#include "session.h"

namespace move_base_abstract {

void LockstepSession::pause() {
  rounds_.pause();
  poll_due_ = true;
}

void LockstepSession::resume() {
  rounds_.resume();
  keepEnd();
  poll_due_ = true;
}

Nanoseconds LockstepSession::step(Nanoseconds duration) {
  const Nanoseconds target = rounds_.step(duration);
  keepEnd();
  poll_due_ = true;
  return target;
}

void LockstepSession::runUntil(Nanoseconds target) {
  rounds_.runUntil(target);
  keepEnd();
  poll_due_ = true;
}

void LockstepSession::setLimit(double factor) {
  rounds_.setLimit(factor);
  poll_due_ = true;
}

/** @brief Time does not leap over end_at, whatever else the gate is told. */
void LockstepSession::keepEnd() {
  const Nanoseconds end = toNanoseconds(settings_.end_at);
  if (end != 0 && !rounds_.paused() && rounds_.target().value_or(kNever) > end) {
    rounds_.runUntil(end);
  }
}

}  // namespace move_base_abstract
