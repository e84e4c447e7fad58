#include "engine/robot/walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {

namespace {

constexpr double kWallStep = 0.001;       // s: one call
constexpr double kReturnRate = 5;         // 1/s
constexpr double kReturnMost = 0.1;       // m/s
constexpr double kRounding = 0.001;       // m/s: half a mm/s in x and y, on the diagonal, is 0.71
constexpr double kDirectionKnown = 0.7;   // rad
constexpr std::uint64_t kHistory = 4096;  // ms

using Vector2 = std::array<double, 2>;

double dot(const Vector2& a, const Vector2& b) {
  return a[0] * b[0] + a[1] * b[1];
}
double length(const Vector2& v) {
  return std::sqrt(dot(v, v));
}

const WallSettings& checked(const WallSettings& s) {
  const auto refuse = [](const char* what, double is, const char* range) {
    fail(ErrorKind::input, "walls: {} is {} but must be {}", what, is, range);
  };
  if (s.corners.size() < 3 || s.corners.size() > Walls::kMost)
    refuse("the number of corners", static_cast<double>(s.corners.size()), "from 3 to 8");
  for (const Vector2& corner : s.corners)
    for (const double x : corner)
      if (!std::isfinite(x)) refuse("a corner's coordinate", x, "finite");
  if (!is_not_negative(s.radius)) refuse("radius", s.radius, "finite, 0 m or above");
  if (!is_not_negative(s.margin)) refuse("margin", s.margin, "finite, 0 m or above");
  if (!(s.delay >= kWallStep && s.delay <= 1)) refuse("delay", s.delay, "from 0.001 to 1 s");
  if (!(s.lag >= 0 && s.lag <= 1)) refuse("lag", s.lag, "from 0 to 1 s");
  if (!is_positive(s.deceleration)) refuse("deceleration", s.deceleration, "above 0 m/s^2");
  if (!is_positive(s.speed_max)) refuse("speed_max", s.speed_max, "above 0 m/s");
  if (!is_not_negative(s.omega_max)) refuse("omega_max", s.omega_max, "finite, 0 rad/s or above");
  if (!is_not_negative(s.yaw_error)) refuse("yaw_error", s.yaw_error, "finite, 0 rad or above");
  if (!is_not_negative(s.stiffness)) refuse("stiffness", s.stiffness, "finite, 0 N/m or above");
  if (!is_not_negative(s.force_max)) refuse("force_max", s.force_max, "finite, 0 N or above");
  return s;
}

}  // namespace

std::vector<Vector2> rectangle(double x_min, double x_max, double y_min, double y_max) {
  return {{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}};
}

Walls::Walls(const WallSettings& settings)
    : settings_(checked(settings)),
      lambda_(1 / (settings.delay + kWallStep + settings.lag + settings.speed_max / (2 * settings.deceleration))),
      kappa_(lambda_ * (1 - lambda_ * settings.lag) * pinned::exp(-lambda_ * (settings.delay + kWallStep))) {
  const std::size_t count = settings_.corners.size();
  Vector2 middle{0, 0};
  for (const Vector2& corner : settings_.corners)
    for (std::size_t i = 0; i < 2; ++i) middle[i] += corner[i] / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Vector2 &a = settings_.corners[k], &b = settings_.corners[(k + 1) % count];
    const Vector2 along{b[0] - a[0], b[1] - a[1]};
    const double size = length(along);
    if (!(size > 0)) fail(ErrorKind::input, "walls: corner {} stands twice, at ({}, {}); leave one out", k, a[0], a[1]);
    Wall wall{.n = {along[1] / size, -along[0] / size}, .d = 0, .commands = {}, .history = {}};
    wall.d = dot(wall.n, a);
    wall.commands.resize(static_cast<std::size_t>(std::ceil(settings_.delay * 1000)) + 1);
    wall.history.resize(kHistory);
    walls_.push_back(wall);
  }
  for (const Wall& wall : walls_) {
    for (const Vector2& corner : settings_.corners)
      if (dot(wall.n, corner) > wall.d + 1e-9 * (1 + std::abs(wall.d)))
        fail(ErrorKind::input,
             "walls: the corners are not those of a convex room, counter-clockwise; ({}, {}) is outside", corner[0],
             corner[1]);
    if (!(wall.d - dot(wall.n, middle) > settings_.radius + settings_.margin))
      fail(ErrorKind::input,
           "walls: a base of radius {} m has no room between the walls about ({}, {}); widen the room",
           settings_.radius, middle[0], middle[1]);
  }
}

void Walls::forget() {
  for (Wall& wall : walls_) {
    wall.e = settings_.speed_max;
    std::fill(wall.commands.begin(), wall.commands.end(), settings_.speed_max);
    for (std::uint64_t ago = 0; ago < kHistory; ++ago)
      wall.history[(now_ + kHistory - ago) % kHistory] =
          wall.went - settings_.speed_max * kWallStep * static_cast<double>(ago);
  }
}

double Walls::stop(double v) const {
  return v * (settings_.delay + kWallStep + settings_.lag) + v * v / (2 * settings_.deceleration);
}

void Walls::measure(Wall& wall, const TrackedBase& tracked) const {
  const double age_ms = std::ceil(tracked.age * 1000 - 1e-6);  // whole, but for rounding
  wall.room = -std::numeric_limits<double>::infinity();
  wall.allowed = 0;
  if (!(age_ms + 1 < static_cast<double>(kHistory))) return;
  const std::uint64_t ago = static_cast<std::uint64_t>(age_ms) + 1;
  const double went = wall.went - wall.history[(now_ + kHistory - ago) % kHistory];
  wall.room =
      wall.d - wall.n[0] * tracked.pose.x - wall.n[1] * tracked.pose.y - settings_.radius - settings_.margin - went;
  if (wall.room <= 0 || stop(wall.e) > wall.room) return;
  // The speed v with stop(v) = r. It is above kappa r up to speed_max and a little further.
  const double T = settings_.delay + kWallStep + settings_.lag, a = settings_.deceleration;
  const double stopping = 2 * wall.room / (T + std::sqrt(T * T + 2 * wall.room / a));
  wall.allowed = std::min(kappa_ * wall.room, stopping);
}

