// scaat: every pixel coordinate, every blob size and the prior that heads are upright correct the filter one by one, so
// that one LED alone still helps and none at all only lets the covariance grow. The accelerometer levels the state and
// says what "upright" is.
#include <algorithm>
#include <cmath>

#include "engine/wii/acquisition.hpp"
#include "engine/wii/half_turn.hpp"
#include "engine/wii/head_filter.hpp"
#include "engine/wii/tracker_base.hpp"
#include "engine/wii/trackers.hpp"
#include "engine/wii/two_led_covariance.hpp"

namespace verisim::wii {
namespace {

/// 1 / sqrt(12), the standard deviation of rounding: a head at rest does not average its rounding errors away.
constexpr double kRoundingPixels = 0.29;
constexpr double kSensorPixels = 0.1;  // by which places within a pixel are off, whatever the noise

class Scaat final : public TrackerBase {
 public:
  explicit Scaat(const TrackerSettings& settings)
      : TrackerBase(settings),
        solver_(settings),
        follower_(settings.leds, pinhole(), settings.thresholds),
        clutter_(settings.thresholds),
        half_turn_(settings.thresholds),
        filter_(settings.thresholds),
        pixel_variance_(settings.pixel_sigma * settings.pixel_sigma) {}

  [[nodiscard]] std::string_view name() const override { return "scaat"; }

 private:
  void estimate(double t, double dt, const Reading& reading, int remote, Estimate& result) override {
    if (remote != 0) return;
    reading_ = reading;
    pair_ = {};
    assigned_.fill(-1);
    const Matrix3d& C_LR = gravity(0).C_LR();
    if (running_ && t - t_seen_ > settings().thresholds.forget_after) running_ = false;
    int seen = 0;
    if (running_) {
      filter_.predict(dt, view_);
      // After a loss the nearest blob may be another LED, or clutter: blobs are assigned anew, without the prediction.
      const bool predictable = t - t_seen_ <= settings().thresholds.coast_max;
      if (predictable) seen = correct_with(reading, C_LR, dt);
      view_ = view_of(seen);
      unassigned_ = seen < 2 && reading.blob_count >= 2 ? unassigned_ + 1 : 0;
      lost_ = !predictable || found_from_two_ || unassigned_ >= settings().thresholds.unassigned_reports_filter;
      if (settings().leds.count == 2 && seen == 2) reconsider(C_LR);
    }
    if (!running_ || lost_) seen = std::max(seen, acquire(t, reading, C_LR));
    if (!running_) return;
    if (seen > 0) t_seen_ = t;
    if (settings().leds.count == 2) settle_which_way(t, C_LR);
    report(t, seen, C_LR, result);
  }

  [[nodiscard]] HeadFilter::View view_of(int seen) const {
    if (seen == 0) return HeadFilter::View::none;
    if (seen == 1) return HeadFilter::View::one;
    return seen < settings().leds.count ? HeadFilter::View::pair : HeadFilter::View::all;
  }

  // ---- one measurement at a time

  /// Returns how many LEDs were used.
  int correct_with(const Reading& reading, const Matrix3d& C_LR, double dt) {
    const auto leds = static_cast<std::size_t>(settings().leds.count);
    std::array<Eigen::Vector2d, kLedsMax> expected;
    for (std::size_t led = 0; led < leds; ++led)
      if (!solver_.project(filter_.X_RH(), settings().leds.p_H[led], 0, expected[led])) return 0;
    const double spread = pinhole().fx * std::sqrt(filter_.position_variance()) / filter_.X_RH().position.z();
    const double gate = std::min(settings().thresholds.pixel_gate_max,
                                 settings().thresholds.pixel_gate + settings().thresholds.spread_gate * spread);
    const Assignment blobs =
        without_clutter(reading, expected, nearest_assignment(reading, std::span(expected).first(leds), gate));
    const auto assigned = std::count_if(blobs.begin(), blobs.end(), [](int b) { return b >= 0; });
    const bool alone_in_view = assigned == 1;
    int seen = 0;
    int last = -1;
    for (std::size_t led = 0; led < leds; ++led) {
      if (blobs[led] < 0) continue;
      const Blob& blob = reading.blobs[static_cast<std::size_t>(blobs[led])];
      if (!correct_pixel(settings().leds.p_H[led], blob, alone_in_view)) continue;
      ++seen;
      last = blobs[led];
      learn_repetition(blob, last_blob_[led]);
      assigned_[led] = blobs[led];
      if (led < 2) pair_.blob[led] = blobs[led];
    }
    if (seen == 1) correct_size(reading.blobs[static_cast<std::size_t>(last)]);
    if (seen == settings().leds.count) learn_size(size_, reading, settings(), assigned_, filter_.X_RH());
    correct_upright(C_LR, dt);
    return seen;
  }

