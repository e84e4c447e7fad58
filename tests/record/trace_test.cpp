// Traces in both formats: exact round trips, and every refusal of INTERFACES section 4 with its line and its remedy.
#include "engine/record/trace.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/record/output_place.hpp"
#include "tests/record/small_run.hpp"

namespace verisim::trace_test {
namespace {

using small_run::content_of;
using small_run::error_of;
using small_run::Folder;
using small_run::objects_with_times;

constexpr const char* kHead =
    "# verisim-trace 1\n# kind: haptic\n# rate_hz: 1000\n# source: a test\nt,px,py,pz,qx,qy,qz,qw\n";  // 5 lines

std::string haptic(const std::string& rows) {
  return kHead + rows;
}

Trace parse(const std::string& content, const TraceLimits& limits = {}) {
  return parse_trace("peg.csv", content, "", limits);
}

std::string refusal(const std::string& content, const TraceLimits& limits = {}) {
  const Error e = error_of([&] { parse(content, limits); });
  EXPECT_EQ(e.kind(), ErrorKind::input) << e.what();
  return e.what();
}

Trace random_trace(std::uint64_t seed) {
  const RandomStream random(seed, "trace");
  Trace trace{.kind = "encoder",
              .rate_hz = 100,
              .source = "drawn, with seed",
              .extra = {{"floor", "carpet: thick"}},
              .columns = {"t", "e0", "e1", "e2", "e3"},
              .values = {}};
  for (std::uint64_t i = 0; i < 200; ++i) {
    trace.values.push_back(static_cast<double>(i) / 100);
    for (std::uint64_t k = 1; k < 5; ++k) {
      trace.values.push_back(
          std::ldexp(random.uniform(5 * i + k) - 0.5, static_cast<int>(random.bits(5 * i + k) % 200) - 100));
    }
  }
  return trace;
}

void expect_equal(const Trace& a, const Trace& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.rate_hz, b.rate_hz);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.extra, b.extra);
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.values, b.values);
}

TEST(Trace, ComesBackFromCsvToTheBit) {
  const Folder folder;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Trace trace = random_trace(seed);
    write_trace(folder.file("a.csv"), trace);
    expect_equal(parse(content_of(folder.file("a.csv"))), trace);
  }
  EXPECT_EQ(folder.files(), 1u);
}

TEST(Trace, ComesBackFromHdf5ToTheBit) {
  const Folder folder;
  Trace trace = random_trace(1);
  for (const char* name : {"a.h5", "b.hdf5"}) {
    write_trace(folder.file(name), trace);
    expect_equal(parse(content_of(folder.file(name))), trace);
  }
  EXPECT_EQ(folder.files(), 2u);
}

TEST(Trace, OfOneSampleComesBackWithoutARate) {
  const Folder folder;
  Trace trace = random_trace(1);
  trace.rate_hz = 0;
  trace.values.resize(trace.columns.size());
  for (const char* name : {"a.csv", "a.h5"}) {
    write_trace(folder.file(name), trace);
    expect_equal(parse(content_of(folder.file(name))), trace);
    EXPECT_NO_THROW((void)check_output({folder.file(name), OutputKind::trace, false, ""})) << "it may be replaced";
  }
}

TEST(Trace, WritesTheSameBytesForTheSameTrace) {
  const Folder folder;
  write_trace(folder.file("a.h5"), random_trace(1));
  write_trace(folder.file("b.h5"), random_trace(1));
  EXPECT_TRUE(content_of(folder.file("a.h5")) == content_of(folder.file("b.h5")));
  EXPECT_EQ(objects_with_times(content_of(folder.file("a.h5"))), 0u) << "in another second they would differ";
}

TEST(Trace, ReadsTheFormOfTheInterfaces) {
  const Trace trace = parse(
      "# verisim-trace 1\n# kind: wii\n# rate_hz: 100\n# source: who: with what\n# leds: 0.1 0 0; -0.1 0 0\n"
      "t,battery,gx,gy,gz,x1,y1,s1,x2,y2,s2,x3,y3,s3,x4,y4,s4\n"
      "0,0.5,0,0,1,512,384,2,600,384,2,-1,-1,-1,-1,-1,-1\n");
  EXPECT_EQ(trace.kind, "wii");
  EXPECT_EQ(trace.rate_hz, 100);
  EXPECT_EQ(trace.source, "who: with what");
  EXPECT_EQ(trace.extra.at("leds"), "0.1 0 0; -0.1 0 0");
  EXPECT_EQ(trace.at(0, static_cast<std::size_t>(trace.column("x2"))), 600);
  EXPECT_EQ(trace.column("px"), -1);
}

