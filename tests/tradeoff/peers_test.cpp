// The table of other engines for people: what stands in it, and what is no such list.
#include "engine/tradeoff/peers.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace verisim::tradeoff {
namespace {

using nlohmann::ordered_json;

ordered_json engine() {
  return ordered_json::parse(R"({
    "name": "Engine", "version": "1.2", "setting": {"poses": "64 boxes", "insertion": "stiff"},
    "searched": {"poses": [{"missed": 0.015, "imagined": 0, "depth_error_m": {"p95": 4.1e-7}},
                           {"missed": 0.5, "imagined": 0, "depth_error_m": {"p95": 3e-9}}], "insertion": [{}, {}, {}]},
    "poses": {"setting": "64 boxes", "poses": 1000, "query_us": {"median": 40.5, "low": 39.6, "high": 52.5},
              "query_us_p99": 85.8, "depth_error_m": {"p50": 2.09e-6, "p95": 6.72e-6}, "gap_told": 0.25,
              "gap_error_m": {"p95": 3e-6}, "missed": 0.015, "imagined": 0},
    "insertion": {"setting": "stiff", "passed": 1, "of": 2, "overlap_m": 12.5e-6, "overlap_of_clearance": 0.125,
                  "force_error_N": 0.05, "step_us": {"median": 30.9, "low": 30.3, "high": 37.7}}})");
}

ordered_json list(std::initializer_list<ordered_json> rows) {
  ordered_json all = ordered_json::array();
  for (const ordered_json& row : rows) all.push_back(row);
  return all;
}

void expect_all(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " in\n" << text;
}

TEST(Peers, AnEngineStandsInBothTablesInUnitsOfPeople) {
  const std::string text = text_of_peers(list({engine()}));
  expect_all(text, {"1000 poses", "2 settings tried", "40.5", "39.6", "52.5", "2.09", "6.72", "0.41", "25", "1.5",
                    "64 boxes", "Engine 1.2", "1 of 2", "12.5", "0.125", "0.05", "30.9", "stiff"});
}

TEST(Peers, WithoutAPassThereIsNoOverlapAndNoForce) {
  ordered_json none = engine();
  for (const char* figure : {"overlap_m", "overlap_of_clearance", "force_error_N"}) none["insertion"][figure] = nullptr;
  none["insertion"]["passed"] = 0;
  expect_all(text_of_peers(list({none})), {"0 of 2"});
}

TEST(Peers, AMethodWithoutAQueryOfItsOwnStandsInTheTableOfInsertionsAlone) {
  ordered_json pushes = engine();
  pushes["name"] = "Pusher";
  pushes["poses"] = nullptr;
  const std::string text = text_of_peers(list({engine(), pushes}));
  EXPECT_EQ(text.find("Pusher"), text.rfind("Pusher"));
}

TEST(Peers, AnEngineThatIsMissingIsALineThatNamesItsPackage) {
  const ordered_json missing = {{"name", "ODE"}, {"version", nullptr}, {"missing", "libode-dev"}};
  expect_all(text_of_peers(list({engine(), missing})), {"ODE: not there", "apt install libode-dev"});
}

TEST(Peers, WhatIsNoSuchListIsRefused) {
  ordered_json damaged = engine();
  damaged["poses"].erase("query_us");
  for (const ordered_json& peers : {list({ordered_json::object()}), list({damaged}), list({1, 2})})
    EXPECT_THROW((void)text_of_peers(peers), Error) << peers;
}

}  // namespace
}  // namespace verisim::tradeoff
