// What stages have to say of a frame. A step makes no text, for that takes memory: it notes what there is to be said,
// and between frames each note becomes an event.
#pragma once

#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/record/run_file.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

struct Note {
  double time;       ///< s
  const char* kind;  ///< of the event
  std::string (*text)(const World& world, const Note& note);
  std::size_t first = 0, second = 0;  ///< whom it is about: bodies, hands, as `text` takes them
  double a = 0, b = 0;                ///< what else `text` says
  const char* detail = "";            ///< likewise; a literal
};

class Notes {
 public:
  /// Between frames. What a frame may have to say: five things of every body, two of every link, both ends of a grasp
  /// of every hand and of the hand that it takes from, a coupling that turns round, what devices and companions report,
  /// and what found no room.
  void make_room(const World& world, std::size_t links) {
    constexpr std::size_t kOthers = 64;
    notes_.reserve(5 * world.bodies.size() + 2 * links + (6 + PartNotes::kMax) * world.hands.size() +
                   PartNotes::kMax * world.companions.size() + kOthers);
  }
  /// No allocation within that room.
  void add(const Note& note) {
    VERISIM_ASSERT(note.text != nullptr);
    notes_.push_back(note);
  }
  /// Between frames: an event each, in the order of noting.
  void tell(const World& world, std::vector<Event>& events) {
    for (const Note& note : notes_) events.push_back({note.time, note.kind, note.text(world, note)});
    notes_.clear();
  }

 private:
  std::vector<Note> notes_;
};

}  // namespace verisim
