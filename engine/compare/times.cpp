#include "engine/compare/times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/compare/rank_tests.hpp"
#include "engine/compare/shift.hpp"

namespace verisim::compare {
namespace {

std::vector<double> logarithms(const std::vector<double>& times) {
  std::vector<double> logs;
  for (const double time : times) {
    VERISIM_ASSERT(time > 0);
    VERISIM_ASSERT(std::isfinite(time));
    logs.push_back(pinned::log(time));
  }
  return logs;
}

std::optional<double> ratio_of(double shift) {
  if (!std::isfinite(shift)) return {};
  return pinned::exp(shift);
}

/// Ratio, interval and p.
TimeFigure measured(const TimeSamples& s) {
  VERISIM_ASSERT(!s.a.empty());
  VERISIM_ASSERT(!s.b.empty());
  VERISIM_ASSERT(!s.is_paired || s.a.size() == s.b.size());
  TimeFigure figure{.name = s.name, .unit = s.unit, .count_a = s.a.size(), .count_b = s.b.size()};
  figure.is_judged = s.is_judged;
  figure.median_a = median_of(s.a);
  figure.median_b = median_of(s.b);
  const std::vector<double> a = logarithms(s.a), b = logarithms(s.b);
  Shift shift;
  if (s.is_paired) {
    std::vector<double> differences;
    for (std::size_t i = 0; i < a.size(); ++i) differences.push_back(b[i] - a[i]);
    shift = shift_of_pairs(differences, kLevel);
    if (a.size() > 1) figure.p = signed_rank(differences).p;
  } else {
    shift = shift_of_samples(a, b, kLevel);
    if (std::min(a.size(), b.size()) > 1) figure.p = mann_whitney(a, b).p;
  }
  figure.ratio = pinned::exp(shift.estimate);
  figure.low = ratio_of(shift.low);
  figure.high = ratio_of(shift.high);
  return figure;
}

/// No p that so few repetitions can have is small enough.
bool is_too_few(const TimeSamples& s, std::size_t judged, double alpha) {
  const double least = s.is_paired ? least_p_of_pairs(s.a.size()) : least_p_of_samples(s.a.size(), s.b.size());
  return least * static_cast<double>(judged) >= alpha;
}

std::string repetitions_of(const TimeSamples& s) {
  return s.a.size() == s.b.size() ? fmt::format("{} of each", s.a.size())
                                  : fmt::format("{} and {}", s.a.size(), s.b.size());
}

}  // namespace

std::vector<TimeFigure> judge_times(std::span<const TimeSamples> samples, const TimeRule& rule) {
  VERISIM_ASSERT(rule.effect >= 0);
  VERISIM_ASSERT(rule.alpha > 0);
  VERISIM_ASSERT(rule.alpha < 1);
  std::vector<TimeFigure> figures;
  std::vector<double> p;
  for (const TimeSamples& s : samples) {
    figures.push_back(measured(s));
    if (s.is_judged && figures.back().p) p.push_back(*figures.back().p);
  }
  const std::vector<double> corrected = holm(p);
  std::size_t next = 0;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    TimeFigure& figure = figures[i];
    if (!figure.p) {
      figure.note = "one repetition: no verdict on time";
      continue;
    }
    if (!figure.is_judged) {
      figure.note = "not judged";
      continue;
    }
    const bool is_sure = corrected[next++] < rule.alpha;
    if (is_too_few(samples[i], p.size(), rule.alpha)) {
      figure.note = fmt::format("{}: too few for a verdict on time", repetitions_of(samples[i]));
      continue;
    }
    figure.change = TimeChange::none;
    if (is_sure && figure.ratio > 1 + rule.effect) figure.change = TimeChange::slower;
    if (is_sure && figure.ratio < 1 / (1 + rule.effect)) figure.change = TimeChange::faster;
  }
  return figures;
}

}  // namespace verisim::compare
