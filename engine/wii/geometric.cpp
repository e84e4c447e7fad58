#include "engine/wii/assignment.hpp"
#include "engine/wii/half_turn.hpp"
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
        half_turn_(settings.thresholds) {}

  [[nodiscard]] std::string_view name() const override { return "geometric"; }

 private:
  void estimate(double t, double /*dt*/, const Reading& reading, int remote, Estimate& result) override {
    reading_ = reading;
    match_ = follower_.match(t, reading, gravity(remote).C_LR());
    if (!match_.found()) return;
    double doubt = half_turn_.doubt(t, match_.pose.cos_roll, match_.pose.sin_roll);
    if (doubt > 0.5) {
      const PairFollower::Match other = follower_.exchanged(reading, match_, gravity(remote).C_LR());
      if (other.found()) {
        match_ = other;
        doubt = 1 - doubt;
      }
    }
    const TwoPointPose& pose = match_.pose;
    result.pose = {pose.p_L, rotation_about_z(pose.cos_roll, pose.sin_roll)};
    result.covariance = two_led_covariance(settings(), pinhole(), pose.p_L, pose.cos_roll, pose.sin_roll);
    result.covariance(5, 5) += HalfTurn::variance(doubt);
    add_tilt(result.covariance, pose.p_L, gravity(remote).C_LR(), tilt_variance());
    result.usable = result.known = true;
  }
  // Only a pair that made a valid report is followed: a lamp that looked like a head once is not.
  void admitted(double t, bool valid) override {
    if (!valid) return;
    follower_.follow(t, reading_, match_);
    half_turn_.follow(t, match_.pose.cos_roll, match_.pose.sin_roll);
  }
  void restart() override {
    follower_.forget();
    half_turn_.forget();
  }

  PairFollower follower_;
  HalfTurn half_turn_;
  Reading reading_;
  PairFollower::Match match_;
};

}  // namespace

std::unique_ptr<Tracker> make_geometric(const TrackerSettings& settings) {
  return std::make_unique<Geometric>(settings);
}

}  // namespace verisim::wii