TEST(Trace, AcceptsWhatOtherSystemsWrite) {
  std::string windows = haptic("0, 1,0,0,0,0,0,1\n0.001,+2.5e0 ,0,0,0,0,0,1\n");
  for (std::size_t at = 0; (at = windows.find('\n', at)) != std::string::npos; at += 2) windows.replace(at, 1, "\r\n");
  const Trace trace = parse("\xEF\xBB\xBF" + windows + "\r\n \n\n");
  EXPECT_EQ(trace.rows(), 2u);
  EXPECT_EQ(trace.at(1, 1), 2.5);
  EXPECT_EQ(trace.columns.back(), "qw");
  EXPECT_EQ(parse(haptic("0,1,0,0,0,0,0,1")).rows(), 1u);  // no newline at the end
}

TEST(Trace, SaysWhereTimeGoesBackwards) {
  EXPECT_EQ(refusal(haptic("12.031,0,0,0,0,0,0,1\n12.040,0,0,0,0,0,0,1\n12.031,0,0,0,0,0,0,1\n")),
            "peg.csv:8: time goes backwards (12.031 after 12.040); sort the trace or use --resort");
}

TEST(Trace, SortsIfAsked) {
  const std::string mixed = haptic("0.02,2,0,0,0,0,0,1\n0,0,0,0,0,0,0,1\n0.01,1,0,0,0,0,0,1\n");
  const Trace trace = parse(mixed, {.resort = true});
  for (std::size_t row = 0; row < 3; ++row) EXPECT_EQ(trace.at(row, 1), static_cast<double>(row));
  // A repeated time stays an error, and the message names the line in the file.
  const std::string message = refusal(mixed + "0.01,1,0,0,0,0,0,1\n", {.resort = true});
  EXPECT_TRUE(message.starts_with("peg.csv:9: time repeats (0.010)")) << message;
}

// 0.4 - 0.3 is more than 0.1 by its last bit.
TEST(Trace, OfTheLongestGapsThatAreAllowedIsRead) {
  for (const double step : {0.1, 0.05, 0.01}) {
    std::string text = "# verisim-trace 1\n# kind: haptic\n# source: a test\nt,px,py,pz,qx,qy,qz,qw\n";
    for (int i = 0; i < 200; ++i) text += fmt::format("{:.2f},0,0,0,0,0,0,1\n", step * i);
    TraceLimits limits;
    limits.max_gap = step;
    EXPECT_EQ(parse_trace("a.csv", text, "haptic", limits).rows(), 200U) << step;
  }
}

TEST(Trace, RefusesGapsUnlessTheyAreAllowed) {
  const std::string gap = haptic("0,0,0,0,0,0,0,1\n0.1,0,0,0,0,0,0,1\n0.25,0,0,0,0,0,0,1\n");
  EXPECT_EQ(refusal(gap), "peg.csv:8: a gap of 0.15 s (0.250 after 0.100) is longer than 0.1 s; fill it or allow gaps");
  EXPECT_EQ(parse(gap, {.allow_gaps = true}).rows(), 3u);
  EXPECT_EQ(parse(gap, {.max_gap = 0.2}).rows(), 3u);
}

TEST(Trace, RefusesBrokenRowsWithTheirLine) {
  const std::pair<std::string, std::string> cases[] = {
      {"0,0,0,0,0,0,0,1\n0,0,0,0,0,0,0,1\n", ":7: time repeats"},
      {"0,0,0,0,0,0,0,1\n0.01,0,0,nan,0,0,0,1\n", ":7: column 'pz' is nan"},
      {"0,inf,0,0,0,0,0,1\n", ":6: column 'px' is inf"},
      {"nan,0,0,0,0,0,0,1\n", ":6: column 't' is nan"},
      {"0,0,0,0,0,0,0\n", ":6: 7 fields where 8"},
      {"0,0,0,0,0,0,0,1,2\n", ":6: 9 fields where 8"},
      {"0,0,0,0,0,0,0,1\n\n0.01,0,0,0,0,0,0,1\n", ":7: 0 fields where 8"},
      {"0,0,0,left,0,0,0,1\n", ":6: column 'pz' is 'left'"},
      {"0,0,0,,0,0,0,1\n", ":6: column 'pz' is ''"},
      {"0,0,0,1 2,0,0,0,1\n", ":6: column 'pz' is '1 2'"},
      {"0,0,0,0,0,0,0,0\n", ":6: the quaternion's length is 0"},
      {"0,0,0,0,0,0,0,3\n", ":6: the quaternion's length is 3"},
      {"", ": holds no samples"}};
  for (const auto& [rows, message] : cases) {
    EXPECT_NE(refusal(haptic(rows)).find("peg.csv" + message), std::string::npos) << refusal(haptic(rows));
  }
}

