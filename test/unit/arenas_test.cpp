// The memory of Python's objects: addresses follow from the order in which objects are made, and it
// is bounded.
#include "python_shim/arenas.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <set>
#include <vector>

using move_base_abstract::native::Arena;
using move_base_abstract::native::Arenas;
using move_base_abstract::native::NumberTable;

namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

/** @return the memory of this process [bytes]. */
std::size_t resident() {
  unsigned long pages = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  const bool is_read = file != nullptr && std::fscanf(file, "%*u %lu", &pages) == 1;
  if (file != nullptr) {
    std::fclose(file);
  }
  return is_read ? pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) : 0;
}

/** Each test has the region to itself. */
class ArenasTest : public testing::Test {
 protected:
  void SetUp() override {
    arenas_ = new Arenas;
    ASSERT_TRUE(arenas_->reserve(salt_));
  }
  void TearDown() override {
    ::munmap(reinterpret_cast<void*>(Arenas::kBase), Arenas::kRoom);
    delete arenas_;
  }
  void again(std::uint64_t salt) {
    TearDown();
    salt_ = salt;
    SetUp();
  }
  void* make(Arena* arena) { return arenas_->allocate(arena, epoch_); }
  /** @brief Make @p count objects, of which one of @p one_of is kept, and at most @p most at a
   * time. */
  void churn(Arena* arena, int count, int one_of, std::size_t most) {
    std::vector<void*> kept;
    for (int k = 0; k < count; ++k) {
      void* const object = make(arena);
      ASSERT_NE(object, nullptr);
      std::memset(object, 0x5a, arena->size);
      if (k % one_of != 0) {
        arenas_->release(object, false);
        continue;
      }
      kept.push_back(object);
      if (kept.size() > most) {
        arenas_->release(kept.front(), false);
        kept.erase(kept.begin());
      }
    }
    for (void* const object : kept) {
      arenas_->release(object, false);
    }
  }
  std::uint64_t salt_ = 0;
  std::int64_t epoch_ = 1;
  Arenas* arenas_ = nullptr;
};

}  // namespace

TEST_F(ArenasTest, addressesFollowFromTheNameAndTheOrderAndNotFromWhatDies) {
  std::vector<std::vector<char*>> runs(3);
  for (std::size_t run = 0; run < runs.size(); ++run) {
    Arena* const other = arenas_->open(7, 96);
    Arena* const arena = arenas_->open(5, 50);
    for (int k = 0; k < 3000; ++k) {
      for (std::size_t n = 0; n < run; ++n) {
        make(other);  // threads without turns make others at any moment
      }
      runs[run].push_back(static_cast<char*>(make(arena)));
      ASSERT_TRUE(Arenas::has(runs[run].back()));
      ASSERT_EQ(Arenas::sizeOf(runs[run].back()), 64U);
      if (k % (3 + static_cast<int>(run)) == 0) {
        arenas_->release(runs[run][static_cast<std::size_t>(k)], run == 1);
      }
    }
    again(0);
  }
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_EQ(runs[0], runs[2]);
  for (std::size_t k = 1; k < runs[0].size(); ++k) {
    EXPECT_GE(runs[0][k] - runs[0][k - 1], 64);
  }
}

TEST_F(ArenasTest, anotherSaltPutsArenasElsewhereInAnotherOrder) {
  int swapped = 0;
  for (std::uint64_t salt = 0; salt < 20; ++salt) {
    again(salt);
    swapped += make(arenas_->open(1, 64)) > make(arenas_->open(2, 64)) ? 1 : 0;
  }
  EXPECT_GT(swapped, 2);
  EXPECT_LT(swapped, 18);
}

TEST_F(ArenasTest, arenasOfOneNameAreApartAndTheNextOneLiesWhereItDoesInEachRun) {
  std::vector<void*> first;
  for (int run = 0; run < 2; ++run) {
    for (std::size_t k = 0; k < 100; ++k) {
      Arena* const arena = arenas_->open(3, 64);
      void* const object = make(arena);
      if (run == 0) {
        first.push_back(object);
      } else {
        EXPECT_EQ(object, first[k]);
      }
      arenas_->leave(arena);  // its class is gone, its object is not
      arenas_->release(object, false);
    }
    again(0);
  }
  EXPECT_EQ(std::set<void*>(first.begin(), first.end()).size(), 100U);
}

