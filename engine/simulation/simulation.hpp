// The fixed-step simulation of a scene. Simulated time only; same scene, same bits, whatever the threads and SIMD
// target.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/pose.hpp"
#include "engine/record/prepared_store.hpp"
#include "engine/record/run_file.hpp"
#include "engine/simulation/frame_cost.hpp"
#include "engine/simulation/scene.hpp"
#include "engine/simulation/totals.hpp"

namespace verisim {

struct SimulationOptions {
  unsigned threads = 1;
  /// Voxels and exact bodies that are there are taken from it; null: all are made here. Same bits.
  std::shared_ptr<PreparedStore> store = nullptr;
};

/// The stages of a frame in their order, as /timing/stage_ns counts them.
enum class Stage : std::uint8_t { sources, coupling, query, response, motion, render, clocks, record, neighbours };
inline constexpr std::array kStageNames = {"sources", "coupling", "query",  "response",  "motion",
                                           "render",  "clocks",   "record", "neighbours"};
static_assert(kStageNames.size() == static_cast<std::size_t>(Stage::neighbours) + 1, "every stage has its name");
using StageTimes = std::array<std::uint32_t, kStageNames.size()>;  ///< ns

/// Who answered the contacts of a pair, summed over its frames (/state/links/contacts, by_voxels).
struct PairAnswers {
  std::size_t first = 0, second = 0;  ///< bodies
  std::string first_name, second_name;
  std::string_view method;  ///< asked for; off: for one of the two, or for all by contact = "fcl"
  std::uint64_t contacts = 0, by_voxels = 0;
  std::string why;  ///< voxels answered some; empty: they did not

  [[nodiscard]] double fraction() const { return static_cast<double>(by_voxels) / static_cast<double>(contacts); }
};

class Simulation {
 public:
  /// Places bodies and devices, and prepares the first frame. Error(input) with body and reason: no volume, voxel size,
  /// mass not finite …
  Simulation(Scene scene, const SimulationOptions& options);
  ~Simulation();

  /// Makes what the coming frame needs of bodies that came near each other: voxels, entities, links (DESIGN rule 2). An
  /// event names each pair that does so for the first time. Between frames; allocates, and takes as long as it takes.
  /// Error(input) with body and reason.
  void prepare();
  /// The same now for all pairs that can meet, so that prepare() has little to do: before a paced loop. They still meet
  /// when they come near, with the same events and bits. Returns how many pairs these are.
  std::size_t prepare_all();
  /// Advances from frame to frame + 1, after prepare(). Allocates nothing if prepare() had nothing to do.
  /// Error(diverged) if a state stops being finite (nothing of that frame is recorded).
  void step();

  [[nodiscard]] std::uint64_t frame() const;  ///< frames computed so far
  [[nodiscard]] double time() const;          ///< frame * dt
  [[nodiscard]] double dt() const;
  [[nodiscard]] bool is_implicit() const;  ///< its integrator, whatever was asked for
  /// From duration or the longest device. Error(input) for more than a billion.
  [[nodiscard]] std::uint64_t frames_planned() const;
  [[nodiscard]] std::uint64_t collision_frames() const;
  [[nodiscard]] const FrameCost& cost() const;  ///< of the last frame
  /// Wall clock of each stage of the last frame [ns]: measured, never read by the simulation.
  [[nodiscard]] const StageTimes& stage_ns() const;
  [[nodiscard]] std::uint64_t state_hash() const;  ///< after the last frame

  // Bodies, by index in Scene::bodies.
  [[nodiscard]] std::size_t body_count() const;
  [[nodiscard]] Pose body_pose(std::size_t body) const;               ///< X_WB of the body coordinates
  [[nodiscard]] Twist body_twist(std::size_t body) const;             ///< of the centre of mass
  [[nodiscard]] Wrench body_force(std::size_t body) const;            ///< contact wrench of the last frame
  [[nodiscard]] std::uint64_t body_contacts(std::size_t body) const;  ///< colliding voxel pairs of the last frame
  void set_body_pose(std::size_t body, const Pose& X_WB);  ///< from scripts, between frames; velocity becomes zero
  /// Off: the pairs of this body stay with the voxel answer. On: its method of the scene, if there is one.
  void set_hybrid_enabled(std::size_t body, bool enabled);
  void grasp(std::size_t device, std::size_t body);
  void release(std::size_t device);
  [[nodiscard]] double mass(std::size_t body) const;

  /// Called between frames, at the first frame whose time is not before k / rate (integer arithmetic, no drift), in the
  /// order of adding, after the companions. `f` gets the simulated time. @pre f is not empty
  void add_clock(double rate_hz, std::function<void(double)> f);

  /// An event for /events; kept until clear_events. Its texts are made harmless (engine/base/text.hpp: shown).
  void add_event(const std::string& kind, const std::string& text);
  [[nodiscard]] const std::vector<Event>& events() const;
  void clear_events();

  /// The columns of /state and /cost of this scene, and the last frame's values written into a row of that schema.
  void describe(Schema& schema) const;
  void write_row(std::byte* row) const;
  /// For a recorder: which parts are not at rest (Column::rest), and write_row() without what all others have in it.
  [[nodiscard]] std::span<const std::size_t> awake() const;
  void write_awake(std::byte* row) const;
  /// The last frame's rows of /state/links, one behind the other.
  [[nodiscard]] std::span<const std::byte> table_rows() const;
  /// Pairs of bodies that have come near so far: the rows of /state/pairs.
  [[nodiscard]] const std::vector<BodyPair>& pairs() const;

  /// Energy ledger since the start [J] (dynamics/ledger.hpp).
  struct Energy {
    double kinetic, coupling, gravity, dissipated, contact, input, numerical, residual;
  };
  [[nodiscard]] Energy energy() const;

  [[nodiscard]] const Totals& totals() const;
  /// Of every pair that touched and for which a hybrid method was asked, in the order of first meetings: who answered
  /// its contacts so far.
  [[nodiscard]] std::vector<PairAnswers> answers() const;
  /// The same as the events with which a record of the frames so far ends.
  [[nodiscard]] std::vector<Event> last_events() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace verisim
