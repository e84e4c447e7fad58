#include "engine/batch/design_text.hpp"

#include <gtest/gtest.h>

namespace verisim::batch::design_text_test {
namespace {

using Parts = std::vector<std::string>;

TEST(SplitOutsideBrackets, LeavesWhatBracketsAndQuotesHoldTogether) {
  EXPECT_EQ(split_outside_brackets("1,2", ','), (Parts{"1", "2"}));
  EXPECT_EQ(split_outside_brackets("math.max(1,2),{3,{4,5}},[6,7]", ','),
            (Parts{"math.max(1,2)", "{3,{4,5}}", "[6,7]"}));
  EXPECT_EQ(split_outside_brackets("\"a,b\",'c,d'", ','), (Parts{"\"a,b\"", "'c,d'"}));
  EXPECT_EQ(split_outside_brackets("", ','), (Parts{""}));
  EXPECT_EQ(split_outside_brackets("1,", ','), (Parts{"1", ""}));
  EXPECT_EQ(split_outside_brackets("),1", ','), (Parts{")", "1"})) << "a bracket that was never opened closes nothing";
}

TEST(RangesText, JoinsWhatFollowsEachOther) {
  EXPECT_EQ(ranges_text({}), "");
  EXPECT_EQ(ranges_text({4}), "4");
  EXPECT_EQ(ranges_text({0, 2, 3, 4, 9, 10}), "0, 2 to 4, 9 to 10");
  EXPECT_EQ(ranges_text({0, 2, 4, 6}, 2), "0, 2, … (4 in all)");
}

}  // namespace
}  // namespace verisim::batch::design_text_test
