#include "engine/simulation/stages/neighbours.hpp"

#include <algorithm>
#include <utility>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

// A body is looked for this far around it: a part of its size, for what a hand or a blow may do to it within a step,
// and twice what it is about to move. Too little, and a fast body meets another a frame late; too much, and pairs are
// made that never touch.
constexpr double kAhead = 0.05;  // of the diagonal of its box
constexpr double kSteps = 2;
constexpr double kFarthest = 1e12;  // m: of a speed whose square is beyond all numbers

std::vector<BroadPhaseBody> boxes_of(const World& world) {
  std::vector<BroadPhaseBody> boxes;
  for (const Body& body : world.bodies) {
    const Vector3d half = 0.5 * body.bounds_B.size() + Vector3d::Constant(grown_by(body));
    boxes.push_back({body.bounds_B.center(), half, body.can_move});
  }
  return boxes;
}

/// Bound of the velocity of any point of a body [m/s].
double speed_of(const Body& body) {
  return body.rigid.v_C.norm() + body.rigid.omega.norm() * body.bounds_B.size().norm();
}

double ahead_of(const World& world, const Body& body) {
  if (!body.can_move) return 0;
  return std::min(kAhead * body.bounds_B.size().norm() + kSteps * world.dt * speed_of(body), kFarthest);
}

std::string text_of_late(const World& world, const Note& note) {
  return fmt::format(
      "'{}' gained more speed in a step than contacts are looked ahead for: what it meets for the first "
      "time may be found a step late; use a smaller timestep",
      world.bodies[note.first].name);
}

/// The box along the world's axes around the body's own, grown one.
Bounds grown_box(const Body& body) {
  const Pose X_WB = body.rigid.pose();
  const Vector3d half_B = 0.5 * body.bounds_B.size() + Vector3d::Constant(grown_by(body));
  const Vector3d half = X_WB.rotation.toRotationMatrix().cwiseAbs() * half_B;
  const Vector3d center = X_WB * body.bounds_B.center();
  Bounds box;
  box.include(center - half);
  box.include(center + half);
  return box;
}

std::uint64_t key_of(std::size_t first, std::size_t second) {
  return static_cast<std::uint64_t>(first) << 32 | second;
}

}  // namespace

Neighbours::Neighbours(const World& world)
    : broad_phase_(boxes_of(world)),
      boxes_(world.bodies.size()),
      ahead_(world.bodies.size()),
      told_(world.bodies.size(), false),
      is_placed_(world.bodies.size()) {
  VERISIM_ASSERT(world.bodies.size() < (std::size_t{1} << 32));
  moved_.reserve(world.bodies.size());
  placed_.reserve(world.bodies.size());
  for (std::size_t i = 0; i < world.bodies.size(); ++i) place(world, i);
}

void Neighbours::place(const World& world, std::size_t i) {
  boxes_[i] = grown_box(world.bodies[i]);
  ahead_[i] = ahead_of(world, world.bodies[i]);
  broad_phase_.set_pose(i, world.bodies[i].rigid.pose(), ahead_[i]);
}

void Neighbours::watch(const World& world, Notes& notes) {
  for (const std::size_t i : world.moving) {
    const Body& body = world.bodies[i];
    if (told_[i] || !body.method->needs_precise_surfaces()) continue;
    if (!(world.dt * speed_of(body) > ahead_[i])) continue;
    told_[i] = true;
    notes.add({.time = world.time(), .kind = "late contact", .text = text_of_late, .first = i});
  }
}

void Neighbours::look_around(World& world) {
  if (std::exchange(anew_, false)) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (world.bodies[i].can_move) is_placed_.add(i);
  }
  for (const std::size_t i : moved_) is_placed_.add(i);
  for (const std::size_t i : world.moving) is_placed_.add(i);
  find_of_placed(world);
  is_placed_.clear();
  moved_ = world.moving;
  world.near_links.clear();
  strangers_.clear();
  for (const auto& [i, j] : near_) {
    const std::size_t l = link_of(i, j);
    if (l == kNone || world.links[l].number == kNone)
      strangers_.emplace_back(i, j);
    else
      world.near_links.push_back(l);
  }
}

/// What stood still is as near to each other as it was. The broad phase finds more than what is near: its boxes are
/// larger.
void Neighbours::find_of_placed(const World& world) {
  const auto is_of_placed = [&](const NearPair& pair) {
    return is_placed_.has(pair.first) || is_placed_.has(pair.second);
  };
  placed_.clear();
  is_placed_.append_to(placed_);
  for (const std::size_t i : placed_) place(world, i);
  stood_.clear();
  for (const NearPair& pair : near_)
    if (!is_of_placed(pair)) stood_.push_back(pair);
  near_.clear();
  left_out_ = 0;
  auto next = stood_.begin();
  const auto add = [&](const NearPair& pair) {
    if (near_.size() < room_)
      near_.push_back(pair);
    else
      ++left_out_;
  };
  for (const NearPair& pair : broad_phase_.find()) {
    const auto [i, j] = pair;
    if (!is_of_placed(pair) || gap(boxes_[i], boxes_[j]) > ahead_[i] + ahead_[j]) continue;
    for (; next != stood_.end() && *next < pair; ++next) add(*next);
    add(pair);
  }
  for (; next != stood_.end(); ++next) add(*next);
}

void Neighbours::make_room(World& world) {
  room_ = std::max(broad_phase_.make_room(), 2 * (near_.size() + left_out_));
  for (std::vector<NearPair>* list : {&near_, &stood_, &strangers_}) list->reserve(room_);
  world.near_links.reserve(room_);
  anew_ = true;
}

std::size_t Neighbours::link_of(std::size_t first, std::size_t second) const {
  const std::uint64_t pair = key_of(first, second);
  const auto at = std::lower_bound(known_.begin(), known_.end(), pair,
                                   [](const Known& known, std::uint64_t wanted) { return known.pair < wanted; });
  return at != known_.end() && at->pair == pair ? at->link : kNone;
}

void Neighbours::add_link(const World& world, std::size_t l) {
  const auto [first, second, number] = world.links[l];
  VERISIM_ASSERT(first < second);
  VERISIM_ASSERT(second < world.bodies.size());
  VERISIM_ASSERT(link_of(first, second) == kNone);
  const Known known{key_of(first, second), l};
  known_.insert(std::upper_bound(known_.begin(), known_.end(), known,
                                 [](const Known& a, const Known& b) { return a.pair < b.pair; }),
                known);
}

}  // namespace verisim
