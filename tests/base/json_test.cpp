#include "engine/base/json.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace verisim::json_test {
namespace {

TEST(JsonText, KeepsTheOrderOfMembers) {
  EXPECT_EQ(json_text(parse_json(R"({"b": 1, "a": [2, null]})")), R"({"b":1,"a":[2,null]})");
  EXPECT_EQ(json_text(parse_json(R"({"b":1})"), 2), "{\n  \"b\": 1\n}");
}

TEST(JsonText, IsValidWhateverBytesANameHas) {
  EXPECT_EQ(json_text(Json("a\xff")), "\"a\xef\xbf\xbd\"");
}

TEST(ParseJson, TellsTheLineOfWhatAUserGave) {
  try {
    (void)parse_json_of("bounds.json", "{\n  \"a\": 1,\n  b\n}", "make it again");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_STREQ(error.what(), "bounds.json:3: is no JSON, or the file ends there; make it again");
  }
  EXPECT_TRUE(parse_json_or_discard("{").is_discarded());
  EXPECT_THROW((void)parse_json("{"), Json::parse_error);
}

}  // namespace
}  // namespace verisim::json_test
