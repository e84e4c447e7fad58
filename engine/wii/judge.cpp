#include "engine/wii/judge.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/quantile.hpp"
#include "engine/wii/validation_figures.hpp"

namespace verisim::wii {
namespace {

constexpr double kSame = 1e-9;        // s: times that were written with nine digits
constexpr double kGapMax = 0.1;       // s between two samples that truth may be interpolated over
constexpr double kOffsetMax = 1;      // s, either way, that is searched
constexpr double kOffsetStep = 0.02;  // s, the first; then it is halved down to 0.1 ms
constexpr double kMotionMin = 0.005;  // m rms about the mean: below, noise decides

/// The truth at any time.
class Truth {
 public:
  explicit Truth(std::span<const SensedReport> samples) : samples_(samples) {}

  /// The sample at t, or what stands between two; false where there is none.
  [[nodiscard]] bool at(double t, SensedReport& there) const {
    const auto after = std::lower_bound(samples_.begin(), samples_.end(), t - kSame,
                                        [](const SensedReport& s, double when) { return s.t < when; });
    if (after == samples_.end()) return false;
    if (after->t <= t + kSame) {
      there = *after;
      return true;
    }
    if (after == samples_.begin() || after->t - (after - 1)->t > kGapMax) return false;
    const SensedReport& before = *(after - 1);
    const double share = (t - before.t) / (after->t - before.t);
    there = share < 0.5 ? before : *after;
    there.t = t;
    there.X_LH.position = before.X_LH.position + share * (after->X_LH.position - before.X_LH.position);
    there.X_LH.rotation = slerp(before.X_LH.rotation, after->X_LH.rotation, share);
    return true;
  }

 private:
  std::span<const SensedReport> samples_;
};

/// Sums over pairs of positions, the tracker's and the true one.
struct Pairs {
  double count = 0;
  Vector3d sum_e = Vector3d::Zero(), sum_t = Vector3d::Zero();
  Matrix3d products = Matrix3d::Zero();  ///< sum of t e^T
  double squares_e = 0, squares_t = 0;

  void add(const Vector3d& e, const Vector3d& t) {
    ++count;
    sum_e += e;
    sum_t += t;
    products += t * e.transpose();
    squares_e += e.squaredNorm();
    squares_t += t.squaredNorm();
  }
  [[nodiscard]] Matrix3d about_means() const { return products - sum_t * sum_e.transpose() / count; }
  /// m rms about the mean, of whichever moves less.
  [[nodiscard]] double motion() const {
    const double e = squares_e - sum_e.squaredNorm() / count;
    const double t = squares_t - sum_t.squaredNorm() / count;
    return std::sqrt(std::max(0.0, std::min(e, t)) / count);
  }
  /// The turn that brings the tracker's positions nearest to the true ones (Umeyama, 1991, without scale).
  [[nodiscard]] Matrix3d turn() const {
    const Eigen::JacobiSVD<Matrix3d> svd(about_means(), Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix3d sign = Matrix3d::Identity();
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign(2, 2) = -1;
    return svd.matrixU() * sign * svd.matrixV().transpose();
  }
  /// The same among turns about +y.
  [[nodiscard]] Matrix3d turn_about_y() const {
    const Matrix3d C = about_means();
    const double angle = pinned::atan2(C(0, 2) - C(2, 0), C(0, 0) + C(2, 2));
    return rotation_from_vector({0, angle, 0}).toRotationMatrix();
  }
  /// m^2, mean, that no turn and shift takes away.
  [[nodiscard]] double left_over() const {
    const double spread = squares_e - sum_e.squaredNorm() / count + squares_t - sum_t.squaredNorm() / count;
    return std::max(0.0, spread - 2 * (turn().transpose() * about_means()).trace()) / count;
  }
};

Pairs pairs_at(const Truth& truth, std::span<const Report> reports, double offset) {
  Pairs pairs;
  SensedReport there;
  for (const Report& r : reports)
    if (r.valid && truth.at(r.t + offset, there)) pairs.add(r.pose.position, there.X_LH.position);
  return pairs;
}

/// What more is to be added to the times for the positions to fit best. Among offsets that keep half of the pairs.
std::optional<double> best_offset(const Truth& truth, std::span<const Report> reports, double from) {
  const Pairs here = pairs_at(truth, reports, from);
  const double enough = std::max(3.0, here.count / 2);
  if (here.count < 3 || here.motion() < kMotionMin) return std::nullopt;
  const auto cost = [&](double offset) {
    const Pairs pairs = pairs_at(truth, reports, from + offset);
    return pairs.count < enough ? std::numeric_limits<double>::infinity() : pairs.left_over();
  };
  double best = 0;
  double least = cost(0);
  for (int i = 1; i * kOffsetStep <= kOffsetMax; ++i)
    for (const double offset : {i * kOffsetStep, -i * kOffsetStep})
      if (const double c = cost(offset); c < least) {
        best = offset;
        least = c;
      }
  for (double step = kOffsetStep / 2; step > 5e-5; step /= 2)
    for (const double offset : {best + step, best - step})
      if (const double c = cost(offset); c < least) {
        best = offset;
        least = c;
      }
  return best;
}

Pose alignment_of(Alignment alignment, const Pairs& pairs) {
  Pose X_TE;
  if (alignment == Alignment::none) return X_TE;
  if (pairs.count < 3 || pairs.motion() < kMotionMin)
    fail(ErrorKind::input,
         "alignment: over {} valid reports the head moves by {:.1f} mm rms, too little to tell coordinates apart; "
         "judge a motion, or align nothing",
         pairs.count, pairs.count > 0 ? 1000 * pairs.motion() : 0);
  const Matrix3d R = alignment == Alignment::yaw ? pairs.turn_about_y() : pairs.turn();
  X_TE.rotation = Quaterniond(R).normalized();
  X_TE.position = (pairs.sum_t - R * pairs.sum_e) / pairs.count;
  return X_TE;
}

Report aligned(const Report& report, double offset, const Pose& X_TE) {
  Report r = report;
  r.t += offset;
  r.pose = {X_TE * report.pose.position, (X_TE.rotation * report.pose.rotation).normalized()};
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = X_TE.rotation.toRotationMatrix();
  r.covariance = turn * report.covariance * turn.transpose();
  return r;
}

template <typename Timed>
double period_of(std::span<const Timed> rows) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.size(); ++i) steps.push_back(rows[i].t - rows[i - 1].t);
  return steps.empty() ? 0 : quantile(steps, 0.5);
}

template <typename Timed>
void check_times(std::span<const Timed> rows, const char* what) {
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (!(rows[i].t > rows[i - 1].t))
      fail(ErrorKind::input, "{}: time does not grow at number {}: {} s after {} s; sort them and leave out doubles",
           what, i + 1, rows[i].t, rows[i - 1].t);
}

double offset_of(const TimeOffset& wanted, const Truth& truth, std::span<const SensedReport> samples,
                 std::span<const Report> reports) {
  const double to_start = samples.front().t - reports.front().t;
  if (wanted.kind == TimeOffset::Kind::given) return wanted.seconds;
  if (wanted.kind == TimeOffset::Kind::start) return to_start;
  const bool overlap = reports.front().t <= samples.back().t && reports.back().t >= samples.front().t;
  const double from = overlap ? 0 : to_start;
  return from + best_offset(truth, reports, from).value_or(0);
}

}  // namespace

