// What runs beside the loop on a clock of its own: a tracked head, a robot with its firmware. The loop knows a
// companion by this alone; nothing that the loop computes depends on one, unless a device or a script asks it.
#pragma once

#include <string>

#include "engine/base/columns.hpp"
#include "engine/base/part_notes.hpp"

namespace verisim {

class Companion {
 public:
  Companion() = default;
  virtual ~Companion() = default;
  Companion(const Companion&) = delete;
  Companion& operator=(const Companion&) = delete;

  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Brings it to simulated time t [s], the end of a frame, in steps of its own. Called once a frame, companions in the
  /// order of adding. No allocation, no wall clock: the same calls give the same bits.
  virtual void advance(double t) = 0;
  /// Simulated time after which it has nothing more to do [s]; 0: it has no end of its own.
  [[nodiscard]] virtual double duration() const = 0;
  /// Adds what is recorded of it. Called once, before the first frame; the getters live as long as the companion.
  virtual void declare(Columns& columns) const = 0;
  /// Says what began or ended in the last frame; each text goes on behind its kind: "tracker", "has lost the base". No
  /// allocation.
  virtual void report(PartNotes& /*notes*/) {}
};

}  // namespace verisim