/// The bound of the base's velocity, a millisecond on. Backward Euler: never below the exact solution.
void Walls::command(Wall& wall, double c) {
  wall.commands[now_ % wall.commands.size()] = c;
  const double most = std::max(0.0, *std::max_element(wall.commands.begin(), wall.commands.end()));
  const double share = settings_.lag > 0 ? kWallStep / settings_.lag : std::numeric_limits<double>::infinity();
  const double lagging = settings_.lag > 0 ? (wall.e + most * share) / (1 + share) : most;
  wall.e = std::max({most, lagging, wall.e - settings_.deceleration * kWallStep});
  if (wall.e < 1e-12) wall.e = 0;
  wall.went += wall.e * kWallStep;
}

/// Who pulls at the device can pull the base along, and its wheels slip: within the margin it drives away from the
/// wall.
void Walls::come_back(Vector2& v, const TrackedBase& tracked) const {
  if (!tracked.is_valid) return;
  for (const Wall& wall : walls_) {
    const double inside = wall.d - wall.n[0] * tracked.pose.x - wall.n[1] * tracked.pose.y - settings_.radius;
    if (inside >= settings_.margin) continue;
    const double away = std::min(kReturnRate * (settings_.margin - inside), kReturnMost) + dot(wall.n, v);
    for (std::size_t i = 0; i < 2; ++i) v[i] -= std::max(0.0, away) * wall.n[i];
  }
}

/// Toward each wall no more than allowed: what is too much is taken away along its normal, so that the base slides
/// along.
void Walls::slide(Vector2& v) const {
  const double speed = length(v);
  if (speed == 0) return;
  // Turned by delta, v must not go towards a wall that allows nothing: it goes away from it a little. v grows by that,
  // by less than the factor 1 + delta while delta is below 0.8. Above that nothing but standing helps.
  for (const Wall& wall : walls_) {
    const double excess = dot(wall.n, v) + delta_ * (1 + delta_) * speed + kRounding - wall.allowed;
    if (excess <= 0 || delta_ > kDirectionKnown) continue;
    for (std::size_t i = 0; i < 2; ++i) v[i] -= excess * wall.n[i];
  }
  // At a corner of less than 90 degrees what is taken away along one normal is added along another: scaled down.
  double scale = 1;
  for (const Wall& wall : walls_) {
    const double toward = dot(wall.n, v) + delta_ * length(v);
    if (toward + kRounding > wall.allowed) scale = std::min(scale, std::max(0.0, wall.allowed - kRounding) / toward);
  }
  for (double& x : v) x *= std::max(0.0, scale);
}

PlanarTwist Walls::limit(const PlanarTwist& wanted, const TrackedBase& tracked) {
  VERISIM_ASSERT(std::isfinite(wanted.vx));
  VERISIM_ASSERT(std::isfinite(wanted.vy));
  VERISIM_ASSERT(std::isfinite(wanted.omega));
  const double omega = std::clamp(wanted.omega, -settings_.omega_max, settings_.omega_max);
  heading_ = {pinned::cos(tracked.pose.theta), pinned::sin(tracked.pose.theta)};
  const auto [c, s] = heading_;
  Vector2 v{c * wanted.vx - s * wanted.vy, s * wanted.vx + c * wanted.vy};
  const double turn = settings_.yaw_error + settings_.omega_max * (tracked.age + settings_.delay + 2 * settings_.lag);
  delta_ = std::min(2.0, turn);  // no direction is further off
  for (Wall& wall : walls_) {
    measure(wall, tracked);
    wall.asked = dot(wall.n, v);
  }
  come_back(v, tracked);
  slide(v);
  const bool moves = v[0] != 0 || v[1] != 0;
  bool is_holding = false;
  for (Wall& wall : walls_) {
    command(wall, moves ? dot(wall.n, v) + delta_ * length(v) + kRounding : 0);
    wall.history[(now_ + 1) % kHistory] = wall.went;
    wall.given = std::max(0.0, dot(wall.n, v));
    is_holding = is_holding || wall.given < wall.asked * (1 - 1e-9);
  }
  ++now_;
  limiting_.see(is_holding, now_);
  return {c * v[0] + s * v[1], -s * v[0] + c * v[1], omega};
}

Vector2 Walls::limit_force(const Vector2& error_R) const {
  const auto [c, s] = heading_;
  const Vector2 error{c * error_R[0] - s * error_R[1], s * error_R[0] + c * error_R[1]};
  if (!std::isfinite(error[0]) || !std::isfinite(error[1])) return {0, 0};
  Vector2 force{0, 0};
  for (const Wall& wall : walls_) {
    const double toward = dot(wall.n, error);
    if (toward <= 0 || wall.given >= wall.asked) continue;
    const double held = 1 - wall.given / wall.asked;  // the fraction of what was wanted that the walls forbid
    for (std::size_t i = 0; i < 2; ++i) force[i] -= settings_.stiffness * held * toward * wall.n[i];
  }
  const double size = length(force);
  const double scale = size > settings_.force_max ? settings_.force_max / size : 1;
  return {scale * (c * force[0] + s * force[1]), scale * (-s * force[0] + c * force[1])};
}

double Walls::room_left() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls_) least = std::min(least, wall.room);
  return least;
}

}  // namespace verisim::robot
