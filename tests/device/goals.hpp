// A hand with goals and the chain around it, driven as the simulation drives them: what the operator sees is the
// outermost device's reading of the frame before.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "engine/device/sources.hpp"

namespace verisim::test {

struct Seeking {
  using World = std::function<Wrench(const DeviceReading&)>;  ///< what the world does to a virtual handle

  std::shared_ptr<Device> hand, chain;
  World world = [](const DeviceReading&) { return Wrench{}; };
  double dt = 1e-3;
  std::uint64_t frame = 0;
  std::vector<Pose> own, seen;  ///< of every frame: the hand, the virtual handle
  std::vector<Wrench> felt;     ///< by the hand, in every frame
  std::vector<std::pair<double, std::string>> said;

  template <typename Wrap>
  Seeking(HandDescription description, Wrap wrap) : hand(make_hand(std::move(description))), chain(wrap(hand)) {
    chain->practise({.name = chain->name(), .gain = chain->gain(), .workspace = chain->workspace()});
  }
  explicit Seeking(HandDescription description)
      : Seeking(std::move(description), [](std::shared_ptr<Device> device) { return device; }) {}

  void step() {
    DeviceFrame now{frame, static_cast<double>(frame) * dt, dt, 0, false, {}};
    now.sight.handle = chain->reading().handle;
    chain->sample(now);
    own.push_back(hand->reading().handle);
    seen.push_back(chain->reading().handle);
    chain->render(world(chain->reading()), now);
    felt.push_back(hand->rendered());
    DeviceNotes notes;
    chain->report(notes);
    for (const DeviceNotes::Note& note : notes) said.emplace_back(now.t, std::string(note.kind) + ": " + note.text);
    ++frame;
  }
  void seconds(double s) {
    for (const std::uint64_t end = frame + static_cast<std::uint64_t>(s / dt); frame < end;) step();
  }
  /// Time of the n-th note with that text, or -1.
  [[nodiscard]] double time_of(const std::string& text, int n = 1) const {
    for (const auto& [t, what] : said)
      if (what.find(text) != std::string::npos && --n == 0) return t;
    return -1;
  }
};

[[nodiscard]] inline HandGoal reach_to(const Vector3d& place) {
  HandGoal goal;
  goal.to.position = place;
  return goal;
}

}  // namespace verisim::test