TEST(Trace, RefusesWhatIsNoTrace) {
  const std::pair<std::string, std::string> cases[] = {
      {"", "is empty"},
      {"t,px,py,pz\n0,0,0,0\n", "begins with '# verisim-trace 1'"},
      {"# verisim-trace 2\n", "format 2"},
      {std::string("\x00\x01\xff garbage", 11), "begins with '# verisim-trace 1'"},
      {"# verisim-trace 1\n# rate_hz: 100\nt,px\n0,0\n", "does not say its kind"},
      {"# verisim-trace 1\n# kind: haptics\nt,px\n0,0\n", "unknown kind 'haptics'"},
      {"# verisim-trace 1\n# kind: haptic\n# rate_hz: fast\nt,px\n0,0\n", ":3: rate_hz is 'fast'"},
      {"# verisim-trace 1\n# kind: haptic\n# rate_hz: -1\nt,px\n0,0\n", ":3: rate_hz is '-1'"},
      {"# verisim-trace 1\n# kind: haptic\n", "column names are missing"},
      {"# verisim-trace 1\n# kind: haptic\nt,px,py,pz\n0,0,0,0\n", "needs the columns qx qy qz qw too"},
      {"# verisim-trace 1\n# kind: haptic\npx,py,pz,qx,qy,qz,qw,t\n0,0,0,0,0,0,1,0\n", "first column must be 't'"},
      {"# verisim-trace 1\n# kind: haptic\nt,px,py,pz,qx,qy,qz,qw,fx\n0,0,0,0,0,0,0,1,0\n",
       "needs the columns fy fz too"},
      {"# verisim-trace 1\n# kind: haptic\nt,px,py,pz,qx,qy,qz,qw,px\n0,0,0,0,0,0,0,1,0\n", "two columns 'px'"}};
  for (const auto& [content, message] : cases) {
    EXPECT_NE(refusal(content).find(message), std::string::npos) << refusal(content);
  }
}

TEST(Trace, OfAnotherKindThanExpectedIsRefused) {
  const Error e = error_of([] { static_cast<void>(parse_trace("peg.csv", haptic("0,0,0,0,0,0,0,1\n"), "wii", {})); });
  EXPECT_STREQ(e.what(), "peg.csv: is a haptic trace where a wii trace is needed; name another");
}

TEST(Trace, NormalisesQuaternionsAndLeavesUnitOnesAlone) {
  const Trace trace = parse(haptic("0,0,0,0,0,0,0.6,0.8\n0.001,0,0,0,0.9,0,0,1.2\n"));
  EXPECT_EQ(trace.at(0, 6), 0.6);
  EXPECT_EQ(trace.at(0, 7), 0.8);
  EXPECT_NEAR(trace.at(1, 4), 0.6, 1e-15);
  EXPECT_NEAR(trace.at(1, 7), 0.8, 1e-15);
}

TEST(Trace, InHdf5IsRefusedForTheSameReasons) {
  const Folder folder;
  Trace trace = random_trace(1);
  trace.values[5 * 17] = trace.values[5 * 16] - 0.001;
  write_trace(folder.file("a.h5"), trace);
  const Error e = error_of([&] { static_cast<void>(parse_trace("a.h5", content_of(folder.file("a.h5")), "", {})); });
  EXPECT_TRUE(std::string(e.what()).starts_with("a.h5: row 17: time goes backwards")) << e.what();
}

TEST(Trace, InDamagedHdf5IsRefused) {
  const Folder folder;
  write_trace(folder.file("a.h5"), random_trace(1));
  const std::string whole = content_of(folder.file("a.h5"));
  for (std::size_t length = 4; length < whole.size(); length += 97) {
    EXPECT_EQ(error_of([&] { parse(whole.substr(0, length)); }).kind(), ErrorKind::input) << length;
  }
  const RandomStream random(3, "flipped bits");
  for (std::uint64_t i = 0; i < 500; ++i) {
    std::string damaged = whole;
    damaged[random.bits(2 * i) % whole.size()] ^= static_cast<char>(1 << (random.bits(2 * i + 1) % 8));
    const Error e = error_of([&] { parse(damaged); });
    EXPECT_TRUE(e.kind() == ErrorKind::input || e.kind() == ErrorKind::check_failed) << e.what();
  }
}

TEST(Trace, IsWrittenWhollyOrNotAtAll) {
  const Folder folder;
  EXPECT_EQ(error_of([&] { write_trace(folder.file("no/such/a.csv"), random_trace(1)); }).kind(), ErrorKind::io);
  EXPECT_EQ(error_of([&] { write_trace(folder.file("no/such/a.h5"), random_trace(1)); }).kind(), ErrorKind::io);
  EXPECT_EQ(error_of([&] { write_trace(folder.file("a.txt"), random_trace(1)); }).kind(), ErrorKind::usage);
  EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace verisim::trace_test
