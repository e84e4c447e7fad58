#include "engine/cli/stored_facts.hpp"
#include "engine/base/json.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <set>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/session/origin.hpp"

namespace verisim::cli {
namespace {

using Attributes = std::map<std::string, Attribute>;

const Attribute* find(const Attributes& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? nullptr : &found->second;
}

std::string text_of(const Attribute* attribute) {
  if (attribute == nullptr || !std::holds_alternative<std::string>(*attribute)) return {};
  return std::get<std::string>(*attribute);
}

bool was_killed(const RunFile& file) {
  return file.summary().empty();
}

/// Equal to the bit: of two numbers that are none, too.
bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool are_equal(const Attribute& a, const Attribute& b) {
  const auto* x = std::get_if<double>(&a);
  const auto* y = std::get_if<double>(&b);
  return x != nullptr && y != nullptr ? same_bits(*x, *y) : a == b;
}

/// An attribute as a message has it: of a long text the part around `at`.
std::string excerpt_of(const Attribute& attribute, std::size_t at) {
  constexpr std::size_t kBefore = 20, kMost = 60;
  if (const auto* number = std::get_if<std::int64_t>(&attribute)) return std::to_string(*number);
  if (const auto* number = std::get_if<std::uint64_t>(&attribute)) return std::to_string(*number);
  if (const auto* number = std::get_if<double>(&attribute)) return fmt::format("{}", *number);
  const auto& text = std::get<std::string>(attribute);
  const std::size_t from = text.size() > kMost ? std::min(at - std::min(at, kBefore), text.size()) : 0;
  return "'" + text.substr(from, kMost) + "'";
}

std::string difference(const std::string& what, const Attribute* stored, const Attribute& simulated) {
  if (stored == nullptr) return what + ": is missing";
  if (are_equal(*stored, simulated)) return {};
  std::size_t at = 0;
  if (std::holds_alternative<std::string>(*stored) && std::holds_alternative<std::string>(simulated)) {
    const auto &a = std::get<std::string>(*stored), &b = std::get<std::string>(simulated);
    at = static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
  }
  return fmt::format("{}: stored {}, simulated {}", what, excerpt_of(*stored, at), excerpt_of(simulated, at));
}

/// Of those that both have, if the file comes from another program.
std::string first_difference(const Attributes& stored, const Attributes& simulated, const std::string& of,
                             bool from_here) {
  for (const auto& [name, value] : simulated) {
    const Attribute* const other = find(stored, name);
    if (other == nullptr && !from_here) continue;
    std::string found = difference(fmt::format("attribute '{}' of {}", name, of), other, value);
    if (!found.empty()) return found;
  }
  return {};
}

/// Attributes of /summary that no replay computes again.
std::set<std::string> attributes_of_once() {
  std::set<std::string> names;
  for (const RunFigure& figure : run_figures()) {
    if (!figure.only_once) continue;
    names.insert(figure.name);
    for (const char* quantile : {"_p50", "_p99", "_max"}) names.insert(std::string(figure.name) + quantile);
  }
  return names;
}

/// The JSON text without what no replay computes again. Text that is no JSON stays as it is.
std::string without_what_is_once(const std::string& text) {
  Json j = parse_json_or_discard(text);
  if (!j.is_object()) return text;
  for (const RunFigure& figure : run_figures())
    if (figure.only_once) j.erase(figure.name);
  const std::map<std::string, Json> sorted = j;  // another version may have written them in another order
  return json_text(sorted);
}

std::string difference_in_figures(const RunFile& file, const Attributes& simulated) {
  const std::set<std::string> once = attributes_of_once();
  Attributes wanted, stored;
  for (const auto& [name, value] : simulated)
    if (once.count(name) == 0) wanted[name] = value;
  for (const auto& [name, value] : file.summary())
    if (once.count(name) == 0) stored[name] = value;
  for (Attributes* attributes : {&wanted, &stored}) {
    const auto at = attributes->find("json");
    if (at != attributes->end()) at->second = without_what_is_once(text_of(&at->second));
  }
  if (!is_from_here(file)) wanted.erase("json");  // which has the figures of its own version
  std::string found = first_difference(stored, wanted, "/summary", is_from_here(file));
  if (!found.empty() || !is_from_here(file)) return found;
  for (const auto& [name, value] : stored)
    if (wanted.count(name) == 0) return fmt::format("attribute '{}' of /summary: is not in the simulation", name);
  return {};
}

/// How a simulation of the file's frames ends; nothing: it would go on.
std::optional<LoopEnd> end_of(Session& session, std::size_t frames) {
  if (frames >= session.simulation->frames_planned() || session.scenario->finished()) return LoopEnd::done;
  try {
    session.simulation->step();
    return {};
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::diverged) return LoopEnd::diverged;
    if (error.kind() == ErrorKind::input) return LoopEnd::refused;
    throw;
  }
}

bool are_equal(const Event& a, const Event& b) {
  return same_bits(a.time, b.time) && a.kind == b.kind && a.text == b.text;
}

std::string difference(std::size_t i, const Event& stored, const Event& simulated) {
  if (stored.time != simulated.time)
    return fmt::format("event {}: stored at {} s, simulated at {} s", i, stored.time, simulated.time);
  if (stored.kind != simulated.kind)
    return fmt::format("event {}: stored kind '{}', simulated '{}'", i, stored.kind, simulated.kind);
  return fmt::format("event {}: stored '{}', simulated '{}'", i, stored.text, simulated.text);
}

/// A paced run dropped `lost` events: what is left is in the order in which it happens again.
std::string difference_with_lost(const std::vector<Event>& stored, const std::vector<Event>& simulated,
                                 std::size_t lost) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < stored.size(); ++i, ++next) {
    while (next < simulated.size() && !are_equal(stored[i], as_stored(simulated[next]))) ++next;
    if (next == simulated.size()) return fmt::format("event {}: '{}' did not happen again", i, stored[i].text);
  }
  if (stored.size() + lost == simulated.size()) return {};
  return fmt::format("events: {} stored and {} lost, simulated {}", stored.size(), lost, simulated.size());
}

}  // namespace