  /// Clutter that stands where it stood is no LED, however wide the gate has become.
  [[nodiscard]] Assignment without_clutter(const Reading& reading,
                                           const std::array<Eigen::Vector2d, kLedsMax>& expected,
                                           Assignment blobs) const {
    const auto leds = static_cast<std::size_t>(settings().leds.count);
    for (std::size_t led = 0; led < leds; ++led) {
      if (blobs[led] < 0) continue;
      const Blob& blob = reading.blobs[static_cast<std::size_t>(blobs[led])];
      const double off = (Eigen::Vector2d(blob.u, blob.v) - expected[led]).squaredNorm();
      if (clutter_.distance_square(blob) < off) blobs[led] = -1;
    }
    return blobs;
  }

  bool correct_pixel(const Vector3d& p_H, const Blob& blob, bool alone) {
    const auto axis = [&](bool horizontal) {
      const Vector3d arm = filter_.R_RH() * p_H;
      const Vector3d p = filter_.X_RH().position + arm;
      if (!(p.z() > 0)) return false;
      const double f = horizontal ? pinhole().fx : pinhole().fy;
      const double slope = (horizontal ? p.x() : p.y()) / p.z();
      const Vector3d g = f / p.z() * (horizontal ? Vector3d(1, 0, -slope) : Vector3d(0, 1, -slope));
      const double measured = horizontal ? blob.u - kWidth / 2 : blob.v - kHeight / 2;
      const double off = measured - f * slope;
      return alone ? filter_.correct_across(g, arm.cross(g), off, pixel_variance_, settings().thresholds.gate_sigmas)
                   : filter_.correct(g, arm.cross(g), off, pixel_variance_, settings().thresholds.gate_sigmas);
    };
    const bool u = axis(true);
    const bool v = axis(false);
    return u && v;
  }

  void learn_repetition(const Blob& blob, Blob& before) {
    const double repeated = 0.5 * ((blob.u == before.u ? 1 : 0) + (blob.v == before.v ? 1 : 0));
    repetition_ += settings().thresholds.repetition_learning * (repeated - repetition_);
    before = blob;
  }
  /// Of the rounding error, what stands still with the head, rms pixel. Noise of 0.1, 0.2 and 0.3 pixel leaves 0.19,
  /// 0.10 and 0.04 of it, and repeats 0.89, 0.77 and 0.66 of the coordinates: nearly the fourth power.
  [[nodiscard]] double standing_pixels() const {
    const double square = repetition_ * repetition_;
    return kRoundingPixels * square * square + kSensorPixels;
  }

  /// A blob's size falls with distance: coarse, but all that one LED says of depth.
  void correct_size(const Blob& blob) {
    if (!(size_.at_1m > 0)) return;
    const Vector3d& p = filter_.X_RH().position;
    const double distance = p.norm();
    const double size = size_.at_1m / distance;
    const Thresholds& n = settings().thresholds;
    filter_.correct(-size / (distance * distance) * p, Vector3d::Zero(), blob.size - size,
                    n.size_sigma * n.size_sigma * n.size_repeats, n.gate_sigmas);
  }

