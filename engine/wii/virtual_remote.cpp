#include "engine/wii/virtual_remote.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/wii/gravity.hpp"

namespace verisim::wii {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s^2 per g
constexpr double kSizeAtOneMetre = 4;         // reference/wii/README.md: floor(4 / distance + 0.5), 1 to 15
constexpr double kBasePixel = 8;              // the sensor proper has 128 x 96 pixels
constexpr double kBatteryChannel = 0.75;
constexpr std::size_t kPointsMax = 32;         // bits of SensedReport::led_in_view
constexpr std::uint64_t kSourcesPerTurn = 16;  // of the pixel noise's counter

RandomStream stream(std::uint64_t seed, std::string_view remote, const char* what) {
  return {seed, std::string(remote) + "/" + what};
}

void require(bool good, const char* what) {
  if (!good) fail(ErrorKind::input, "virtual remote: {}; correct the sensor settings", what);
}

void check(const RemoteSettings& s) {
  require(is_field_of_view(s.fov), "the field of view must lie between 0 and 180 degrees");
  require(!s.leds.empty() && s.leds.size() <= kPointsMax, "1 to 32 LEDs can be simulated");
  require(s.leds.size() <= kSlots || s.slot_rule == SlotRule::first_free,
          "more LEDs than slots have no slots of their own; let them take the first that is free");
  require(s.subpixels == 1 || s.subpixels == 2 || s.subpixels == 4 || s.subpixels == 8, "subpixels is 1, 2, 4 or 8");
  require(s.pixel_noise >= 0 && s.accelerometer_noise >= 0, "noise cannot be negative");
  require(s.battery >= 0 && s.intensity_min >= 0, "battery and intensity_min cannot be negative");
  require(s.half_power_angle >= 0 && s.half_power_angle < pinned::kPi / 2, "half_power_angle lies below 90 degrees");
  require(s.accelerometer_bits == 0 || s.accelerometer_bits == 8 || s.accelerometer_bits == 10,
          "accelerometer_bits is 0, 8 or 10");
  require(s.accelerometer_limit > 0, "accelerometer_limit must be above 0 g");
  require(s.rate > 0 && s.jitter >= 0 && s.jitter < 0.5, "rate must be above 0 and jitter within 0 and 0.5 periods");
  require(s.loss >= 0 && s.loss < 1, "loss must lie within 0 and 1");
  for (const SlotExchange& e : s.exchanges)
    require(e.a >= 0 && e.a < kSlots && e.b >= 0 && e.b < kSlots, "slots of an exchange are 0 to 3");
}

double nearest_whole(double x) {
  return std::floor(x + 0.5);
}

}  // namespace

Pose levelled_pose(const Situation& situation) {
  VERISIM_ASSERT(is_unit(situation.X_WR.rotation));
  const Matrix3d R_WR = situation.X_WR.rotation.toRotationMatrix();
  const Vector3d up_R = R_WR.transpose() * Vector3d::UnitY();
  const Pose X_LR{Vector3d::Zero(), Quaterniond(levelling(up_R)).normalized()};
  return X_LR * (situation.X_WR.inverse() * situation.X_WH);
}

VirtualRemote::VirtualRemote(RemoteSettings settings, std::uint64_t seed, std::string_view name)
    : settings_((check(settings), std::move(settings))),
      pinhole_(settings_.fov),
      pixel_(stream(seed, name, "pixel")),
      acceleration_(stream(seed, name, "accelerometer")),
      jitter_(stream(seed, name, "jitter")),
      loss_(stream(seed, name, "loss")) {
  spots_.reserve(settings_.leds.size() + settings_.lamps.size());
}

double VirtualRemote::report_time(std::uint64_t k) const {
  const double shift = settings_.jitter == 0 ? 0 : settings_.jitter * (2 * jitter_.uniform(k) - 1);
  // The first report cannot come before the beginning.
  return std::max(0.0, (static_cast<double>(k) + shift) / settings_.rate);
}

