// The statements that two nodes of the tests make each second: broken, kept, and never true.
#ifndef MOVE_BASE_ABSTRACT_TEST_STATEMENTS_H
#define MOVE_BASE_ABSTRACT_TEST_STATEMENTS_H

#include <move_base_abstract/properties.h>

inline void stateAll(int k) {
  using namespace move_base_abstract::properties;
  always(k < 3, "k stays small", {detail("k", k), detail("a\n\"b\"", 0.5)});
  sometimes(k > 10, "k gets large");
  sometimes(k > 1, "k gets past 1");
  never_again(k % 2 == 1, "k is odd once");
}

#endif  // MOVE_BASE_ABSTRACT_TEST_STATEMENTS_H
