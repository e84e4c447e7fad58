#include "engine/wii/assignment.hpp"
#include "engine/wii/tracker_base.hpp"
#include "engine/wii/trackers.hpp"
#include "engine/wii/two_led_covariance.hpp"

namespace verisim::wii {
namespace {

class Geometric final : public TrackerBase {
 public:
  explicit Geometric(const TrackerSettings& settings)
      : TrackerBase(settings),
        follower_(settings.leds, pinhole(), settings.thresholds),
        spacing_((settings.leds.p_H[0] - settings.leds.p_H[1]).norm()) {}

  [[nodiscard]] std::string_view name() const override { return "geometric"; }

 private:
  void estimate(double t, double /*dt*/, const Reading& reading, int remote, Estimate& result) override {
    reading_ = reading;
    match_ = follower_.match(t, reading, gravity(remote).C_LR());
    if (!match_.found()) return;
    const TwoPointPose& pose = match_.pose;
    result.pose = {pose.p_L, rotation_about_z(pose.cos_roll, pose.sin_roll)};
    result.covariance = two_led_covariance(settings(), pinhole(), spacing_, pose.p_L, pose.cos_roll, pose.sin_roll);
    result.usable = result.known = true;
  }
  // Only a pair that made a valid report is followed: a lamp that looked like a head once is not.
  void admitted(double t, bool valid) override {
    if (valid) follower_.follow(t, reading_, match_);
  }
  void restart() override { follower_.forget(); }

  PairFollower follower_;
  double spacing_;
  Reading reading_;
  PairFollower::Match match_;
};

}  // namespace

std::unique_ptr<Tracker> make_geometric(const TrackerSettings& settings) {
  return std::make_unique<Geometric>(settings);
}

}  // namespace verisim::wii