  /// Entries (2,0) and (2,1) of R_LH are -yaw and pitch. Two LEDs see neither: both are held at zero and accounted for
  /// in the report. Three see both: the prior only pulls gently where they are not seen.
  void correct_upright(const Matrix3d& C_LR, double dt) {
    const bool two = settings().leds.count == 2;
    const double repeats = settings().thresholds.upright_time / std::max(dt, 1e-6);
    const double pinned = settings().thresholds.pinned;
    const double width = settings().thresholds.prior_width;
    const auto variance = [&](double sigma) { return two ? pinned * pinned : width * width * sigma * sigma * repeats; };
    for (const int j : {0, 1}) {
      const Vector3d column_L = C_LR * filter_.R_RH().col(j);
      const Vector3d g = C_LR.transpose() * column_L.cross(Vector3d::UnitZ());
      const double sigma = j == 0 ? settings().yaw_sigma : settings().pitch_sigma;
      filter_.correct(Vector3d::Zero(), g, -column_L.z(), variance(sigma), std::numeric_limits<double>::infinity());
    }
  }

  // ---- finding the head

  /// A pair of which one blob is clutter moves as smoothly as a head. Only its cost tells, so it is compared with the
  /// other pairs in every report.
  void reconsider(const Matrix3d& C_LR) {
    const PairFollower::Match better = follower_.reconsidered(reading_, pair_, C_LR);
    if (better.blob == pair_.blob) return;
    pair_ = better;
    start_from(better.pose, C_LR);
  }

  void settle_which_way(double t, const Matrix3d& C_LR) {
    const Eigen::Vector2d roll = roll_of(C_LR * filter_.R_RH().col(0));
    doubt_ = half_turn_.doubt(t, roll.x(), roll.y());
    if (doubt_ <= 0.5 || pair_.blob[0] < 0 || pair_.blob[1] < 0) return;
    const PairFollower::Match other = follower_.exchanged(reading_, pair_, C_LR);
    if (!other.found()) return;
    pair_ = other;
    start_from(other.pose, C_LR);
    assigned_ = {other.blob[0], other.blob[1], -1, -1};
    doubt_ = 1 - doubt_;
  }

  void start_from(const TwoPointPose& pose, const Matrix3d& C_LR) {
    const Quaterniond C_RL = Quaterniond(C_LR).conjugate();
    TrackerSettings held = settings();
    held.yaw_sigma = held.pitch_sigma = settings().thresholds.pinned;
    const Matrix6d c = two_led_covariance(held, pinhole(), pose.p_L, pose.cos_roll, pose.sin_roll);
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = C_LR.transpose();
    start({C_RL * pose.p_L, (C_RL * rotation_about_z(pose.cos_roll, pose.sin_roll)).normalized()},
          turn * c * turn.transpose());
  }

  void start(const Pose& X_RH, const Matrix6d& covariance_R) {
    filter_.start(X_RH, covariance_R);
    running_ = true;
    view_ = HeadFilter::View::all;
    unassigned_ = 0;
  }

  /// Returns how many LEDs the head was found from; 0: not found.
  int acquire(double t, const Reading& reading, const Matrix3d& C_LR) {
    if (settings().leds.count == 2) {
      pair_ = follower_.match(t, reading, C_LR);
      if (!pair_.found()) return 0;
      start_from(pair_.pose, C_LR);
      assigned_ = {pair_.blob[0], pair_.blob[1], -1, -1};
      return 2;
    }
    const Upright prior = upright();
    const Reading seen = clutter_.removed_from(reading);
    Acquired acquired = acquire_head(seen, settings(), pinhole(), solver_, prior, size_);
    if (!acquired.solved.found) acquired = acquire_head_from_two(seen, settings(), pinhole(), solver_, prior, size_);
    if (found_from_two_ && !acquired.solved.found) running_ = false;
    found_from_two_ = false;
    if (!acquired.solved.found) return 0;
    start(acquired.solved.X_RH, acquired.solved.covariance);
    const auto found_from =
        static_cast<int>(std::count_if(acquired.blob.begin(), acquired.blob.end(), [](int blob) { return blob >= 0; }));
    view_ = view_of(found_from);
    found_from_two_ = found_from == 2;
    return found_from;
  }