TEST_F(ArenasTest, inAnotherEpochItDoesNotMatterHowManyWereMadeBefore) {
  std::set<void*> first;
  for (int before = 0; before < 3000; before += 1000) {
    Arena* const arena = arenas_->open(9, 64);
    for (int k = 0; k < before; ++k) {
      make(arena);
    }
    ++epoch_;
    first.insert(make(arena));
    again(0);
    epoch_ = 1;
  }
  EXPECT_EQ(first.size(), 1U);
}

TEST_F(ArenasTest, memoryIsBoundedWhateverFewAreKept) {
  Arena* const arena = arenas_->open(1, 64);
  churn(arena, 200000, 100, 500);  // the first memory of this process
  const std::size_t before = resident();
  churn(arena, 1500000, 100, 500);
  EXPECT_LT(resident(), before + 8 * kMiB);
  EXPECT_LE(arena->resident, 2 * Arenas::kMany);
  EXPECT_EQ(arenas_->trouble(), 0U);
}

TEST_F(ArenasTest, addressesThatAreUsedAgainAreTheSameIfAllWasGivenBackInOrder) {
  std::vector<std::vector<void*>> runs(2);
  for (auto& run : runs) {
    Arena* const arena = arenas_->open(1, 64);
    for (int k = 0; k < 400000; ++k) {
      void* const object = make(arena);
      run.push_back(object);
      if (k % 50 != 0) {
        arenas_->release(object, false);
      }
    }
    again(0);
  }
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_LT(std::set<void*>(runs[0].begin(), runs[0].end()).size(), 200000U);
}

TEST_F(ArenasTest, itIsToldIfAddressesAreUsedAgainThatWereGivenBackAtAMomentOfTheWallClock) {
  Arena* const arena = arenas_->open(1, 64);
  for (int k = 0; k < 70000; ++k) {
    void* const object = make(arena);
    if (k % 100 != 0) {
      arenas_->release(object, k == 5);
    }
  }
  EXPECT_EQ(arenas_->trouble(), 0U + Arenas::kMixed);
}

TEST_F(ArenasTest, aSpanWhoseObjectsAreDeadGivesBackItsAddresses) {
  Arena* const arena = arenas_->open(1, 4096);
  std::set<std::uintptr_t> spans;
  for (int k = 0; k < 100000; ++k) {
    void* const object = make(arena);
    spans.insert(reinterpret_cast<std::uintptr_t>(object) / Arenas::kSpan);
    arenas_->release(object, false);
  }
  EXPECT_GT(spans.size(), 4U);
  EXPECT_LE(arena->resident, 1U);
}

TEST_F(ArenasTest, objectsThatAreTooLargeHaveNone) {
  EXPECT_EQ(make(arenas_->open(1, Arenas::kBlock)), nullptr);
  EXPECT_NE(make(arenas_->open(1, Arenas::kBlock / 2)), nullptr);
}

TEST_F(ArenasTest, whatIsGivenBackTwiceEndsTheProcess) {
  void* const object = make(arenas_->open(1, 64));
  arenas_->release(object, false);
  EXPECT_DEATH(arenas_->release(object, false), "given back twice");
}

TEST(NumberTable, FindsWhatIsThereAfterAnyRemovals) {
  NumberTable<std::uint64_t> table;
  std::set<std::uint64_t> there;
  std::uint64_t number = 1;
  for (int k = 0; k < 20000; ++k) {
    number = move_base_abstract::native::mixed(number);
    const std::uint64_t key = number % 700 + 1;
    if (there.erase(key) != 0) {
      table.remove(key);
    } else {
      there.insert(key);
      *table.add(key, 0) = key * 3;
    }
    ASSERT_EQ(table.count(), there.size());
  }
  for (std::uint64_t key = 1; key <= 700; ++key) {
    const std::uint64_t* const value = table.find(key);
    ASSERT_EQ(value != nullptr, there.count(key) != 0);
    ASSERT_TRUE(value == nullptr || *value == key * 3);
  }
}
