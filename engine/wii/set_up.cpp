#include "engine/wii/set_up.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/wii/gravity.hpp"
#include "engine/wii/trajectories.hpp"

namespace verisim::wii {
namespace {

/// X_RL of a remote that stands still.
Quaterniond levelled_in(const Pose& X_WR) {
  const Vector3d up_R = X_WR.rotation.conjugate() * Vector3d::UnitY();
  return Quaterniond(Matrix3d(levelling(up_R).transpose())).normalized();
}

}  // namespace

SetUp first_of(const SetUp& first, const SetUp& second) {
  SetUp s = first;
  const auto complete = [&](auto member) {
    if (!(s.*member)) s.*member = second.*member;
  };
  complete(&SetUp::leds);
  complete(&SetUp::fov);
  complete(&SetUp::X_WR);
  complete(&SetUp::pixel_noise);
  complete(&SetUp::accelerometer_noise);
  complete(&SetUp::accelerometer_bits);
  complete(&SetUp::rate);
  complete(&SetUp::latency);
  return s;
}

RemoteSettings remote_settings(const RemoteSettings& sensor, const Trajectory& path, const LedLayout& leds,
                               const SetUp& set_up) {
  RemoteSettings s = sensor;
  s.leds.clear();
  for (int i = 0; i < leds.count; ++i) s.leds.push_back(Led{leds.p_H[static_cast<std::size_t>(i)]});
  s.outages = path.outages;
  s.exchanges = path.exchanges;
  s.fov = set_up.fov.value_or(s.fov);
  s.pixel_noise = set_up.pixel_noise.value_or(s.pixel_noise);
  s.accelerometer_noise = set_up.accelerometer_noise.value_or(s.accelerometer_noise);
  s.accelerometer_bits = set_up.accelerometer_bits.value_or(s.accelerometer_bits);
  s.rate = set_up.rate.value_or(s.rate);
  return s;
}

Trajectory placed(const Trajectory& path, const SetUp& set_up) {
  if (!set_up.X_WR) return path;
  if (!is_placement(*set_up.X_WR))
    fail(ErrorKind::input, "{}: the pose of the remote is not finite with a unit quaternion; correct it", path.name);
  if (path.moves_remote)
    fail(ErrorKind::input, "trajectory '{}' moves the remote itself; leave out the remote's pose", path.name);
  Trajectory there = path;
  const Pose X_WR = *set_up.X_WR;
  const Pose X_WL{X_WR.position, (X_WR.rotation * levelled_in(X_WR)).normalized()};
  there.at = [=, at = path.at, of_levelled = path.of_levelled](double t) {
    Situation s = at(t);
    s.X_WR = X_WR;
    if (of_levelled) s.X_WH = X_WL * s.X_WH;  // what was recorded is X_LH
    return s;
  };
  return there;
}

}  // namespace verisim::wii
