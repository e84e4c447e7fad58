// The trackers that fit a whole pose to many sightings: three LEDs seen by one remote, or any seen by two.
#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/wii/acquisition.hpp"
#include "engine/wii/half_turn.hpp"
#include "engine/wii/lone_blob.hpp"
#include "engine/wii/tracker_base.hpp"
#include "engine/wii/trackers.hpp"
#include "engine/wii/two_led_covariance.hpp"

namespace verisim::wii {
namespace {

class MultiPoint final : public TrackerBase {
 public:
  MultiPoint(const TrackerSettings& settings, std::string_view name, int remotes)
      : TrackerBase(settings),
        name_(name),
        remotes_(remotes),
        X_R1R2_(settings.X_R1R2.value_or(Pose())),
        solver_(settings),
        followers_{PairFollower(settings.leds, pinhole(), settings.thresholds),
                   PairFollower(settings.leds, pinhole(), settings.thresholds)},
        half_turn_(settings.thresholds),
        clutter_{Clutter(settings.thresholds), Clutter(settings.thresholds)} {
    for (Assignment& blobs : assigned_) blobs.fill(-1);
  }

  [[nodiscard]] std::string_view name() const override { return name_; }

 private:
  struct View {
    Reading reading;
    double t = kNever;
  };

  void estimate(double t, double /*dt*/, const Reading& reading, int remote, Estimate& result) override {
    if (remote >= remotes_) return;
    views_[static_cast<std::size_t>(remote)] = {reading, t};
    if (!reports(t, remote) || !gravity(0).known()) return;
    upright_ = upright();
    found_ = {};
    reacquired_ = false;
    if (followed_ &&
        std::abs(t - t_followed_) <= settings().thresholds.lost_head_memory) {  // the other remote's clock may be ahead
      found_ = follow(t);
      if (unassigned_ >= settings().thresholds.unassigned_reports) reacquire(t);
    } else {
      found_ = acquire(t);
    }
    if (!found_.found || found_.cost > settings().thresholds.cost_per_led_max * settings().leds.count) return;
    level(found_, gravity(0).C_LR(), tilt_variance(), result.pose, result.covariance);
    if (!seen_fully_)
      add_second_order(result.covariance, result.pose.position, std::min(upright_.sigma_x, settings().yaw_sigma),
                       std::min(upright_.sigma_y, settings().pitch_sigma));
    if (settings().leds.count == 2) {
      const Eigen::Vector2d roll = roll_of(result.pose.rotation * Vector3d::UnitX());
      const double doubt = half_turn_.doubt(t, roll.x(), roll.y());
      result.covariance(5, 5) += HalfTurn::variance(doubt);
      if (doubt > 0.5) followed_ = false;  // looked for anew
    }
    result.known = true;
    result.usable = result.covariance.diagonal().head<3>().maxCoeff() <
                    settings().thresholds.sigma_max * settings().thresholds.sigma_max;
  }

  [[nodiscard]] bool reports(double t, int remote) const override {
    if (remotes_ == 1 || remote == 0) return remote == 0;
    return t - views_[0].t > settings().thresholds.both_silent;
  }

  /// When yaw and pitch were seen a moment ago and now are not, they are near what they were.
  void take_last_as_prior(double t, Upright& u) const {
    const Matrix3d R_LH = u.C_LR * X_RH_.rotation.toRotationMatrix();
    const double drift = settings().thresholds.turn_rate * std::abs(t - t_full_);
    u.row_x = R_LH(2, 0);
    u.row_y = R_LH(2, 1);
    u.sigma_x = std::min(settings().yaw_sigma, settings().thresholds.still_known + drift);
    u.sigma_y = std::min(settings().pitch_sigma, settings().thresholds.still_known + drift);
  }

  [[nodiscard]] SolvedPose acquire(double t) {
    unassigned_ = 0;
    reacquired_ = true;
    if (remotes_ == 2) return acquire_pairs(t);
    seen_fully_ = true;
    const Reading reading = clutter_[0].removed_from(views_[0].reading);
    const Acquired all = acquire_head(reading, settings(), pinhole(), solver_, upright_, size_[0]);
    if (all.solved.found) return all.solved;
    seen_fully_ = false;
    return acquire_head_from_two(reading, settings(), pinhole(), solver_, upright_, size_[0]).solved;
  }

  /// LEDs are missing and blobs unassigned: a blob that is followed may be clutter.
  void reacquire(double t) {
    const bool seen_fully = seen_fully_;
    const SolvedPose other = acquire(t);
    if (other.found)
      found_ = other;
    else
      seen_fully_ = seen_fully;
  }