unsigned leds_by_count(const Channels& channels) {
  Reading reading;
  (void)read_channels(channels, reading);
  return (1U << reading.blob_count) - 1;
}

Judgement judge(std::span<const SensedReport> samples, std::span<const Report> reports, const JudgeOptions& options) {
  if (samples.empty()) fail(ErrorKind::input, "{}: there is no sample to judge by", options.name);
  const bool any = std::any_of(reports.begin(), reports.end(), [](const Report& r) { return r.valid; });
  if (!any) fail(ErrorKind::input, "{}: not one of its {} reports is valid", options.name, reports.size());
  check_times(samples, "samples");
  check_times(reports, options.name.c_str());
  const Truth truth(samples);
  Judgement j;
  j.offset = offset_of(options.time_offset, truth, samples, reports);
  j.offset_better = best_offset(truth, reports, j.offset);
  const Pairs pairs = pairs_at(truth, reports, j.offset);
  if (pairs.count == 0)
    fail(ErrorKind::input,
         "{}: its times ({} to {} s) lie outside of the samples' ({} to {} s); shift them by a time offset of {} s",
         options.name, reports.front().t + j.offset, reports.back().t + j.offset, samples.front().t, samples.back().t,
         samples.front().t - reports.front().t);
  j.X_TE = alignment_of(options.alignment, pairs);

  ValidationFigures figures;
  const double half = std::max(period_of(samples), period_of(reports)) / 2;  // a slow tracker leaves nothing out
  std::size_t next = 0;                                                      // sample
  const auto leave_unanswered = [&](double until) {
    for (; next < samples.size() && samples[next].t < until; ++next) {
      ++j.unanswered;
      Report nothing;
      figures.add(samples[next], nothing);
      j.history.push_back(error_of(samples[next], nothing));
    }
  };
  SensedReport there;
  for (const Report& raw : reports) {
    const Report r = options.alignment == Alignment::none && j.offset == 0 ? raw : aligned(raw, j.offset, j.X_TE);
    if (!truth.at(r.t, there)) {
      ++j.outside;
      continue;
    }
    leave_unanswered(r.t - half - kSame);
    while (next < samples.size() && samples[next].t <= r.t + half) ++next;
    figures.add(there, r);
    j.history.push_back(error_of(there, r));
  }
  leave_unanswered(std::numeric_limits<double>::infinity());
  j.row = figures.result();
  j.row.tracker = options.name;
  j.row.trajectory = options.trajectory;
  j.row.sensor = options.sensor;
  j.row.update_ns = std::numeric_limits<double>::quiet_NaN();
  return j;
}

}  // namespace verisim::wii