  // ---- what is reported

  void report(double t, int seen, const Matrix3d& C_LR, Estimate& result) {
    SolvedPose state;
    state.X_RH = filter_.X_RH();
    state.covariance = filter_.covariance();
    level(state, C_LR, tilt_variance(), result.pose, result.covariance);
    result.covariance += unaveraged(result.pose);
    if (settings().leds.count == 2) result.covariance(5, 5) += HalfTurn::variance(doubt_);
    result.known = true;
    result.usable = (seen > 0 || t - t_seen_ <= settings().thresholds.coast_max) &&
                    result.covariance.diagonal().head<3>().maxCoeff() <
                        settings().thresholds.sigma_max * settings().thresholds.sigma_max &&
                    filter_.X_RH().position.z() > 0;
  }

  /// What the filter must not average away: rounding errors that stand still with the head and, with two LEDs, the yaw
  /// and pitch that it holds at zero.
  [[nodiscard]] Matrix6d unaveraged(const Pose& X_LH) const {
    TrackerSettings constant = settings();
    constant.pixel_sigma = standing_pixels();
    if (settings().leds.count > 2) constant.yaw_sigma = constant.pitch_sigma = 1e-3;
    const Eigen::Vector2d roll = roll_of(X_LH.rotation * Vector3d::UnitX());
    return two_led_covariance(constant, pinhole(), X_LH.position, roll.x(), roll.y());
  }

  /// Remembers where the LEDs were and what else was in the image: clutter, should the head be lost.
  void admitted(double t, bool valid) override {
    const auto leds = std::span(assigned_).first(static_cast<std::size_t>(settings().leds.count));
    if (valid && std::find(leds.begin(), leds.end(), -1) == leds.end())
      clutter_.learn(reading_, leds);
    else
      clutter_.follow(reading_);
    if (leds.size() > 2 || !valid || pair_.blob[0] < 0 || pair_.blob[1] < 0) return;
    pair_.pose.p_L = filter_.X_RH().position;  // only how far it is counts
    follower_.follow(t, reading_, pair_);
    const Eigen::Vector2d roll = roll_of(gravity(0).C_LR() * filter_.R_RH().col(0));
    half_turn_.follow(t, roll.x(), roll.y());
  }
  void restart() override {
    running_ = false;
    follower_.forget();
    clutter_.forget();
    found_from_two_ = false;
    size_ = {};
    half_turn_.forget();
    last_blob_ = {};
    repetition_ = 1;
  }

  PoseSolver solver_;
  PairFollower follower_;  ///< acquires a pair; the filter itself follows the LEDs
  Clutter clutter_;
  LedSize size_;
  bool found_from_two_ = false;  ///< of three LEDs, whose yaw a pair must not seem to show: found anew in every report
  HalfTurn half_turn_;
  double doubt_ = 0;  ///< that the pair is the other way round
  HeadFilter filter_;
  Reading reading_;
  PairFollower::Match pair_;  ///< this report's blobs of the first two LEDs
  Assignment assigned_{};     ///< this report's blobs of all LEDs that were followed
  double pixel_variance_;
  bool running_ = false;
  double t_seen_ = 0;
  HeadFilter::View view_ = HeadFilter::View::all;  ///< of the last report
  bool lost_ = false;                              ///< the head must be acquired anew
  int unassigned_ = 0;                             ///< reports in a row with missing LEDs and unassigned blobs
  std::array<Blob, kLedsMax> last_blob_{};         ///< of each LED
  double repetition_ = 1;                          ///< share of coordinates that are as they were in the report before
};

}  // namespace

std::unique_ptr<Tracker> make_scaat(const TrackerSettings& settings) {
  return std::make_unique<Scaat>(settings);
}

}  // namespace verisim::wii