  [[nodiscard]] SolvedPose follow(double t) {
    std::array<Sighting, kSightingsMax> sightings;
    int n = 0;
    int n_most = 0;
    bool unassigned = false;
    for (int remote = 0; remote < remotes_; ++remote) {
      const int here = follow_in(t, remote, std::span(sightings).subspan(static_cast<std::size_t>(n)));
      unassigned = unassigned ||
                   (here < settings().leds.count && views_[static_cast<std::size_t>(remote)].reading.blob_count > here);
      n_most = std::max(n_most, here);
      n += here;
    }
    unassigned_ = unassigned ? unassigned_ + 1 : 0;
    if (n_most < 2) return {};  // one blob in each of two images may be clutter
    seen_fully_ = n >= 3;
    if (!seen_fully_) take_last_as_prior(t, upright_);
    const std::span<const Sighting> used = std::span(sightings).first(static_cast<std::size_t>(n));
    return remotes_ == 2 && n == 3 ? with_a_lone_blob(t, used) : solver_.solve(used, upright_, predicted(t));
  }

  [[nodiscard]] SolvedPose with_a_lone_blob(double t, std::span<const Sighting> used) {
    const bool yaw_known = std::abs(t - t_full_) <= settings().thresholds.lone_blob_memory;
    const LoneBlobSolver solver(settings(), pinhole(), solver_, upright_);
    const LoneBlobSolver::Result result =
        solver.solve(used, predicted(t), yaw_known ? std::optional(X_RH_.rotation) : std::nullopt);
    if (!result.ambiguous) return result.head;
    seen_fully_ = false;  // without it
    take_last_as_prior(t, upright_);
    return solver_.solve(pair_of(used), upright_, predicted(t));
  }

  int follow_in(double t, int remote, std::span<Sighting> sightings) {
    const View& view = views_[static_cast<std::size_t>(remote)];
    if (std::abs(t - view.t) > settings().thresholds.other_remote_max) return 0;
    std::array<Eigen::Vector2d, kLedsMax> then;  // where the LEDs were when this image was taken
    std::array<Eigen::Vector2d, kLedsMax> now;
    const auto leds = static_cast<std::size_t>(settings().leds.count);
    for (std::size_t led = 0; led < leds; ++led) {
      const Vector3d& p_H = settings().leds.p_H[led];
      if (!solver_.project(predicted(view.t), p_H, remote, then[led])) return 0;
      if (!solver_.project(predicted(t), p_H, remote, now[led])) return 0;
    }
    const double gate = settings().thresholds.gate + settings().thresholds.gate_growth * std::abs(t - t_followed_);
    Assignment& blobs = assigned_[static_cast<std::size_t>(remote)];
    blobs = nearest_assignment(view.reading, std::span(then).first(leds), gate);
    int n = 0;
    for (std::size_t led = 0; led < leds; ++led) {
      if (blobs[led] < 0) continue;
      const Blob& b = view.reading.blobs[static_cast<std::size_t>(blobs[led])];
      const double off = (Eigen::Vector2d(b.u, b.v) - then[led]).squaredNorm();
      if (clutter_[static_cast<std::size_t>(remote)].distance_square(b) < off || is_no_led(b, remote, t, led)) {
        blobs[led] = -1;
        continue;
      }
      const Eigen::Vector2d moved = now[led] - then[led];
      sightings[static_cast<std::size_t>(n++)] = {settings().leds.p_H[led], b.u + moved.x(), b.v + moved.y(), remote};
    }
    return n;
  }

  /// Each remote finds the pair by itself; the first that does says where to start.
  [[nodiscard]] SolvedPose acquire_pairs(double t) {
    std::array<Sighting, kSightingsMax> sightings;
    int n = 0;
    Pose start;
    bool exchanged = false;  // the LEDs, in every image: the head is half a turn from upright (half_turn.hpp)
    for (int remote = 0; remote < remotes_; ++remote) {
      const auto i = static_cast<std::size_t>(remote);
      if (std::abs(t - views_[i].t) > settings().thresholds.other_remote_max || !gravity(remote).known()) continue;
      followers_[i].forget();
      const Reading reading = clutter_[i].removed_from(views_[i].reading);
      const PairFollower::Match match = followers_[i].match(t, reading, gravity(remote).C_LR());
      if (!match.found()) continue;
      if (n == 0) {
        start = in_first(match.pose, remote);
        const Eigen::Vector2d roll = roll_of(gravity(0).C_LR() * (start.rotation * Vector3d::UnitX()));
        exchanged = half_turn_.doubt(t, roll.x(), roll.y()) > 0.5;
        if (exchanged) start.rotation = start.rotation * Quaterniond(0, 0, 0, 1);
      }
      const Assignment blobs = {match.blob[exchanged ? 1 : 0], match.blob[exchanged ? 0 : 1], -1, -1};
      n += sightings_of(reading, settings().leds, blobs, remote,
                        std::span(sightings).subspan(static_cast<std::size_t>(n)));
    }
    if (n < 2) return {};
    seen_fully_ = n >= 3;
    return solver_.solve(std::span(sightings).first(static_cast<std::size_t>(n)), upright_, start);
  }

