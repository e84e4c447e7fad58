#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/record/run_file.hpp"

namespace verisim::schema_test {
namespace {

Column column(const std::string& path, Dtype dtype, std::size_t width) {
  return {.path = path, .dtype = dtype, .width = width, .units = "1", .description = "x", .enum_names = {}};
}

TEST(Schema, PacksColumnsWithoutPaddingInTheOrderOfAdding) {
  Schema s;
  s.add(column("/state/time", Dtype::f64, 1));
  s.add(column("/state/flag", Dtype::u8, 1));
  s.add(column("/state/pose", Dtype::f64, 7));
  s.add(column("/state/hash", Dtype::u64, 1));
  s.add(column("/cost/points", Dtype::u32, 1));
  EXPECT_EQ(s.columns()[2].offset, 9u);
  EXPECT_EQ(s.state_bytes(), 8u + 1 + 56);  // without the hash, which is of these bytes
  EXPECT_EQ(s.row_bytes(), 8u + 1 + 56 + 8 + 4);
}

TEST(Schema, RefusesTwoColumnsOfOnePath) {
  Schema s;
  s.add(column("/state/body/pin/pose", Dtype::f64, 7));
  EXPECT_THROW(s.add(column("/state/body/pin/pose", Dtype::f64, 7)), Error);
}

TEST(SchemaDeathTest, InsistsOnStateFirst) {
  Schema s;
  s.add(column("/cost/points", Dtype::u32, 1));
  EXPECT_DEATH(s.add(column("/state/time", Dtype::f64, 1)), "state_bytes_");
}

}  // namespace
}  // namespace verisim::schema_test
