// The order of one frame. To change it is to change every golden hash.
#include <chrono>
#include <utility>

#include "engine/simulation/implementation.hpp"
#include "engine/simulation/stages/companions.hpp"
#include "engine/simulation/stages/rendering.hpp"

namespace verisim {
namespace {

/// Times the stages of a frame. The one place where the loop reads a clock; nothing reads what it wrote.
class StageTimer {
 public:
  explicit StageTimer(StageTimes& stage_ns) : out_(stage_ns), last_(now()) {}
  /// The stage is over. @pre stages end in the order of Stage, none is left out
  void done(Stage stage) {
    VERISIM_ASSERT(static_cast<std::size_t>(stage) == next_);
    const auto t = now();
    out_[next_++] = static_cast<std::uint32_t>(t - last_);
    last_ = t;
  }
  /// The frame is over. @pre every stage is
  void done() const { VERISIM_ASSERT(next_ == kStageNames.size()); }

 private:
  static std::int64_t now() {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  }
  StageTimes& out_;
  std::size_t next_ = 0;
  std::int64_t last_;
};

}  // namespace

void Simulation::step() {
  prepare();
  auto& [events, world, notes, cost, s, maker, recording, left_out, stage_ns, met, met_before, poses_set] =
      *implementation_;
  StageTimer timer(stage_ns);
  cost = FrameCost();
  cost.pairs_met = met.size() - std::exchange(met_before, met.size());
  s.grasping.sample(world);  // raw pose -> virtual handle
  s.grasping.update(world, notes);
  s.busy.list(world);
  timer.done(Stage::sources);
  s.energy.enter_jump(world);
  s.response.pull(world);  // virtual coupling
  timer.done(Stage::coupling);
  s.methods.choose(world);
  s.contacts.query(world, s.neighbours, s.methods, cost);  // pointshell against voxmap
  timer.done(Stage::query);
  s.response.respond(world, s.contacts, s.methods, cost);  // penalty of every contact, summed in pair order
  timer.done(Stage::response);
  s.exact.solve(world, s.neighbours, s.methods, s.response, cost, notes);
  s.passivity.bound(world, s.contacts, s.methods, s.response, s.exact, s.energy.ledger());
  s.motion.advance(world, s.response, s.exact, s.passivity, s.energy.ledger());
  s.reactions.find(world, s.contacts, s.response, s.exact, s.motion);
  s.tunnelling.watch(world, s.methods, notes);
  s.sinking.watch(world, s.contacts, s.exact, s.reactions, notes);
  s.pair_energy.watch(world, s.contacts, s.exact, s.reactions, s.motion, notes);
  timer.done(Stage::motion);
  // coupling wrench -> what the hardware is told to render
  render(world, s.contacts, s.exact, s.response, s.motion, notes);
  timer.done(Stage::render);
  ++world.frame;
  advance_companions(world, notes);
  world.clocks.run_due(world.frame, world.time());  // scripts: same thread, fixed order
  world.list_moving();                              // which may have taken and let go
  timer.done(Stage::clocks);
  s.energy.settle(world);
  left_out.tell(cost, world.time(), notes);
  recording.take(world, s, cost);
  timer.done(Stage::record);
  s.neighbours.watch(world, notes);
  s.neighbours.look_around(world);  // broad phase, for the next frame
  poses_set = false;
  timer.done(Stage::neighbours);
  timer.done();
}

}  // namespace verisim
