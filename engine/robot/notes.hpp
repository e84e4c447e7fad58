// What the host side of the robot says: something began, or ended. Texts are literals; no allocation.
// One call per millisecond of simulated time to everything; times are counted in such calls.
#pragma once

#include <cstdint>

#include "engine/base/part_notes.hpp"

namespace verisim::robot {

using RobotNotes = PartNotes;

/// Something that lasts. It is over when it was not seen for `hold_ms`, so that what flickers is said once.
class Spell {
 public:
  Spell(const char* kind, const char* begins, const char* ends, std::uint64_t hold_ms = 0)
      : kind_(kind), begins_(begins), ends_(ends), hold_ms_(hold_ms) {}

  /// What is seen in millisecond `now`. @pre now is not before that of the last call
  void see(bool is_so, std::uint64_t now) {
    if (is_so) last_ms_ = now;
    is_on_ = is_so || (is_on_ && now - last_ms_ < hold_ms_);
  }
  [[nodiscard]] bool is_on() const { return is_on_; }
  void report(RobotNotes& notes) {
    if (is_on_ != is_said_) notes.add(kind_, is_on_ ? begins_ : ends_);
    is_said_ = is_on_;
  }

 private:
  const char *kind_, *begins_, *ends_;
  std::uint64_t hold_ms_, last_ms_ = 0;
  bool is_on_ = false, is_said_ = false;
};

}  // namespace verisim::robot
