// A set lists what was added, ascending and once, and is empty then.
#include "engine/base/index_set.hpp"

#include <gtest/gtest.h>

#include <set>

#include "engine/base/random.hpp"

namespace verisim::index_set_test {
namespace {

TEST(IndexSet, ListsWhatWasAddedAscendingAndOnce) {
  const RandomStream random(3, "index set");
  std::uint64_t drawn = 0;
  for (const std::size_t size : {1, 63, 64, 65, 1000}) {
    IndexSet set(size);
    for (int round = 0; round < 20; ++round) {
      std::set<std::size_t> expected;
      for (std::size_t n = random.bits(drawn++) % (2 * size); n > 0; --n) {
        const std::size_t i = random.bits(drawn++) % size;
        set.add(i);
        expected.insert(i);
      }
      for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(set.has(i), expected.contains(i));
      std::vector<std::size_t> list{7};
      set.move_to(list);
      ASSERT_EQ(list.front(), 7U) << "appends";
      ASSERT_EQ(std::vector<std::size_t>(list.begin() + 1, list.end()),
                std::vector<std::size_t>(expected.begin(), expected.end()));
      set.move_to(list);
      ASSERT_EQ(list.size(), expected.size() + 1) << "is empty";
    }
  }
}

TEST(IndexSetDeathTest, HasRoomForItsSize) {
  IndexSet set(64);
  EXPECT_DEATH(set.add(64), "i / kBits < words_.size()");
  EXPECT_DEATH(static_cast<void>(set.has(64)), "i / kBits < words_.size()");
}

}  // namespace
}  // namespace verisim::index_set_test
