// Precise contacts, found and solved: every body that an exact pair can move is prepared without those contacts, then
// each island of bodies that touch is one convex problem (engine/exact/convex_step.hpp).
//
// Bodies may begin inside of each other, or be put there. No motion brought them there, so there is no energy in it:
// until they are apart, or touch as others do, their contacts move them apart with ConvexStep::kPushOut at most and
// give them no velocity. An event of kind "overlap" names the pair. It says otherwise of those that came there
// between contacts, where voxels gave way and told precise contacts nothing.
#pragma once

#include <memory>
#include <vector>

#include "engine/exact/convex_step.hpp"
#include "engine/exact/oriented_box.hpp"
#include "engine/simulation/stages/neighbours.hpp"
#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/stages/response.hpp"

namespace verisim {

class ExactResponse {
 public:
  explicit ExactResponse(const World& world) : bodies_(world.bodies.size()), island_(world.bodies.size()) {}
  // Between frames.
  void add_link(const World& world, const PairMethods& methods, std::size_t link);
  /// Notes which bodies begin, or were put, so deep inside of each other that no feature is near another.
  void look_inside(const World& world, const PairMethods& methods, Notes& notes);
  /// Room for more than the last frames needed, so that the next finds it too.
  void make_room();

  void solve(const World& world, const Neighbours& neighbours, const PairMethods& methods, const Response& response,
             FrameCost& cost, Notes& notes);
  /// A body was put elsewhere: what it touches there, no motion has brought about. Between frames.
  void forget(const World& world, std::size_t body);

  /// Does the body move with velocity(), under wrench(), in this frame?
  [[nodiscard]] bool solved(std::size_t body) const { return bodies_[body].solved; }
  [[nodiscard]] const ImplicitStep& step(std::size_t body) const { return bodies_[body].step; }
  [[nodiscard]] const Vector6d& velocity(std::size_t body) const { return bodies_[body].velocity; }
  /// With which it ends the step: another one if it was hit and rebounds.
  [[nodiscard]] const Vector6d& velocity_after(std::size_t body) const { return bodies_[body].velocity_after; }
  [[nodiscard]] const Wrench& wrench(std::size_t body) const { return bodies_[body].wrench; }
  /// With it the wrench is about where the body was at the start of the step: that of a rebound acts at its end [N m].
  [[nodiscard]] const Vector3d& shift_moment(std::size_t body) const { return bodies_[body].shift_moment; }

  /// What the precise contacts of a link do to its second body.
  [[nodiscard]] const Wrench& on_second(std::size_t link) const { return links_[link].on_second; }
  [[nodiscard]] std::uint32_t count(std::size_t link) const { return links_[link].acting; }  ///< rows that push
  [[nodiscard]] double depth_max(std::size_t link) const { return links_[link].depth_max; }  ///< m
  /// Were the pair's precise contacts looked for in this frame?
  [[nodiscard]] bool searched(std::size_t link) const { return links_[link].searched; }
  /// Does the pair move apart that was put inside of each other?
  [[nodiscard]] bool parts(std::size_t link) const { return links_[link].late; }
  [[nodiscard]] std::uint64_t of_body(std::size_t body) const { return bodies_[body].contacts; }

