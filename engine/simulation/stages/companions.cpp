#include "engine/simulation/stages/companions.hpp"

namespace verisim {
namespace {

std::string text_of_companion(const World& world, const Note& note) {
  return fmt::format("{}: {} {}", world.companions[note.first]->name(), note.kind, note.detail);
}

}  // namespace

void advance_companions(World& world, Notes& notes) {
  PartNotes reports;
  for (std::size_t i = 0; i < world.companions.size(); ++i) {
    world.companions[i]->advance(world.time());
    reports.clear();
    world.companions[i]->report(reports);
    for (const PartNotes::Note& report : reports)
      notes.add(
          {.time = world.time(), .kind = report.kind, .text = text_of_companion, .first = i, .detail = report.text});
  }
}

}  // namespace verisim
