#include "engine/robot/base_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {
namespace {

bool all_finite(const BaseEstimate::Place& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

}  // namespace

BaseEstimate::BaseEstimate(const Place& start, const EstimateParameters& parameters)
    : parameters_(parameters), x_(start), now_(start) {
  VERISIM_ASSERT(all_finite(start));
  VERISIM_ASSERT(parameters.alpha > 0);
  VERISIM_ASSERT(parameters.alpha <= 1);
  VERISIM_ASSERT(parameters.horizon >= 0);
  VERISIM_ASSERT(parameters.smoothing >= 0);
}

BaseEstimate::Place BaseEstimate::straight(double t) const {
  const double ahead = heard_ ? std::clamp(t - taken_, 0.0, parameters_.horizon) : 0;
  Place place;
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = x_[i] + v_[i] * ahead;
  return place;
}

void BaseEstimate::hear(const Place& place, double taken) {
  VERISIM_ASSERT(all_finite(place));
  VERISIM_ASSERT(std::isfinite(taken));
  if (heard_ && taken <= taken_) return;
  const Place before = now_;
  const double period = taken - taken_;
  if (!heard_ || period > parameters_.horizon) {
    x_ = place;  // the straight line of before says nothing of now
    v_ = {};
  } else {
    const double beta = parameters_.alpha * parameters_.alpha / (2 - parameters_.alpha);
    const Place expected = straight(taken);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const double innovation = place[i] - expected[i];
      x_[i] = expected[i] + parameters_.alpha * innovation;
      v_[i] += beta * innovation / period;
    }
  }
  taken_ = taken;
  heard_ = true;
  const Place after = straight(t_);
  const bool is_smooth = parameters_.smoothing > 0;
  for (std::size_t i = 0; i < offset_.size(); ++i) offset_[i] = is_smooth ? before[i] - after[i] : 0;
}

void BaseEstimate::advance(double t) {
  VERISIM_ASSERT(std::isfinite(t));
  VERISIM_ASSERT(t >= t_);
  const double decay = parameters_.smoothing > 0 ? pinned::exp((t_ - t) / parameters_.smoothing) : 0;
  t_ = t;
  now_ = straight(t);
  for (std::size_t i = 0; i < now_.size(); ++i) now_[i] += offset_[i] *= decay;
}

}  // namespace verisim::robot
