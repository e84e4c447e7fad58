// Synthesized motions against their closed forms.
#include "engine/record/synth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "tests/record/small_run.hpp"

namespace verisim::synth_test {
namespace {

using small_run::error_of;

TEST(Synth, EveryKindIsATraceAndComesBackFromItsFile) {
  const small_run::Folder folder;
  for (const std::string& kind : synthesizers()) {
    SCOPED_TRACE(kind);
    const Trace trace = synthesize(kind, {{"duration", 2}}, 1);
    EXPECT_EQ(trace.rows(), 2001u);
    write_trace(folder.file("a.csv"), trace);
    const Trace back = parse_trace("a.csv", small_run::content_of(folder.file("a.csv")), "haptic", {});
    EXPECT_EQ(back.values, trace.values);
    EXPECT_EQ(back.source, trace.source);
  }
}

TEST(Synth, SineIsASumOfSines) {
  const Trace trace =
      synthesize("sine", {{"amplitude_y", 0.02}, {"frequency_y", 3}, {"amplitude2_y", 0.01}, {"y", 0.5}}, 1);
  for (std::size_t i = 0; i < trace.rows(); i += 37) {
    const double t = static_cast<double>(i) / 1000;
    const double y = 0.5 + 0.02 * std::sin(2 * pinned::kPi * 3 * t) + 0.01 * std::sin(2 * pinned::kPi * 2 * t);
    EXPECT_NEAR(trace.at(i, 2), y, 1e-13);
  }
}

// Flash and Hogan: half way at half time, where the speed is 15/8 of the mean; at rest at both ends.
TEST(Synth, ReachHasMinimumJerk) {
  const Trace trace = synthesize("reach", {{"to_x", 0.2}, {"time", 2}, {"wait", 1}, {"duration", 8}}, 1);
  EXPECT_NEAR(trace.at(2000, 1), 0.1, 1e-15);
  EXPECT_NEAR((trace.at(2001, 1) - trace.at(1999, 1)) / 0.002, 15.0 / 8 * 0.1, 1e-6);
  EXPECT_EQ(trace.at(1000, 1), 0);
  EXPECT_EQ(trace.at(3000, 1), 0.2);
  EXPECT_LT(trace.at(1001, 1), 1e-8);
  EXPECT_NEAR(trace.at(6000, 1), 0, 1e-15);
}

// Sines of different frequencies: the mean square is the sum of theirs, up to the leakage of 60 s of them.
TEST(Synth, TremorHasTheStatedRootMeanSquare) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Trace trace = synthesize("tremor", {{"rms", 0.001}, {"duration", 60}}, seed);
    double squares = 0;
    for (std::size_t i = 0; i < trace.rows(); ++i) squares += trace.at(i, 1) * trace.at(i, 1);
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(trace.rows())), 0.001, 0.0001);
  }
}

TEST(Synth, TremorDependsOnTheSeedAlone) {
  EXPECT_EQ(synthesize("tremor", {}, 5).values, synthesize("tremor", {}, 5).values);
  EXPECT_NE(synthesize("tremor", {}, 5).values, synthesize("tremor", {}, 6).values);
}

TEST(Synth, InsertionGoesDownAndUpAgain) {
  const Trace trace = synthesize("insertion", {{"depth", 0.4}, {"speed", 0.2}, {"dwell", 0.5}, {"grasp_at", 0.25}}, 1);
  const auto height = [&](double t) { return trace.at(static_cast<std::size_t>(t * 1000 + 0.5), 3); };
  const auto button = static_cast<std::size_t>(trace.column("button"));
  EXPECT_EQ(height(0.4), 0.3);                 // rests
  EXPECT_NEAR(height(1.5), 0.3 - 0.2, 1e-12);  // 1 s under way
  EXPECT_NEAR(height(2.8), 0.3 - 0.4, 1e-12);  // rests below
  EXPECT_NEAR(height(3.5), 0.3 - 0.3, 1e-12);  // 0.5 s on its way back
  EXPECT_NEAR(height(5.2), 0.3, 1e-12);        // the second stroke begins with a rest
  EXPECT_EQ(trace.at(249, button), 0);
  EXPECT_EQ(trace.at(250, button), 1);
}

TEST(Synth, StepJumpsAtItsMoment) {
  const Trace trace = synthesize("step", {{"at", 0.5}, {"step_x", 0.01}}, 1);
  EXPECT_EQ(trace.at(499, 1), 0);
  EXPECT_EQ(trace.at(500, 1), 0.01);
}

TEST(Synth, RefusesWhatItDoesNotKnowWithTheNearestName) {
  const auto message = [](const std::string& kind, const std::map<std::string, double>& parameters) {
    const Error e = error_of([&] { static_cast<void>(synthesize(kind, parameters, 1)); });
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    return std::string(e.what());
  };
  EXPECT_NE(message("sin", {}).find("did you mean 'sine'"), std::string::npos);
  EXPECT_NE(message("sine", {{"amplitud_x", 1}}).find("did you mean 'amplitude_x'"), std::string::npos);
  EXPECT_NE(message("sine", {{"x", std::nan("")}}).find("finite"), std::string::npos);
  EXPECT_NE(message("sine", {{"rate", 0}}).find("samples"), std::string::npos);
  EXPECT_NE(message("sine", {{"duration", 1e9}}).find("samples"), std::string::npos);
  EXPECT_NE(message("insertion", {{"speed", 0}}).find("above 0"), std::string::npos);
  EXPECT_NE(message("insertion", {{"axis_z", 0}}).find("direction"), std::string::npos);
}

}  // namespace
}  // namespace verisim::synth_test