  [[nodiscard]] Pose in_first(const TwoPointPose& pose, int remote) const {
    const Quaterniond C_RL = Quaterniond(gravity(remote).C_LR()).conjugate();
    const Pose X_iH{C_RL * pose.p_L, (C_RL * rotation_about_z(pose.cos_roll, pose.sin_roll)).normalized()};
    return remote == 0 ? X_iH : X_R1R2_ * X_iH;
  }

  [[nodiscard]] Pose predicted(double t) const {
    return {X_RH_.position + (t - t_followed_) * velocity_R_, X_RH_.rotation};
  }

  [[nodiscard]] Pose in_remote(const Pose& X_R1H, int remote) const {
    return remote == 0 ? X_R1H : X_R1R2_.inverse() * X_R1H;
  }

  /// A light of another size than the LEDs': a lamp that came where an LED was expected.
  [[nodiscard]] bool is_no_led(const Blob& b, int remote, double t, std::size_t led) const {
    const double at_1m = size_[static_cast<std::size_t>(remote)].at_1m;
    if (!(at_1m > 0)) return false;
    const double distance = (in_remote(predicted(t), remote) * settings().leds.p_H[led]).norm();
    return std::abs(b.size - std::clamp(at_1m / distance, 1.0, 15.0)) > settings().thresholds.size_spread;
  }

  /// Where the whole head is seen, all else is clutter.
  void learn_clutter(bool valid) {
    const auto leds = static_cast<std::size_t>(settings().leds.count);
    for (std::size_t i = 0; i < static_cast<std::size_t>(remotes_); ++i) {
      const auto all = std::span(assigned_[i]).first(leds);
      if (valid && std::find(all.begin(), all.end(), -1) == all.end()) {
        clutter_[i].learn(views_[i].reading, all);
        learn_size(size_[i], views_[i].reading, settings(), assigned_[i], in_remote(found_.X_RH, static_cast<int>(i)));
      } else
        clutter_[i].follow(views_[i].reading);
      assigned_[i].fill(-1);
    }
  }

  void admitted(double t, bool valid) override {
    learn_clutter(valid && !reacquired_);
    if (!valid) return;
    const double dt = t - t_followed_;
    const bool continued = followed_ && dt <= settings().thresholds.lost_head_memory;
    if (!continued)
      velocity_R_.setZero();
    else if (dt > 1e-4 && seen_fully_ == was_seen_fully_ && !reacquired_)  // what was learned anew is no motion
      velocity_R_ += settings().thresholds.velocity_gain * ((found_.X_RH.position - X_RH_.position) / dt - velocity_R_);
    velocity_R_ *= std::min(1.0, kSpeedMax / std::max(velocity_R_.norm(), 1e-9));
    if (settings().leds.count == 2) {
      const Eigen::Vector2d roll = roll_of(gravity(0).C_LR() * (found_.X_RH.rotation * Vector3d::UnitX()));
      half_turn_.follow(t, roll.x(), roll.y());
    }
    X_RH_ = found_.X_RH;
    t_followed_ = t;
    followed_ = true;
    was_seen_fully_ = seen_fully_;
    if (seen_fully_)
      t_full_ = t;
    else if (!continued)
      t_full_ = kNever;  // the yaw that was seen once is another head's, for all that is known
  }

  void restart() override {
    followed_ = false;
    for (Clutter& clutter : clutter_) clutter.forget();
    size_.fill({});
    half_turn_.forget();
    t_full_ = kNever;
    for (View& view : views_) view.t = kNever;
  }

  std::string_view name_;
  int remotes_;
  Pose X_R1R2_;  ///< the second remote in coordinates of the first
  PoseSolver solver_;
  std::array<PairFollower, 2> followers_;
  HalfTurn half_turn_;
  std::array<Clutter, 2> clutter_;
  std::array<LedSize, 2> size_;
  std::array<Assignment, 2> assigned_{};  ///< of this report's blobs, where they were followed
  std::array<View, 2> views_;
  Upright upright_;
  SolvedPose found_;
  bool seen_fully_ = false;      ///< this report's sightings determine yaw
  bool was_seen_fully_ = false;  ///< likewise, of the report before
  bool reacquired_ = false;      ///< this report's head was searched anew
  bool followed_ = false;
  int unassigned_ = 0;  ///< reports in a row with missing LEDs and unassigned blobs
  double t_followed_ = 0;
  double t_full_ = kNever;  ///< when this head's yaw was seen last
  Pose X_RH_;               ///< followed pose
  Vector3d velocity_R_ = Vector3d::Zero();
};

}  // namespace

std::unique_ptr<Tracker> make_three_led(const TrackerSettings& settings) {
  VERISIM_ASSERT(settings.leds.count >= 3);
  return std::make_unique<MultiPoint>(settings, "three-led", 1);
}

std::unique_ptr<Tracker> make_stereo(const TrackerSettings& settings) {
  VERISIM_ASSERT(settings.X_R1R2.has_value());
  return std::make_unique<MultiPoint>(settings, "stereo", 2);
}

}  // namespace verisim::wii
