// The rules of lockstep, which hold but in the build of their own tests.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RULES_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RULES_H

namespace move_base_abstract {

/**
 * @brief The rules of lockstep, one by one (docs/lockstep_protocol.md, "Rounds" and the sections
 * after it, says them in full).
 *
 * All of them hold. A build of the tests can switch each off, to see that a test misses it; in any
 * other build they are constants.
 */
#ifdef MOVE_BASE_ABSTRACT_MUTANTS
#define LOCKSTEP_RULE bool
#else
#define LOCKSTEP_RULE static constexpr bool
#endif
struct LockstepRules {
  LOCKSTEP_RULE barrier = true;  // nothing is decided while a granted participant works
  LOCKSTEP_RULE grant_only_concerned = true;  // neither mail nor a due time: no grant
  LOCKSTEP_RULE deliver_before_leap = true;   // mail first, then time
  LOCKSTEP_RULE later_than_sent = true;       // delivered in a later microstep
  LOCKSTEP_RULE leap_to_smallest = true;      // no wake-up is skipped
  LOCKSTEP_RULE time_never_back = true;       // a wake-up in the past is due now
  LOCKSTEP_RULE microstep_bound = true;       // a zero-delay loop is stopped and named
  LOCKSTEP_RULE sort_by_rank = true;
  LOCKSTEP_RULE sort_by_sub = true;
  LOCKSTEP_RULE natural_order = true;  // robot_2 before robot_10
  LOCKSTEP_RULE fifo_within_sender = true;
  LOCKSTEP_RULE apply_in_order = true;       // by (rank, name), not by arrival
  LOCKSTEP_RULE links_are_mail = true;       // a new link is confirmed before time moves
  LOCKSTEP_RULE replace = true;              // the newer of two of one name counts
  LOCKSTEP_RULE calls_in_next_round = true;  // a call waits for no wake-up of its server
  LOCKSTEP_RULE knock_counts = true;         // input from outside gets a grant
  LOCKSTEP_RULE dead_not_awaited = true;
  LOCKSTEP_RULE dead_delivers = true;  // what a dead one had reported is delivered
  LOCKSTEP_RULE dead_cancels_calls = true;
  LOCKSTEP_RULE silence_named = true;
  LOCKSTEP_RULE deadlock_named = true;
  LOCKSTEP_RULE work_is_not_owed = true;  // who waits for work is idle, while no goal is open
  LOCKSTEP_RULE goals_are_counted = true;
  LOCKSTEP_RULE gate_pause = true;
  LOCKSTEP_RULE gate_target = true;
  LOCKSTEP_RULE gate_limit = true;
  LOCKSTEP_RULE start_waits_for_named = true;
};
#undef LOCKSTEP_RULE

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RULES_H
