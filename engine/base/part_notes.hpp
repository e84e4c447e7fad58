// What began or ended in a frame with a part of the simulation that has a name: a device, a companion. A frame makes no
// text, for that takes memory: what is noted are literals, which become events between frames.
#pragma once

#include <array>
#include <cstddef>

#include "engine/base/error.hpp"

namespace verisim {

class PartNotes {
 public:
  static constexpr std::size_t kMax = 32;
  struct Note {
    const char* kind;
    const char* text;  ///< behind the part's name, or the kind
  };
  /// No allocation. @pre there are fewer than kMax in this frame: two of each part of a chain
  void add(const char* kind, const char* text) {
    VERISIM_ASSERT(count_ < kMax);
    notes_[count_++] = {kind, text};
  }
  [[nodiscard]] const Note* begin() const { return notes_.data(); }
  [[nodiscard]] const Note* end() const { return notes_.data() + count_; }
  [[nodiscard]] std::size_t size() const { return count_; }
  void clear() { count_ = 0; }

 private:
  std::array<Note, kMax> notes_{};
  std::size_t count_ = 0;
};

}  // namespace verisim
