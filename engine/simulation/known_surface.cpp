#include "engine/simulation/known_surface.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/simulation/world.hpp"

namespace verisim {
namespace {

const char* is_or_are(std::size_t count) {
  return count == 1 ? "is" : "are";
}

void add_sentence(std::string& text, const std::string& more) {
  if (more.empty()) return;
  text += (text.empty() ? "" : "; ") + more;
}

bool is_bare(const KnownSurface& known) {
  return !known.declared && !known.refused && known.parts_without_brep == known.parts;
}

/// What a method that needs entities, or one that needs precise surfaces, does not find in a body.
std::string gap_of(const Body& body, bool precise) {
  const KnownSurface& known = body.surface;
  if (known.declared)
    return precise
               ? fmt::format("the faces of '{}' were declared by hand: voxels know them, 'exact' does not", body.name)
               : "";
  if (known.refused) return fmt::format("no b-rep: '{}' was added with brep = false", body.name);
  if (is_bare(known))
    return fmt::format("no b-rep: '{}' is of bare triangles (Model{{ FILE, brep = true }} looks for faces)", body.name);
  std::string text;
  if (known.parts_without_brep > 0)
    add_sentence(text,
                 fmt::format("no b-rep: {} of {} parts of '{}' {} of bare triangles (Model{{ FILE, brep = true }})",
                             known.parts_without_brep, known.parts, body.name, is_or_are(known.parts_without_brep)));
  if (known.declined > 0)
    add_sentence(text, fmt::format("recovery declined {} of {} faces of '{}'", known.declined, known.faces, body.name));
  if (known.unknown > 0)
    add_sentence(text, fmt::format("{} of {} faces of '{}' {} of a kind that is not known", known.unknown, known.faces,
                                   body.name, is_or_are(known.unknown)));
  return text;
}

}  // namespace

KnownSurface known_surface(const BodyDescription& description) {
  KnownSurface known;
  known.refused = !description.use_brep;
  known.declared = description.declared != nullptr;
  known.parts = description.parts.size();
  for (const Part& part : description.parts) {
    known.parts_without_brep += part.has_brep() ? 0 : 1;
    known.faces += part.faces.size();
    const auto others =
        static_cast<std::size_t>(std::count_if(part.faces.begin(), part.faces.end(), [](const Face& face) {
          return std::holds_alternative<OtherSurface>(face.surface);
        }));
    (part.exact ? known.unknown : known.declined) += others;
  }
  return known;
}

std::string gaps_of(const Body& first, const Body& second, Hybrid asked) {
  if (!asked->needs_entities()) return {};
  if (is_bare(first.surface) && is_bare(second.surface))
    return fmt::format("no b-rep: '{}' and '{}' are of bare triangles (Model{{ FILE, brep = true }} looks for faces)",
                       first.name, second.name);
  std::string text;
  for (const Body* body : {&first, &second}) add_sentence(text, gap_of(*body, asked->needs_precise_surfaces()));
  return text;
}

std::string why_off(const World& world, const Body& first, const Body& second) {
  const auto is_named = [](Hybrid method) { return method->needs_entities(); };
  if (is_named(lesser(first.method, second.method))) return {};
  if (!is_named(world.parameters.hybrid) && !is_named(first.asked) && !is_named(second.asked)) return {};
  std::string text;
  for (const Body* body : {&first, &second})
    if (!is_named(body->asked)) add_sentence(text, fmt::format("'{}' has hybrid = \"off\"", body->name));
  if (world.parameters.contact == ContactMethod::fcl)
    add_sentence(text, "contact = \"fcl\": triangles answered, as with hybrid = \"off\"");
  return text;
}

std::string why_voxels(const Body& first, const Body& second, Hybrid asked) {
  std::string text = gaps_of(first, second, asked);
  const bool acts = first.entities != nullptr && second.entities != nullptr;
  if (!acts) return text;
  if (!asked->needs_precise_surfaces()) {
    add_sentence(text, fmt::format("'{}' acts on the voxels' contacts", asked->name()));
  } else if (!first.exact || !second.exact) {
    add_sentence(text, "'restore' acts on them");
  }
  return text;
}

}  // namespace verisim