bool is_from_here(const RunFile& file) {
  const Attributes& attributes = file.header().attributes;
  return text_of(find(attributes, "version")) == VERISIM_VERSION && text_of(find(attributes, "commit")) == commit();
}

std::string difference_in_attributes(const RunFile& file, const Session& session) {
  Attributes wanted = header_of(session, true).attributes;
  for (const char* of_once : {"version", "commit", "compiler", "cpu"}) wanted.erase(of_once);
  if (file.format_version() >= 2 && !was_killed(file)) wanted["state_hash"] = to_hex(session.simulation->state_hash());
  return first_difference(file.header().attributes, wanted, "/", is_from_here(file));
}

std::string difference_in_summary(const RunFile& file, Session& session) {
  if (was_killed(file) || file.format_version() < 2) return {};
  LoopResult loop;
  loop.frame_ns.resize(file.rows());
  if (text_of(find(file.summary(), "end")) == name_of(LoopEnd::interrupted)) {
    loop.end = LoopEnd::interrupted;
  } else {
    const std::optional<LoopEnd> end = end_of(session, file.rows());
    if (!end)
      return fmt::format("attribute 'end' of /summary: stored {}, but the simulation goes on after {} frames",
                         excerpt_of(*find(file.summary(), "end"), 0), file.rows());
    loop.end = *end;
  }
  return difference_in_figures(file, to_attributes(figures_of(session, loop, "")));
}

std::string difference_in_events(const RunFile& file, const std::vector<Event>& simulated, double time) {
  std::vector<Event> stored = file.events();
  if (!stored.empty() && stored.back().kind == kEventsLost) {
    const std::size_t lost = std::strtoull(stored.back().text.c_str(), nullptr, 10);
    stored.pop_back();
    return difference_with_lost(stored, simulated, lost);
  }
  for (std::size_t i = 0; i < std::min(stored.size(), simulated.size()); ++i) {
    const Event again = as_stored(simulated[i]);
    if (!are_equal(stored[i], again)) return difference(i, stored[i], again);
  }
  if (simulated.size() > stored.size() && !was_killed(file))
    return fmt::format("event {}: '{}' is not in the run file", stored.size(), simulated[stored.size()].text);
  for (std::size_t i = simulated.size(); i < stored.size(); ++i)
    if (!was_killed(file) || stored[i].time < time)
      return fmt::format("event {}: '{}' did not happen again", i, stored[i].text);
  return {};
}

}  // namespace verisim::cli
