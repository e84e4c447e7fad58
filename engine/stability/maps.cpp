#include "engine/stability/maps.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/stability/hand_on_wall.hpp"
#include "engine/stability/pressed_body.hpp"

namespace verisim::stability {

std::optional<double> Row::figure(const std::string& name) const {
  for (const Figure& figure : figures)
    if (figure.name == name) return figure.value;
  return std::nullopt;
}

namespace {

constexpr const char* kPressed = "body-on-wall";

constexpr const char* kHeld = "hand-on-wall";
constexpr const char* kPassive = "passive-wall";
constexpr const char* kQuantised = "quantised-wall";

constexpr double kDiscreteTolerance = 0.01;
constexpr double kHeldTolerance = 0.05;
constexpr double kEncoderStep = 55e-6;  // m: the Omni's

/// Adds what was found beside theory. @param applies  else the tolerance is nobody's promise, and `why` says the reason
void compare(Row& row, const char* unit, std::optional<double> found, double theory, double tolerance,
             const char* why_not = nullptr) {
  row.holds = found && (why_not != nullptr || std::abs(*found / theory - 1) <= tolerance);
  if (why_not != nullptr) row.why = why_not;
  if (!found) row.why = "no bound was found in the range that was looked at";
  const double nan = std::nan("");
  row.figures.push_back({"found", unit, found.value_or(nan)});
  row.figures.push_back({"theory", unit, theory});
  row.figures.push_back({"difference", "1", found ? *found / theory - 1 : nan});
  if (why_not == nullptr) row.figures.push_back({"tolerance", "1", tolerance});
}

/// A cell holds unless theory says stable and the engine is not, or the other way round.
void judge(Row& row, const Verdict& verdict, double used, double limit) {
  row.outcome = verdict.outcome;
  row.holds = (used < limit) == (verdict.outcome == Outcome::stable);
  row.why = verdict.event;
}

/// K at which K dt^2/m + 2 B dt/m is 4; B goes as the root of K.
double stable_stiffness(const PressedBody& body, const Response& response) {
  const double by_root = response.damping / std::sqrt(response.stiffness), dt = body.step;
  const double root = (std::sqrt(by_root * by_root + 4 * body.mass) - by_root) / dt;
  return root * root;
}

Row pressed_cell(const PressedBody& asked) {
  PressedBody body = asked;
  // contactStiffness is of one contact; that of all of them is what theory speaks of.
  const Response unit = response_of(body);
  body.stiffness *= asked.stiffness / unit.stiffness;
  const Response response = response_of(body);
  const Verdict verdict = press(body);
  Row row;
  row.what = fmt::format("{} kg, {} s, K {:.4g} N/m", body.mass, body.step, response.stiffness);
  row.theory = "stable if K dt^2/m + 2 B dt/m < 4";
  row.figures = {{"mass", "kg", body.mass},
                 {"step", "s", body.step},
                 {"stiffness", "N/m", response.stiffness},
                 {"damping", "N s/m", response.damping},
                 {"budget", "1", budget_of(body, response)},
                 {"bound", "N/m", stable_stiffness(body, response)},
                 {"frames", "1", static_cast<double>(verdict.frames)},
                 {"swing", "m", verdict.swing}};
  judge(row, verdict, budget_of(body, response), 4);
  return row;
}

Row pressed_bound(const PressedBody& body) {
  Row row;
  row.what = fmt::format("{} kg, {} s, damping ratio {}", body.mass, body.step, body.damping_ratio);
  row.theory = "K dt^2/m + 2 B dt/m = 4";
  row.figures = {{"mass", "kg", body.mass}, {"step", "s", body.step}, {"damping_ratio", "1", body.damping_ratio}};
  const std::optional<PressedBound> bound = bound_of(body);
  if (bound) row.figures.push_back({"stiffness", "N/m", bound->stiffness});
  compare(row, "1", bound ? std::optional(bound->budget) : std::nullopt, 4, kDiscreteTolerance);
  return row;
}

void add_pressed(std::vector<Task>& tasks) {
  const std::vector<double> masses = {0.01, 0.1, 1, 10}, steps = {5e-4, 1e-3, 2e-3};
  for (const double step : steps)
    for (const double mass : masses)
      for (int i = 0; i < 9; ++i) {
        PressedBody body;
        body.mass = mass;
        body.step = step;
        body.stiffness = 1e3 * pinned::pow(10.0, 0.5 * i);
        tasks.push_back({kPressed, RowKind::cell, "", false, [body] { return pressed_cell(body); }});
      }
  for (const double step : steps)
    for (const double mass : masses) {
      PressedBody body;
      body.mass = mass;
      body.step = step;
      tasks.push_back({kPressed, RowKind::bound, "", mass != 1, [body] { return pressed_bound(body); }});
    }
}

std::vector<Figure> figures_of(const HandOnWall& h) {
  return {{"mass", "kg", h.mass},
          {"damping", "N s/m", h.damping},
          {"wall_damping", "N s/m", h.wall_damping},
          {"delay", "s", h.periods_late * h.period},
          {"period", "s", h.period}};
}

std::string words_of(const HandOnWall& h) {
  return fmt::format("{:g} kg, b {:g} N s/m, B {:g} N s/m, {:g} ms late", h.mass, h.damping, h.wall_damping,
                     1e3 * h.periods_late * h.period);
}

Row held_cell(const HandOnWall& h) {
  const Verdict verdict = hold(h);
  Row row;
  row.what = fmt::format("{}, K {:.4g} N/m", words_of(h), h.stiffness);
  row.theory = "stable if K < (b + B)/(T/2 + t_d)";
  row.figures = figures_of(h);
  row.figures.push_back({"stiffness", "N/m", h.stiffness});
  row.figures.push_back({"bound", "N/m", stable_stiffness(h)});
  row.figures.push_back({"frames", "1", static_cast<double>(verdict.frames)});
  row.figures.push_back({"swing", "m", verdict.swing});
  judge(row, verdict, h.stiffness, stable_stiffness(h));
  return row;
}

Row held_bound(const HandOnWall& h) {
  Row row;
  row.what = words_of(h);
  row.theory = "K = (b + B)/(T/2 + t_d)";
  row.figures = figures_of(h);
  // At 0.04 kg the wall's own frequency is no longer slow against 1/T: 2384 N/m instead of 2400 (ORACLES section 2).
  compare(row, "N/m", bound_of(h), stable_stiffness(h), kHeldTolerance,
          h.mass < 0.4 ? "theory is of much inertia, 0.4 kg and more" : nullptr);
  return row;
}

void add_held(std::vector<Task>& tasks) {
  HandOnWall h;
  for (const unsigned late : {0U, 1U, 2U})
    for (const double b : {0.2, 0.4, 0.8, 1.6})
      for (int i = 0; i < 9; ++i) {
        h.periods_late = late;
        h.damping = b;
        h.stiffness = 100 * pinned::pow(10.0, 0.25 * i);
        tasks.push_back(
            {kHeld, RowKind::cell, "", late == 2 || (i % 2 == 1 && b != 0.8), [h] { return held_cell(h); }});
      }
  for (const unsigned late : {0U, 1U, 2U, 4U})
    for (const double b : {0.4, 0.8, 1.6})
      for (const double B : {0.0, 0.4})
        for (const double mass : {0.04, 0.4, 2.0}) {
          h = {};
          h.mass = mass;
          h.damping = b;
          h.wall_damping = B;
          h.periods_late = late;
          h.frames = late == 0 ? 40 : 20;  // a frame counts as half of one less of delay
          const bool is_long = mass > 1 || b != 0.8 || (mass < 0.4 && late > 0) || B == 0 || late == 4;
          tasks.push_back({kHeld, RowKind::bound, "", is_long, [h] { return held_bound(h); }});
        }
}

Row passive_bound(const HandOnWall& h) {
  Row row;
  row.what = fmt::format("b {:g} N s/m, B {:g} N s/m, T {:g} ms", h.damping, h.wall_damping, 1e3 * h.period);
  row.theory = "b = K T/2 + |B|, by the energy observer";
  row.figures = figures_of(h);
  compare(row, "N/m", passive_bound_of(h, {1e-3}), passive_stiffness(h), kHeldTolerance);
  return row;
}

Row quantised_bound(const HandOnWall& h) {
  Row row;
  row.what = fmt::format("b {:g} N s/m, friction {:g} N, steps of {:g} um", h.damping, h.friction, 1e6 * h.resolution);
  row.theory = "K = min(2 b/T, 2 f_c/Delta), by the energy observer";
  row.figures = figures_of(h);
  row.figures.push_back({"friction", "N", h.friction});
  row.figures.push_back({"resolution", "m", h.resolution});
  // Within a step of the encoder friction alone resists, over a long way damping alone.
  compare(row, "N/m", passive_bound_of(h, {1e-4 * h.resolution, 1.001 * h.resolution, 1}), passive_stiffness(h),
          kHeldTolerance);
  return row;
}

/// Passive is stable; what is not passive may be stable with this hand all the same.
Row quantised_cell(const HandOnWall& h) {
  const Verdict verdict = hold(h);
  Row row;
  row.what =
      fmt::format("friction {:g} N, steps of {:g} um, K {:.4g} N/m", h.friction, 1e6 * h.resolution, h.stiffness);
  row.theory = "passive, and so stable, if K < min(2 b/T, 2 f_c/Delta)";
  row.figures = figures_of(h);
  row.figures.push_back({"friction", "N", h.friction});
  row.figures.push_back({"resolution", "m", h.resolution});
  row.figures.push_back({"stiffness", "N/m", h.stiffness});
  row.figures.push_back({"bound", "N/m", passive_stiffness(h)});
  row.figures.push_back({"frames", "1", static_cast<double>(verdict.frames)});
  row.figures.push_back({"swing", "m", verdict.swing});
  row.outcome = verdict.outcome;
  row.holds = h.stiffness >= passive_stiffness(h) || verdict.outcome == Outcome::stable;
  row.why = verdict.event;
  return row;
}

void add_passive(std::vector<Task>& tasks) {
  HandOnWall h;
  for (const double period : {5e-4, 1e-3, 2e-3})
    for (const double b : {0.8, 3.0})
      for (const double B : {0.0, 0.4}) {
        h.period = period;
        h.damping = b;
        h.wall_damping = B;
        tasks.push_back({kPassive, RowKind::bound, "", false, [h] { return passive_bound(h); }});
      }
}

void add_quantised(std::vector<Task>& tasks) {
  HandOnWall h;
  h.damping = 2;
  h.resolution = kEncoderStep;
  for (const double friction : {0.0, 0.01, 0.03, 0.1})
    for (int i = 0; i < 9; ++i) {
      h.friction = friction;
      h.stiffness = 100 * pinned::pow(10.0, 0.25 * i);
      tasks.push_back(
          {kQuantised, RowKind::cell, "", i % 2 == 1 || friction == 0.03, [h] { return quantised_cell(h); }});
    }
  for (const double friction : {0.003, 0.01, 0.03, 0.1, 0.3}) {
    h.friction = friction;
    tasks.push_back({kQuantised, RowKind::bound, "", false, [h] { return quantised_bound(h); }});
  }
}

}  // namespace

const std::vector<MapDescription>& map_descriptions() {
  static const std::vector<MapDescription> all = {
      {kPressed, "a body pressed on a wall by the contact response, semi-implicit",
       "stable if and only if K dt^2/m + 2 B dt/m < 4", "stiffness", "mass", "step"},
      {kHeld, "a hand of 0.4 kg at a virtual wall, sampled every 1 ms", "stable if K < (b + B)/(T/2 + t_d)",
       "stiffness", "damping", "delay"},
      {kPassive, "the same wall, by the energy that can be got out of it", "passive if b > K T/2 + |B|", "theory",
       "found", "period"},
      {kQuantised, "a hand of 0.4 kg and 2 N s/m at a virtual wall, seen by an encoder in steps of 55 um",
       "passive if K <= min(2 b/T, 2 f_c/Delta)", "stiffness", "friction", "resolution"}};
  return all;
}

std::vector<Task> map_tasks() {
  std::vector<Task> tasks;
  add_pressed(tasks);
  add_held(tasks);
  add_passive(tasks);
  add_quantised(tasks);
  return tasks;
}

}  // namespace verisim::stability
