// vrpn_Tracker_WiimoteHead as it is (VRPN revision 893c749), rewritten from the description of what it computes
// (reference/wii/UPSTREAM.md), so that its users can see what they have. Its slips are kept on purpose; ORACLES section
// 3, slip 5 lists them.
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/wii/gravity.hpp"
#include "engine/wii/trackers.hpp"
#include "engine/wii/two_led_covariance.hpp"

namespace verisim::wii {
namespace {

constexpr double kHeartbeat = 1.0 / 60;                 // s without data before the last pose is sent again
constexpr double kRadPerPixel = 43 * kDegree / kWidth;  // slip: angles do not grow linearly with pixels
constexpr double kThird = 0.33333;                      // slip: of three readings, whatever their age
const double kHalfWidthTangent = pinned::tan(43 * kDegree / 2);
const double kHalfHeightTangent = pinned::tan(32 * kDegree / 2);

enum class Flip { unknown, normal, half_turn };

/// The smallest rotation that takes `from` to +z.
Quaterniond smallest_rotation_to_z(const Vector3d& from) {
  const double length = from.norm();
  if (!(length > 0)) return Quaterniond::Identity();
  const Vector3d unit = from / length;
  const double twice_w_square = 1 + unit.z();
  if (twice_w_square < 1e-12) return {0, 0, 1, 0};  // opposite: upstream's quaternion library turns about y
  return Quaterniond{twice_w_square, unit.y(), -unit.x(), 0}.normalized();
}

class VrpnCompatible final : public Tracker {
 public:
  explicit VrpnCompatible(const TrackerSettings& settings)
      : settings_(settings),
        pinhole_(settings.fov),
        // Upstream stores the spacing in single precision, and its last digits show it.
        spacing_(static_cast<float>((settings.leds.p_H[0] - settings.leds.p_H[1]).norm())) {
    report_.pose = {{0, 0, 1}, Quaterniond::Identity()};
    report_.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
    gravity_.fill({0, 0, 1});
  }

  [[nodiscard]] std::string_view name() const override { return "vrpn-compatible"; }
  using Tracker::update;

  const Report& update(double t, std::span<const double> channels, int remote) override {
    report_.news = remote == 0 && channels.size() >= kChannelsMin && std::isfinite(t);
    if (!report_.news) return report_;
    read_points(channels);
    read_gravity({channels[1], channels[2], channels[3]});
    report_.t = t;
    const bool was_valid = report_.valid;
    make_pose();
    report_.reacquired = report_.valid && !was_valid;
    return report_;
  }

  /// Upstream sends the last pose again and lets it look new; here at least `news` tells.
  const Report& heartbeat(double t) override {
    report_.news = false;
    report_.reacquired = false;
    if (t - report_.t >= kHeartbeat) make_pose();
    return report_;
  }

 private:
  void read_points(std::span<const double> channels) {
    for (std::size_t slot = 0; slot < kSlots && 6 + 3 * slot < channels.size(); ++slot) {
      const Blob blob{channels[4 + 3 * slot], channels[5 + 3 * slot], channels[6 + 3 * slot]};
      if (!(blob.u > 0 && blob.v > 0 && blob.size > 0)) return;  // slip: without slot 0 the old count stays
      points_[slot] = blob;
      point_count_ = static_cast<int>(slot) + 1;
    }
  }

  void read_gravity(const Vector3d& reading) {
    if (reading == gravity_[0]) return;  // slip: a reading that repeats is not averaged again
    if (!gravity_fresh_) {
      gravity_[2] = gravity_[1];
      gravity_[1] = gravity_[0];
    }
    gravity_[0] = reading;
    gravity_fresh_ = true;
  }

  void make_pose() {
    const bool level = gravity_[0] == Vector3d(0, 1, 0);
    if (gravity_fresh_ && !level) {
      levelling_ = smallest_rotation_to_z((gravity_[0] + gravity_[1] + gravity_[2]) * kThird);
      gravity_fresh_ = false;
    }
    report_.valid = point_count_ == 2;
    if (!report_.valid) {
      flip_ = Flip::unknown;
      return;
    }
    const Report before = report_;
    compute(level);
    if (flip_ == Flip::unknown) {
      const bool inverted = (report_.pose.rotation * Vector3d::UnitY()).y() < 0;
      flip_ = inverted ? Flip::half_turn : Flip::normal;
      if (inverted) compute(level);
    }
    // Upstream would send it: coincident points are infinitely far away. No program can use that to compare anything.
    if (report_.pose.position.allFinite() && report_.pose.rotation.coeffs().allFinite()) return;
    report_ = before;
    report_.valid = false;
  }

  void compute(bool level) {
    const bool exchanged = flip_ == Flip::half_turn;
    const Blob& p0 = points_[exchanged ? 1 : 0];
    const Blob& p1 = points_[exchanged ? 0 : 1];
    const double dx = p0.u - p1.u;
    const double dy = p0.v - p1.v;
    const double half_angle = std::sqrt(dx * dx + dy * dy) * kRadPerPixel / 2;
    const double z = spacing_ / 2 / pinned::tan(half_angle);
    const double roll = pinned::atan2(dy, dx);
    const double x = z * ((p0.u + p1.u) / 2 - kWidth / 2) * kHalfWidthTangent / (kWidth / 2);
    const double y = z * ((p0.v + p1.v) / 2 - kHeight / 2) * kHalfHeightTangent / (kHeight / 2);
    report_.pose.position = {x, y, z};  // slip: never levelled
    report_.pose.rotation = {pinned::cos(roll / 2), 0, 0, pinned::sin(roll / 2)};
    if (!level) report_.pose.rotation = report_.pose.rotation * levelling_;  // slip: about the head's axes
    if (!report_.pose.position.allFinite()) return;                          // and the report before stays
    // Upstream claims no accuracy. This is what its sensor would allow, for comparison with its errors.
    report_.covariance =
        two_led_covariance(settings_, pinhole_, report_.pose.position, pinned::cos(roll), pinned::sin(roll));
    add_tilt(report_.covariance, report_.pose.position, Matrix3d::Identity(),
             settings_.gravity_sigma * settings_.gravity_sigma);
  }

  TrackerSettings settings_;
  Pinhole pinhole_;
  double spacing_;
  std::array<Blob, kSlots> points_{};
  int point_count_ = 0;
  std::array<Vector3d, 3> gravity_;  ///< newest first
  bool gravity_fresh_ = true;
  Quaterniond levelling_ = Quaterniond::Identity();
  Flip flip_ = Flip::unknown;
  Report report_;
};

}  // namespace

std::unique_ptr<Tracker> make_vrpn_compatible(const TrackerSettings& settings) {
  return std::make_unique<VrpnCompatible>(settings);
}

}  // namespace verisim::wii
