// A scenario whose files a test writes into a folder of its own, run against the real inputs and the real simulation.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/script/scenario.hpp"
#include "tests/support/folder.hpp"

namespace verisim {

class WrittenScenario {
 public:
  explicit WrittenScenario(const std::string& script) {
    options.path = folder_.file("pin.lua");
    write("pin.lua", script);
  }
  WrittenScenario(const WrittenScenario&) = delete;
  WrittenScenario& operator=(const WrittenScenario&) = delete;

  void write(const std::string& name, const std::string& content) {
    std::filesystem::create_directories((folder() / name).parent_path());
    std::ofstream(folder() / name, std::ios::binary) << content;
  }

  /// Runs the script, until the scene stands.
  Scene& build() {
    inputs = std::make_unique<Inputs>(Inputs::live(folder().string(), allowed));
    scenario = std::make_unique<Scenario>(options, *inputs);
    scene = scenario->take_scene();
    return scene;
  }
  /// The text with which building is refused; empty if it is not.
  std::string refusal() {
    try {
      build();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return {};
  }
  /// Simulates `frames` more frames.
  Simulation& run(int frames) {
    if (!simulation) {
      build();
      simulation = std::make_unique<Simulation>(scene, SimulationOptions{});
      scenario->attach(*simulation);
    }
    for (int i = 0; i < frames; ++i) simulation->step();
    return *simulation;
  }
  /// The texts of all events of a kind.
  [[nodiscard]] std::vector<std::string> events(const std::string& kind) const {
    std::vector<std::string> texts;
    for (const Event& event : simulation->events())
      if (event.kind == kind) texts.push_back(event.text);
    return texts;
  }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  test::Folder folder_;  // removed after what reads in it

 public:
  ScenarioOptions options;
  std::vector<std::string> allowed;
  std::unique_ptr<Inputs> inputs;
  std::unique_ptr<Scenario> scenario;
  Scene scene;
  std::unique_ptr<Simulation> simulation;
};

/// The refusal of a script that stands alone.
inline std::string refusal_of(const std::string& script) {
  return WrittenScenario(script).refusal();
}

}  // namespace verisim
