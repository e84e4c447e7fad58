// What a fact is stored as follows from its getter; state comes first, whatever the order of adding.
#include "engine/base/columns.hpp"

#include <gtest/gtest.h>

namespace verisim::columns_test {
namespace {

template <typename T>
T value_at(const std::vector<std::byte>& row, std::size_t offset) {
  T value;
  std::memcpy(&value, row.data() + offset, sizeof value);
  return value;
}

TEST(Columns, PutStateFirstAndEachInTheOrderOfAdding) {
  Columns columns;
  columns.add("/cost/work", "1", "work", [] { return std::uint32_t{7}; });
  columns.add("/state/a", "m", "first", [] { return 1.5; });
  columns.add("/cost/more", "1", "more", [] { return std::uint32_t{8}; });
  columns.add(
      "/state/b", "1", "second", [] { return true; }, {"no", "yes"}, "/cost/work");
  ASSERT_EQ(columns.state().size(), 2U);
  ASSERT_EQ(columns.other().size(), 2U);
  EXPECT_EQ(columns.state()[1].path, "/state/b");
  EXPECT_EQ(columns.state()[1].dtype, Dtype::u8);
  EXPECT_EQ(columns.state()[1].enum_names[1], "yes");
  EXPECT_EQ(columns.state()[1].due, "/cost/work");
  EXPECT_EQ(columns.state_bytes(), 9U);
  std::vector<std::byte> row(columns.state_bytes() + columns.other_bytes());
  columns.put_state(row.data());
  columns.put_other(row.data() + columns.state_bytes());
  EXPECT_EQ(value_at<double>(row, 0), 1.5);
  EXPECT_EQ(value_at<std::uint8_t>(row, 8), 1U);
  EXPECT_EQ(value_at<std::uint32_t>(row, 9), 7U);
  EXPECT_EQ(value_at<std::uint32_t>(row, 13), 8U);
}

// Quaternions leave the program as x, y, z, w; a wrench and a twist begin with their linear part.
TEST(Columns, StorePosesTwistsAndWrenchesInTheOrderThatIsPromised) {
  Columns columns;
  columns.add("/state/pose", "", "", [] { return Pose{{1, 2, 3}, Quaterniond(/*w=*/7, 4, 5, 6)}; });
  columns.add("/state/twist", "", "", [] { return Twist{{8, 9, 10}, {11, 12, 13}}; });
  columns.add("/state/wrench", "", "", [] { return Wrench{{14, 15, 16}, {17, 18, 19}}; });
  columns.add("/state/list", "", "", [] { return std::array{20.0, 21.0}; });
  std::vector<std::byte> row(columns.state_bytes());
  columns.put_state(row.data());
  ASSERT_EQ(row.size(), 21 * sizeof(double));
  for (std::size_t i = 0; i < 21; ++i) EXPECT_EQ(value_at<double>(row, i * sizeof(double)), static_cast<double>(i + 1));
}

// Facts before, between and behind the parts are written every time.
TEST(Columns, WriteThePartsThatAreNamedAndLeaveTheOthers) {
  double now = 1;
  Columns columns;
  const auto add = [&](const char* path) { columns.add(path, "", "", [&] { return now; }); };
  add("/state/before");
  for (int part = 0; part < 3; ++part) {
    columns.begin_part();
    add("/state/x");
    add("/cost/x");
    add("/state/y");
    columns.end_part();
    if (part == 1) add("/state/between");
  }
  add("/state/behind");
  std::vector<std::byte> row(columns.state_bytes());
  const auto values = [&] {
    std::vector<double> all;
    for (std::size_t at = 0; at < row.size(); at += sizeof now) all.push_back(value_at<double>(row, at));
    return all;
  };
  columns.put_state(row.data());
  now = 2;
  columns.put_state(row.data(), std::vector<std::size_t>{2, 0});
  EXPECT_EQ(values(), (std::vector<double>{2, 2, 2, 1, 1, 2, 2, 2, 2}));
  now = 3;
  columns.put_state(row.data(), {});
  EXPECT_EQ(values(), (std::vector<double>{3, 2, 2, 1, 1, 3, 2, 2, 3}));
  std::size_t bytes = 0;
  columns.each_written(std::vector<std::size_t>{1}, [&](std::size_t, std::size_t run) { bytes += run; });
  EXPECT_EQ(bytes, 5 * sizeof now);
}

TEST(Columns, ReadTheirValuesAnewForEveryRow) {
  double now = 1;
  Columns columns;
  columns.add("/state/now", "s", "", [&] { return now; });
  std::vector<std::byte> row(sizeof now);
  for (now = 2; now < 5; ++now) {
    columns.put_state(row.data());
    EXPECT_EQ(value_at<double>(row, 0), now);
  }
}

}  // namespace
}  // namespace verisim::columns_test
