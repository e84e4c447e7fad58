// Conversion of foreign recordings. The last tests convert every recording of the shared data, each by one set of
// options.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/record/trace.hpp"
#include "tests/record/small_run.hpp"
#include "tests/support/paths.hpp"

namespace verisim::convert_test {
namespace {

using small_run::content_of;
using small_run::error_of;

std::vector<ColumnMapping> mappings(const std::vector<std::string>& texts) {
  std::vector<ColumnMapping> all;
  for (const std::string& text : texts) all.push_back(parse_mapping(text));
  return all;
}

Trace convert(const std::string& content, const std::vector<std::string>& maps, ConvertOptions options = {}) {
  if (options.time_column.empty() && options.rate_hz == 0) options.rate_hz = 1000;
  options.mappings = mappings(maps);
  return convert_csv("foreign.csv", content, options);
}

TEST(Mapping, IsColumnTimesScalePlusOffset) {
  const ColumnMapping all = parse_mapping("px=2*0.075+0.1");
  EXPECT_EQ(all.target, "px");
  EXPECT_EQ(all.source, "2");
  EXPECT_EQ(all.scale, 0.075);
  EXPECT_EQ(all.offset, 0.1);
  const ColumnMapping name = parse_mapping(" px = Time (Seconds) * -1e-3 - 2 ");
  EXPECT_EQ(name.source, "Time (Seconds)");
  EXPECT_EQ(name.scale, -1e-3);
  EXPECT_EQ(parse_mapping("px=x-0.5").offset, -0.5);
  EXPECT_EQ(parse_mapping("px=x").scale, 1);
  EXPECT_EQ(parse_mapping("qw=:1").offset, 1);
  EXPECT_EQ(parse_mapping("qw=:1").source, "");
}

TEST(Mapping, IsRefusedWhenItMakesNoSense) {
  for (const char* text :
       {"", "px", "=1", "px=", "px=:", "px=:one", "px=1*", "px=1*x", "px=1*2*3", "px=1+x", "px=*2", "px=1*nan"}) {
    EXPECT_EQ(error_of([&] { static_cast<void>(parse_mapping(text)); }).kind(), ErrorKind::usage) << text;
  }
}

TEST(Convert, FindsSeparatorAndColumnNames) {
  const std::vector<std::string> contents = {"a,b\n1,2\n3,4\n", "\"a\";\"b\"\n1;2\n3;4", "a\tb\r\n1\t2\r\n3\t4\r\n\r\n",
                                             "a   b\n 1  2\n 3\t4\n",
                                             "\xEF\xBB\xBF# remark\n\na,b\n1,2\n% remark\n3,4\n"};
  for (const std::string& content : contents) {
    SCOPED_TRACE(content);
    for (const char* by : {"px=b", "px=2"}) {
      const Trace trace = convert(content, {by});
      ASSERT_EQ(trace.rows(), 2u);
      EXPECT_EQ(trace.at(0, 1), 2);
      EXPECT_EQ(trace.at(1, 1), 4);
    }
  }
  EXPECT_EQ(convert("1,2\n3,4\n", {"px=1"}).at(1, 1), 3);  // no names: the first line is a row
}

TEST(Convert, FillsWhatOneDegreeOfFreedomLacks) {
  const Trace trace = convert("1,2\n", {"px=1", "fx=2*-2"});
  const std::vector<std::string> columns = {"t", "px", "py", "pz", "qx", "qy", "qz", "qw", "fx", "fy", "fz"};
  EXPECT_EQ(trace.columns, columns);
  const std::vector<double> values = {0, 1, 0, 0, 0, 0, 0, 1, -4, 0, 0};
  EXPECT_EQ(trace.values, values);
}

TEST(Convert, TakesEveryNthRowAtItsOwnTime) {
  const Trace by_rate = convert("1\n2\n3\n4\n5\n", {"px=1"}, {.rate_hz = 2000, .every = 2});
  ASSERT_EQ(by_rate.rows(), 3u);
  EXPECT_EQ(by_rate.rate_hz, 1000);
  EXPECT_EQ(by_rate.at(2, 0), 0.002);
  EXPECT_EQ(by_rate.at(2, 1), 5);
  const Trace by_column = convert("35.3830,1\n35.3835,2\n35.3840,3\n", {"px=2"}, {.time_column = "1", .every = 2});
  EXPECT_EQ(by_column.at(1, 0), 0.001);  // not 0.00100000000000477
  EXPECT_EQ(by_column.rate_hz, 1000);
  EXPECT_EQ(convert("0,1\n250,2\n", {"px=2"}, {.time_column = "1", .time_scale = 1e-3}).at(1, 0), 0.25);
}

TEST(Convert, SumsIncrementsAlsoOfRowsThatItDoesNotTake) {
  const Trace trace = convert("0.1,1,1,1\n0.1,1,1,1\n0.1,1,1,1\n", {"e0=1*11520", "e1=2", "e2=3*-1", "e3=4+5"},
                              {.kind = "encoder", .rate_hz = 100, .every = 2, .cumulative = true});
  ASSERT_EQ(trace.rows(), 2u);
  const std::vector<double> last = {0.02, 3456, 3, -3, 8};
  EXPECT_EQ(std::vector<double>(trace.values.end() - 5, trace.values.end()), last);
}

TEST(Convert, LeavesOutRowsWithoutAValueAndCountsThem) {
  const Trace trace = convert("t,x\n0,1\n0.01,\n0.02,3\n0.03\n", {"px=x"}, {.time_column = "t"});
  EXPECT_EQ(trace.rows(), 2u);
  EXPECT_EQ(trace.extra.at("rows_left_out"), "2");
}

TEST(Convert, SaysWhatIsWrong) {
  const auto refusal = [](const std::string& content, const std::vector<std::string>& maps,
                          const ConvertOptions& options) {
    return std::string(error_of([&] { convert(content, maps, options); }).what());
  };
  EXPECT_NE(refusal("a,b\n1,2\n", {"px=speed"}, {}).find("has no column 'speed'"), std::string::npos);
  EXPECT_NE(refusal("force,b\n1,2\n", {"px=forces"}, {}).find("did you mean 'force'"), std::string::npos);
  EXPECT_NE(refusal("a,b\n1,2\n", {"px=3"}, {}).find("its columns are 1 to 2"), std::string::npos);
  EXPECT_NE(refusal("a,a\n1,2\n", {"px=a"}, {}).find("by its number"), std::string::npos);
  EXPECT_NE(refusal("1\n", {"pxx=1"}, {}).find("has no column 'pxx'"), std::string::npos);
  EXPECT_NE(refusal("1\n", {"px=1", "px=1"}, {}).find("mapped twice"), std::string::npos);
  EXPECT_NE(refusal("1\n", {"px=1", "qx=1"}, {}).find("qy qz qw"), std::string::npos);
  EXPECT_NE(refusal("a\n1\nx\n", {"px=a"}, {}).find("foreign.csv:3: column 1 is 'x'"), std::string::npos);
  EXPECT_NE(refusal("a,t\n1,0\n2,0\n", {"px=a"}, {.time_column = "t"}).find("foreign.csv:3: time repeats"),
            std::string::npos);
  EXPECT_NE(refusal("1\n", {"px=1"}, {.kind = "mouse"}).find("unknown kind"), std::string::npos);
  EXPECT_NE(refusal("", {"px=1"}, {}).find("holds no rows"), std::string::npos);
  EXPECT_NE(refusal("a\n", {"px=a"}, {}).find("no samples"), std::string::npos);
  EXPECT_NE(refusal("1\n\n", {"px=1"}, {.skip_rows = 5}).find("holds no rows"), std::string::npos);
  EXPECT_NE(refusal("1,2\n,2\n", {"e0=1", "e1=1", "e2=1", "e3=1"}, {.kind = "encoder", .cumulative = true})
                .find("increment of e0"),
            std::string::npos);
  const Error e =
      error_of([] { static_cast<void>(convert_csv("foreign.csv", "1\n", {.mappings = mappings({"px=1"})})); });
  EXPECT_EQ(e.kind(), ErrorKind::usage);  // neither rate nor time
}

/// A recording of the shared data; its content, or nothing if the folder is not there.
std::string shared(const std::string& file) {
  return content_of(paths::in_shared_data("traces/") + file);
}

#define SKIP_WITHOUT(content) \
  if ((content).empty())      \
  GTEST_SKIP() << "no recordings in " << paths::in_shared_data("traces") << ": their conversion was not tried"

TEST(ConvertRecording, OfTheLeverRig) {
  for (const char* file : {"q1a_free_motion", "q1a_foam", "q1a_spring", "q1a_rigid", "q1c_rigid", "m2_q1a_free_motion",
                           "m2_q1a_foam", "m2_q1a_spring", "m2_q1a_rigid", "m2_q1e_rigid"}) {
    SCOPED_TRACE(file);
    const std::string content = shared(std::string("bilateral_1dof_tue/") + file + ".csv");
    SKIP_WITHOUT(content);
    const Trace trace = convert(content, {"px=x_m_rad*0.075"}, {.time_column = "t_s", .every = 2});
    const auto rows = static_cast<std::size_t>(std::count(content.begin(), content.end(), '\n')) - 1;
    EXPECT_EQ(trace.rows(), (rows + 1) / 2);
    EXPECT_EQ(trace.rate_hz, 1000);
    for (std::size_t i = 0; i < trace.rows(); ++i) ASSERT_EQ(trace.at(i, 0), static_cast<double>(i) / 1000);
    EXPECT_EQ(trace.at(0, 7), 1);  // identity
  }
}

TEST(ConvertRecording, OfTheHandGuidedTool) {
  for (const char* file : {"symbol17_rec0", "symbol17_rec1", "symbol17_rec2"}) {
    SCOPED_TRACE(file);
    const std::string content = shared(std::string("panda_hand_guided/") + file + ".csv");
    SKIP_WITHOUT(content);
    const Trace trace = convert(content, {"px=px_m", "py=py_m", "pz=pz_m", "fx=fx_N", "fy=fy_N", "fz=fz_N"},
                                {.time_column = "t_nominal_s"});
    EXPECT_EQ(trace.rate_hz, 1000);
    EXPECT_EQ(trace.rows(), static_cast<std::size_t>(std::count(content.begin(), content.end(), '\n')) - 1);
    // Pen on paper: the path is 0.09 m x 0.15 m (README of the recording).
    double low = 1, high = -1;
    for (std::size_t i = 0; i < trace.rows(); ++i) {
      low = std::min(low, trace.at(i, 2));
      high = std::max(high, trace.at(i, 2));
    }
    EXPECT_GT(high - low, 0.07);
    EXPECT_LT(high - low, 0.2);
  }
}

TEST(ConvertRecording, OfTheMecanumRobot) {
  for (const char* file : {"circular_080920201015/080920201015_run-01", "circular_080920201015/080920201015_run-04",
                           "circular_080920201015/080920201015_run-10", "square_080920201205/080920201205_run-01",
                           "square_080920201205/080920201205_run-02", "square_080920201205/080920201205_run-03"}) {
    SCOPED_TRACE(file);
    const std::string content = shared(std::string("mecanum_omni4/") + file + ".csv");
    SKIP_WITHOUT(content);
    const Trace trace =
        convert(content, {"e0=5*11520", "e1=6*11520", "e2=7*11520", "e3=8*11520", "x=2", "y=3", "theta=4"},
                {.kind = "encoder", .time_column = "1", .cumulative = true});
    EXPECT_EQ(trace.rows(), static_cast<std::size_t>(std::count(content.begin(), content.end(), '\n')));
    EXPECT_EQ(trace.rate_hz, 100);
    for (std::size_t i = 0; i < trace.rows(); ++i) {
      for (std::size_t wheel = 1; wheel <= 4; ++wheel) ASSERT_EQ(trace.at(i, wheel), std::round(trace.at(i, wheel)));
    }
  }
}

// The raw odometry is exactly the negative of the synchronised file, row for row (README of the recording).
TEST(ConvertRecording, OfTheMecanumRobotsRawOdometry) {
  const std::string raw = shared("mecanum_omni4/square_080920201205/080920201205_run-01_odo.csv");
  SKIP_WITHOUT(raw);
  const Trace odometry = convert(raw, {"e0=2*-11520", "e1=3*-11520", "e2=4*-11520", "e3=5*-11520"},
                                 {.kind = "encoder", .time_column = "1", .cumulative = true});
  const Trace synchronised = convert(shared("mecanum_omni4/square_080920201205/080920201205_run-01.csv"),
                                     {"e0=5*11520", "e1=6*11520", "e2=7*11520", "e3=8*11520"},
                                     {.kind = "encoder", .time_column = "1", .cumulative = true});
  ASSERT_EQ(odometry.rows(), synchronised.rows());
  EXPECT_EQ(odometry.values, synchronised.values);
}

TEST(ConvertRecording, OfTheMotionCapture) {
  const std::string content = shared("mecanum_omni4/square_080920201205/080920201205_run-01_opti.csv");
  SKIP_WITHOUT(content);
  const Trace trace = convert(content, {"px=6", "py=7", "pz=8"}, {.time_column = "Time (Seconds)", .skip_rows = 6});
  EXPECT_EQ(trace.rows(), 7386u);  // 7387, one of them without a pose
  EXPECT_EQ(trace.extra.at("rows_left_out"), "1");
  EXPECT_EQ(trace.rate_hz, 99.986);
  EXPECT_EQ(trace.at(0, 1), -0.589259);
}

}  // namespace
}  // namespace verisim::convert_test