bool VirtualRemote::lost(std::uint64_t k) const {
  return settings_.loss > 0 && loss_.uniform(k) < settings_.loss;
}

bool VirtualRemote::hidden(const Situation& situation, const Vector3d& p_W) const {
  const Vector3d eye = situation.X_WR.position;
  const Vector3d way = p_W - eye;
  for (const Ball& ball : settings_.balls) {
    const Vector3d centre = ball.on_head ? situation.X_WH * ball.centre : ball.centre;
    const double along = std::clamp((centre - eye).dot(way) / way.squaredNorm(), 0.0, 1.0);
    if ((eye + along * way - centre).squaredNorm() < ball.radius * ball.radius) return true;
  }
  return false;
}

double VirtualRemote::led_intensity(std::size_t index, double t, const Situation& situation) const {
  for (const Outage& outage : settings_.outages)
    if ((outage.led < 0 || outage.led == static_cast<int>(index)) && t >= outage.begin && t < outage.end) return 0;
  const Led& led = settings_.leds[index];
  const Vector3d way_W = situation.X_WR.position - situation.X_WH * led.p_H;
  double lobe = 1;
  if (settings_.half_power_angle > 0) {
    const double cosine = (situation.X_WH.rotation * led.axis_H).dot(way_W.normalized());
    // A Lambertian lobe cos^m whose half power lies at the given angle.
    const double m = pinned::log(0.5) / pinned::log(pinned::cos(settings_.half_power_angle));
    lobe = cosine > 0 ? pinned::pow(cosine, m) : 0;
  }
  return led.power * settings_.battery * lobe / way_W.squaredNorm();
}

bool VirtualRemote::image(std::uint64_t k, int source, const Vector3d& p_R, double intensity, Blob& blob) const {
  if (!(p_R.z() > 0) || !(intensity > 0) || intensity < settings_.intensity_min) return false;
  const double a = p_R.x() / p_R.z();
  const double b = p_R.y() / p_R.z();
  const double r2 = a * a + b * b;
  const double radial = 1 + settings_.distortion_k1 * r2 + settings_.distortion_k2 * r2 * r2;
  const auto number = static_cast<std::uint64_t>(source);
  const std::uint64_t counter =
      (number / kSourcesPerTurn << 40U) + 2 * (kSourcesPerTurn * k + number % kSourcesPerTurn);
  const auto sense_axis = [&](double ideal, std::uint64_t c) {
    double x = ideal;
    if (settings_.subpixel_error > 0) x += settings_.subpixel_error * pinned::sin(2 * pinned::kPi * ideal / kBasePixel);
    if (settings_.pixel_noise > 0) x += settings_.pixel_noise * pixel_.normal(c);
    const double step = kBasePixel / settings_.subpixels;
    return settings_.whole_pixels ? step * nearest_whole(x / step) : x;
  };
  blob.u = sense_axis(kWidth / 2 + pinhole_.fx * a * radial, counter);
  blob.v = sense_axis(kHeight / 2 + pinhole_.fy * b * radial, counter + 1);
  blob.size = std::clamp(nearest_whole(kSizeAtOneMetre * std::sqrt(intensity)), 1.0, 15.0);
  return blob.u >= 0 && blob.u <= kWidth - 1 && blob.v >= 0 && blob.v <= kHeight - 1;
}

void VirtualRemote::find_spots(std::uint64_t k, double t, const Situation& situation) {
  spots_.clear();
  const Pose X_RW = situation.X_WR.inverse();
  const auto look = [&](int source, const Vector3d& p_W, double intensity) {
    Spot spot{source, {}};
    if (image(k, source, X_RW * p_W, intensity, spot.blob) && !hidden(situation, p_W)) spots_.push_back(spot);
  };
  for (std::size_t i = 0; i < settings_.leds.size(); ++i)
    look(static_cast<int>(i), situation.X_WH * settings_.leds[i].p_H, led_intensity(i, t, situation));
  for (std::size_t i = 0; i < settings_.lamps.size(); ++i) {
    const Lamp& lamp = settings_.lamps[i];
    if (t < lamp.begin || t >= lamp.end) continue;
    const double distance_square = (situation.X_WR.position - lamp.p_W).squaredNorm();
    look(first_lamp() + static_cast<int>(i), lamp.p_W, lamp.power / distance_square);
  }
}

