#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/device/sources.hpp"

namespace verisim {
namespace {

/// A sample this near counts as reached [s]: frame * dt and a time read from a file may differ in the last bit, and a
/// button must not come a frame late for it.
constexpr double kSimultaneous = 1e-9;

/// m/s and rad/s: no hand moves faster. A trace that does has lost samples, or its tracker jumped.
constexpr double kFastest = 10, kFastestTurn = 60;

constexpr const char* kStuckDown = "has a button that is down in every sample: it never lets go";
constexpr const char* kStuckUp = "has a button that is up in every sample: it takes hold of nothing by itself";

class ReplayDevice final : public Device {
 public:
  ReplayDevice(std::string name, HapticSamples samples) : name_(std::move(name)), samples_(std::move(samples)) {
    reading_.raw = reading_.handle = samples_.pose.front();
    for (const Pose& pose : samples_.pose)
      travel_ = std::max(travel_, (pose.position - samples_.pose.front().position).norm());
    const auto& button = samples_.button;
    const bool is_stuck = button.size() > 1 && std::all_of(button.begin(), button.end(), [&](std::uint8_t down) {
                            return (down != 0) == (button.front() != 0);
                          });
    if (is_stuck) stuck_ = button.front() != 0 ? kStuckDown : kStuckUp;
  }

  [[nodiscard]] const std::string& name() const override { return name_; }

  [[nodiscard]] std::string described() const override { return name_ + " (a recorded trace)"; }

  void sample(const DeviceFrame& frame) override {
    const double t = frame.t;
    VERISIM_ASSERT(std::isfinite(t));
    VERISIM_ASSERT(t >= last_t_);
    VERISIM_ASSERT(is_positive(frame.dt));
    const Pose before_this = reading_.handle;
    last_t_ = t;
    const auto& times = samples_.t;
    while (next_ < times.size() && times[next_] <= t + kSimultaneous) ++next_;
    const std::size_t before = next_ == 0 ? 0 : next_ - 1;
    const double since = t - times[before];
    if (since < kSimultaneous || next_ == times.size()) {
      reading_.handle = samples_.pose[before];
    } else {
      const double s = since / (times[next_] - times[before]);
      const Pose& a = samples_.pose[before];
      const Pose& b = samples_.pose[next_];
      reading_.handle = {a.position + s * (b.position - a.position), slerp(a.rotation, b.rotation, s)};
    }
    reading_.raw = reading_.handle;
    reading_.velocity = frame.number == 0 ? Twist() : velocity_between(before_this, reading_.handle, frame.dt);
    reading_.button = samples_.button.empty() || samples_.button[before] != 0;
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, const DeviceFrame&) override { rendered_ = wrench; }
  void report(DeviceNotes& notes) override {
    if (stuck_ != nullptr) notes.add("button", std::exchange(stuck_, nullptr));
    const bool is_fast = reading_.velocity.linear.norm() > kFastest || reading_.velocity.angular.norm() > kFastestTurn;
    if (is_fast && !was_fast_) notes.add("speed", "follows a trace that is faster than 10 m/s or 60 rad/s: it jumps");
    was_fast_ = is_fast;
    const bool has_ended = last_t_ > samples_.t.back() + kSimultaneous;
    if (has_ended && !had_ended_) notes.add("trace", "has no more samples and holds the last");
    had_ended_ = has_ended;
  }
  [[nodiscard]] const Wrench& rendered() const override { return rendered_; }
  [[nodiscard]] double duration() const override { return samples_.t.back(); }
  [[nodiscard]] double travel() const override { return travel_; }
  [[nodiscard]] bool driven() const override { return true; }

 private:
  std::string name_;
  HapticSamples samples_;
  std::size_t next_ = 0;  ///< first sample later than the last t: time only goes forward
  double last_t_ = -std::numeric_limits<double>::infinity();
  double travel_ = 0;
  const char* stuck_ = nullptr;  ///< of a recorded button that never changes: what is to be said of it, once
  bool was_fast_ = false, had_ended_ = false;
  DeviceReading reading_;
  Wrench rendered_;
};

}  // namespace

std::shared_ptr<Device> make_replay(std::string name, HapticSamples samples) {
  if (samples.t.empty()) fail(ErrorKind::input, "device '{}': its trace has no samples", name);
  VERISIM_ASSERT(samples.pose.size() == samples.t.size());
  VERISIM_ASSERT(samples.button.empty() || samples.button.size() == samples.t.size());
  for (std::size_t i = 0; i < samples.t.size(); ++i) {
    const Pose& pose = samples.pose[i];
    if (!std::isfinite(samples.t[i]) || (i > 0 && samples.t[i] <= samples.t[i - 1]))
      fail(ErrorKind::input, "device '{}': the times of its trace do not grow at sample {}", name, i);
    if (!is_placement(pose))
      fail(ErrorKind::input, "device '{}': sample {} of its trace is not a finite pose with a unit quaternion", name,
           i);
  }
  return std::make_shared<ReplayDevice>(std::move(name), std::move(samples));
}

}  // namespace verisim
