// The heap whose addresses are a function of the calls: what is handed out twice, and what is not.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <vector>

#include "roscpp_shim/machine/ordered_heap.h"

using move_base_abstract::shim::OrderedHeap;

namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

/** Each test has the region to itself. */
class OrderedHeapTest : public testing::Test {
 protected:
  void SetUp() override { heap_ = new OrderedHeap; }
  void TearDown() override {
    ::munmap(reinterpret_cast<void*>(OrderedHeap::kBase), OrderedHeap::kRoom);
    delete heap_;
  }
  void* get(std::size_t size, std::size_t alignment = 16) {
    return heap_->allocate(size, alignment);
  }
  OrderedHeap* heap_ = nullptr;
};

}  // namespace

TEST_F(OrderedHeapTest, addressesFollowFromTheCalls) {
  std::vector<std::vector<void*>> runs(2);
  for (auto& run : runs) {
    std::mt19937 generator(1);
    for (int k = 0; k < 5000; ++k) {
      run.push_back(get(generator() % 3000));
      ASSERT_NE(run.back(), nullptr);
      if (generator() % 3 == 0) {
        heap_->release(run[generator() % run.size()] = run.back());
        run.back() = get(generator() % 3000);
      }
    }
    TearDown();
    SetUp();
  }
  EXPECT_EQ(runs[0], runs[1]);
}

TEST_F(OrderedHeapTest, blocksAreApartAlignedAndLargeEnough) {
  std::mt19937 generator(2);
  std::map<char*, std::size_t> blocks;
  for (int k = 0; k < 20000; ++k) {
    if (k % 3 == 2) {
      const auto at = std::next(blocks.begin(), static_cast<long>(generator() % blocks.size()));
      heap_->release(at->first);
      blocks.erase(at);
      continue;
    }
    const std::size_t size = generator() % (std::size_t{1} << generator() % 20);
    const std::size_t alignment = std::size_t{16} << generator() % 10;
    auto* const block = static_cast<char*>(get(size, alignment));
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(block) % alignment, 0U);
    ASSERT_GE(heap_->sizeOf(block), std::max(size, std::size_t{1}));
    ASSERT_TRUE(heap_->fits(block, heap_->sizeOf(block)));
    ASSERT_FALSE(heap_->fits(block, heap_->sizeOf(block) + 1));
    std::memset(block, 1, heap_->sizeOf(block));
    const auto next = blocks.emplace(block, heap_->sizeOf(block)).first;
    if (next != blocks.begin()) {
      ASSERT_LE(std::prev(next)->first + std::prev(next)->second, block);
    }
    if (std::next(next) != blocks.end()) {
      ASSERT_LE(block + next->second, std::next(next)->first);
    }
  }
}

TEST_F(OrderedHeapTest, blocksHoldZerosWhetherTheyAreNewOrNotOrHaveGivenTheirMemoryBack) {
  for (const std::size_t size : {std::size_t{100}, 3 * kMiB, 65 * kMiB}) {
    const void* last = nullptr;
    for (int k = 0; k < 2; ++k) {
      auto* const block = static_cast<char*>(get(size));
      EXPECT_TRUE(last == nullptr || last == block);
      EXPECT_EQ(std::count(block, block + size, '\0'), static_cast<long>(size));
      std::memset(block, 1, size);
      heap_->release(block);
      last = block;
    }
  }
}

TEST_F(OrderedHeapTest, whatIsSetAsideIsHandedOutAgainOnlyWhereItIsTooMuch) {
  void* const first = get(64);
  heap_->setAside(first);
  EXPECT_NE(get(64), first);
  EXPECT_FALSE(heap_->isMixed());
  for (std::size_t bytes = 0; bytes <= OrderedHeap::kMostAside; bytes += kMiB) {
    heap_->setAside(get(kMiB));
  }
  get(64);
  EXPECT_TRUE(heap_->isMixed());
}

TEST_F(OrderedHeapTest, largeBlocksThatAreFreeKeepLittleMemory) {
  std::vector<void*> blocks;
  for (int k = 0; k < 40; ++k) {
    blocks.push_back(get(8 * kMiB));
    std::memset(blocks.back(), 1, 8 * kMiB);
  }
  std::size_t kept = 0;
  for (void* const block : blocks) {
    heap_->release(block);
    std::vector<unsigned char> pages(8 * kMiB / 4096);
    ASSERT_EQ(::mincore(block, 8 * kMiB, pages.data()), 0);
    kept += static_cast<std::size_t>(
        std::count_if(pages.begin(), pages.end(), [](unsigned char page) { return page & 1; }));
  }
  EXPECT_LE(kept * 4096, 65 * kMiB);
}

TEST_F(OrderedHeapTest, whatItHasNoRoomForItDoesNotGive) {
  EXPECT_EQ(get(64, OrderedHeap::kChunk * 2), nullptr);
  EXPECT_EQ(get(~std::size_t{0}), nullptr);
  EXPECT_FALSE(heap_->isFull());
  int large = 0;
  while (get(std::size_t{3} << 34) != nullptr) {
    ++large;
  }
  EXPECT_EQ(large, 2);
  EXPECT_TRUE(heap_->isFull());
  EXPECT_NE(get(64), nullptr);
}

TEST_F(OrderedHeapTest, aRegionThatIsTakenIsRefused) {
  void* const wished = reinterpret_cast<void*>(OrderedHeap::kBase);
  void* const taken =
      ::mmap(wished, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
  ASSERT_EQ(taken, wished);
  EXPECT_EQ(get(64), nullptr);
  EXPECT_TRUE(heap_->isRefused());
}

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