void VirtualRemote::assign_slots() {
  const auto seen = [&](int source) {
    return std::any_of(spots_.begin(), spots_.end(), [&](const Spot& s) { return s.source == source; });
  };
  for (int& holder : holder_)
    if (holder != kNobody && !seen(holder)) holder = kNobody;
  for (const Spot& spot : spots_) {
    if (std::find(holder_.begin(), holder_.end(), spot.source) != holder_.end()) continue;
    if (settings_.slot_rule == SlotRule::own && spot.source < first_lamp()) {
      holder_[static_cast<std::size_t>(spot.source)] = spot.source;
      continue;
    }
    // Lamps leave the LEDs' own slots alone under SlotRule::own.
    const auto first = settings_.slot_rule == SlotRule::own
                           ? holder_.begin() + static_cast<std::ptrdiff_t>(settings_.leds.size())
                           : holder_.begin();
    const auto free = std::find(first, holder_.end(), kNobody);
    if (free != holder_.end()) *free = spot.source;  // a fifth light is not reported
  }
}

void VirtualRemote::write_slots(double t, Channels& channels) const {
  std::array<std::size_t, kSlots> place = {0, 1, 2, 3};
  for (const SlotExchange& e : settings_.exchanges)
    if (t >= e.t) std::swap(place[static_cast<std::size_t>(e.a)], place[static_cast<std::size_t>(e.b)]);
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    const auto spot =
        std::find_if(spots_.begin(), spots_.end(), [&](const Spot& s) { return s.source == holder_[slot]; });
    const Blob blob = spot == spots_.end() ? Blob{-1, -1, -1} : spot->blob;
    const std::size_t at = 4 + 3 * place[slot];
    channels[at] = blob.u;
    channels[at + 1] = blob.v;
    channels[at + 2] = blob.size;
  }
}

Vector3d VirtualRemote::accelerometer(std::uint64_t k, const Situation& situation) const {
  const Vector3d force_W = Vector3d::UnitY() + situation.acceleration_W / kStandardGravity;
  Vector3d a = accelerometer_from_remote(situation.X_WR.rotation.conjugate() * force_W) + settings_.accelerometer_bias;
  const double counts_per_g = settings_.accelerometer_bits == 8 ? 26 : 104;
  for (int axis = 0; axis < 3; ++axis) {
    if (settings_.accelerometer_noise > 0)
      a[axis] += settings_.accelerometer_noise * acceleration_.normal(4 * k + static_cast<std::uint64_t>(axis));
    if (settings_.accelerometer_bits > 0) a[axis] = nearest_whole(a[axis] * counts_per_g) / counts_per_g;
    a[axis] = std::clamp(a[axis], -settings_.accelerometer_limit, settings_.accelerometer_limit);
  }
  return a;
}

SensedReport VirtualRemote::sense(std::uint64_t k, const Situation& situation) {
  VERISIM_ASSERT(is_placement(situation.X_WR));
  VERISIM_ASSERT(is_placement(situation.X_WH));
  SensedReport report;
  report.t = report_time(k);
  report.X_LH = levelled_pose(situation);
  const Vector3d a = accelerometer(k, situation);
  report.channels = {kBatteryChannel, a.x(), a.y(), a.z()};
  find_spots(k, report.t, situation);
  assign_slots();
  write_slots(report.t, report.channels);
  for (const int holder : holder_)
    if (holder != kNobody && holder < first_lamp()) report.led_in_view |= 1U << holder;
  return report;
}

}  // namespace verisim::wii