 private:
  struct OfBody {
    bool solved = false;
    ImplicitStep step;
    Vector6d velocity = Vector6d::Zero(), velocity_after = Vector6d::Zero();
    double speed = 0;                    ///< m/s, bound of that of any of its points without contact
    double speed_hit = 0;                ///< m/s, likewise if another body hits it in this step
    Vector6d during = Vector6d::Zero();  ///< with which it was taken to move when its contacts were found
    bool moves_otherwise = false;        ///< than that
    bool is_found_again = false;         ///< is `during` the answer to contacts that were found before?
    Vector6d last = Vector6d::Zero(), last_change = Vector6d::Zero();  ///< velocity of the last step, and its change
    Wrench wrench;
    Vector3d shift_moment = Vector3d::Zero();
    Bounds box_B;
    exact::OrientedBox box;                              ///< box_B
    bool placed = false;                                 ///< is it of this frame?
    std::size_t first_body = kNone, first_link = kNone;  ///< of the island that begins with this body
    std::size_t next = kNone;                            ///< body of its island
    int in_solver = exact::kFixed;
    std::uint64_t contacts = 0;
    double rounded = 0;  ///< m/s, what the roundings of its contacts' forces gave it in this frame
    bool told = false;   ///< of that
  };
  struct Pressing {
    exact::ConvexStep::Grip grip;
    double force = 0;  ///< N, across the grip
  };
  struct OfLink {
    exact::ExactLink* search = nullptr;  ///< null: none in this frame, or certainly without rows
    bool searched = false;
    bool late = false;       ///< is any row, in this frame, of bodies that have not been calm since?
    bool was_put = false;    ///< is it late because they began or were put so, and not in the course of contact?
    bool told = false;       ///< that they overlap
    bool is_new = false;     ///< has not been looked inside since its bodies began or were put where they are
    bool idle = false;       ///< since the last frame's begin nothing has been found: all but calm and told is as made
    std::uint32_t calm = 0;  ///< frames without a late row since the two began or were put here; kCalm: as all others
    std::uint32_t acting = 0;
    int in_solver = exact::ConvexStep::kNoGrip;
    std::size_t next = kNone;      ///< link of its island
    std::size_t found_in = kNone;  ///< frame
    double depth_max = 0;
    double overlap = 0;  ///< m, of rows that were not late when there last were any
    Wrench on_second;
    Pressing pressing;  ///< of the last frame, or of a blow in this one
  };
  void begin(const World& world, const Response& response);
  static void expect_motion(const RigidBody& rigid, double dt, OfBody& of);
  void find(const World& world, const Neighbours& neighbours, const PairMethods& methods, FrameCost& cost);
  void begin_frame(const World& world, OfLink& of) const;
  void find(const World& world, std::size_t link, exact::ExactLink& search, double closing, FrameCost& cost);
  [[nodiscard]] bool is_of_island(const World& world, std::size_t link, std::size_t island) const;
  [[nodiscard]] const exact::OrientedBox& placed(const World& world, std::size_t body);
  void expect_blows(const World& world, const PairMethods& methods);
  void list_islands(const World& world);
  [[nodiscard]] double closing(const World& world, const Link& link) const;
  void solve_island(const World& world, const Neighbours& neighbours, const PairMethods& methods, std::size_t island,
                    FrameCost& cost);
  [[nodiscard]] bool mark_otherwise_moved(const World& world, std::size_t island);
  void find_again(const World& world, const Neighbours& neighbours, const PairMethods& methods, std::size_t island,
                  FrameCost& cost);
  void solve_problem(const World& world, std::size_t island, FrameCost& cost, bool again);
  void add_grip(const World& world, std::size_t link);
  [[nodiscard]] Pressing pressing(std::size_t link, std::size_t first_row) const;
  [[nodiscard]] bool squeezes_light_body(const World& world, std::size_t island);
  void read_grip(const World& world, std::size_t link, std::size_t first_row);
  void read_bodies(std::size_t island, double dt);
  void read_rows(const World& world, std::size_t link, std::size_t first_row, FrameCost& cost);
  void tell(const World& world, Notes& notes);
  void note_overlap(const World& world, std::size_t link, double depth, Notes& notes);

  std::unique_ptr<exact::ConvexStep> solver_;  ///< null: no pair has precise contacts
  std::vector<OfBody> bodies_;
  std::vector<OfLink> links_;
  bool some_are_new_ = false;                        ///< links
  std::size_t rows_needed_ = 0, blocks_needed_ = 0;  ///< most so far, of one island
  std::vector<std::size_t> island_;                  ///< of each body: the number of its island's first body
};

}  // namespace verisim
