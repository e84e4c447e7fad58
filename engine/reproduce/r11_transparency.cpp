// R11: how transparent the mobile base is (section 5.4: "subjectively light and transparent", forces "subjectively
// comparable to the experience of using the device on a fixed base"). A person walks and pushes with a Virtuose on the
// robot, and beside it the same person with a device that reaches everywhere; scenarios/robot_walk.lua compares.
#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/base/statistics.hpp"
#include "engine/record/output_place.hpp"
#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {
namespace {

constexpr double kReach = 0.225;  // m, half of the Virtuose's workspace

struct Setting {
  const char* what;
  std::vector<std::pair<std::string, std::string>> sets;
};
const std::vector<Setting>& settings() {
  static const std::vector<Setting> kSettings = {
      {"gain 10000, estimated base", {}},
      {"gain 10000, last report of the tracker", {{"predict", "false"}}},
      {"gain 5000, estimated base", {{"gain", "5000"}}},
      {"gain 25000, estimated base", {{"gain", "25000"}}},
      {"gain 10000, walk of 0.57 m/s", {{"walk", "0.57"}}},
  };
  return kSettings;
}

struct Walks {
  std::string run_file, csv_file;
  std::vector<double> added, stiffness, off;
};

Walks walk(const Workshop& workshop, std::size_t number, const Setting& setting, std::uint64_t seeds) {
  const std::string name = fmt::format("r11_walk_{}", number);
  Walks walks{workshop.file(name + ".h5"), workshop.file(name + ".csv"), {}, {}, {}};
  std::string csv = "seed,added_force_rms_N,stiffness_felt,handle_off_neutral_max_m,state_hash\n";
  RunRequest request{.scenario = "robot_walk", .file = walks.run_file, .sets = setting.sets};
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    request.seed = seed;
    const TimedRun run = workshop.run(request);
    walks.added.push_back(run.measure("added_force_rms"));
    walks.stiffness.push_back(run.measure("stiffness_felt"));
    walks.off.push_back(run.measure("handle_off_neutral_max"));
    csv += fmt::format("{},{},{},{},{}\n", seed, walks.added.back(), walks.stiffness.back(), walks.off.back(),
                       run.state_hash);
  }
  write_text(walks.csv_file, csv, workshop.force);
  return walks;
}

Row row_of(const std::string& what, const std::string& unit, const Figure& published, const std::vector<double>& values,
           const std::string& why, const Walks& walks) {
  const Estimate mean = mean_of(values);
  return {"R11", what, unit, published, mean.value, mean.interval, why, {walks.run_file, walks.csv_file}};
}

}  // namespace

std::vector<Row> r11_transparency(const Workshop& workshop) {
  std::vector<Row> rows;
  const std::size_t count = workshop.quick ? 1 : settings().size();
  for (std::size_t i = 0; i < count; ++i) {
    const Setting& setting = settings()[i];
    const Walks walks = walk(workshop, i, setting, workshop.quick ? 2 : 10);
    const std::string where = fmt::format(", {}", setting.what);
    rows.push_back(row_of("force added in free motion, rms" + where, "N", std::string("subjectively light"),
                          walks.added, "beside the same hand with a device that reaches everywhere", walks));
    rows.push_back(row_of("stiffness felt against a wall, to that without base" + where, "",
                          std::string("subjectively comparable"), walks.stiffness,
                          "mean forces while the hand pushes 20 mm into the fence", walks));
    const double most = *std::max_element(walks.off.begin(), walks.off.end());
    rows.push_back(
        {"R11",
         "handle furthest from its neutral place" + where,
         "m",
         std::string("free movement in the entire area"),
         most,
         {},
         fmt::format("the Virtuose's workspace ends at {} m: {}", kReach, most < kReach ? "within" : "beyond"),
         {walks.run_file, walks.csv_file}});
  }
  return rows;
}

}  // namespace verisim::reproduce
