#include "engine/compare/report.hpp"
#include "engine/base/json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/overloaded.hpp"
#include "engine/base/text.hpp"
#include "engine/base/text_table.hpp"

namespace verisim::compare {
namespace {

std::string text_of(const Value& value) {
  return std::visit(
      Overloaded{[](std::monostate) { return std::string("-"); }, [](std::uint64_t n) { return std::to_string(n); },
                 [](double x) { return fmt::format("{:.6g}", x); },
                 [](const std::string& word) { return word.empty() ? "''" : shown(word, 60); }},
      value);
}

Json json_value(const Value& value) {
  return std::visit(Overloaded{[](std::monostate) { return Json(); }, [](const auto& known) { return Json(known); }},
                    value);
}

const char* word_of(Change change) {
  switch (change) {
    case Change::none:
      return "same";
    case Change::better:
      return "better";
    case Change::worse:
      return "worse";
    case Change::changed:
    case Change::bits:
      return "different";
  }
  return "";
}

const char* word_of(TimeChange change) {
  switch (change) {
    case TimeChange::none:
      return "same";
    case TimeChange::faster:
      return "faster";
    case TimeChange::slower:
      return "slower";
    case TimeChange::unknown:
      return "no verdict";
  }
  return "";
}

double number_of(const Value& value) {
  if (const auto* n = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*n);
  const auto* x = std::get_if<double>(&value);
  return x != nullptr ? *x : std::nan("");
}

/// "+3.10 %"; empty if one of them is no number or A is 0.
std::string change_in_percent(const Value& a, const Value& b) {
  const double from = number_of(a), to = number_of(b);
  if (!std::isfinite(from) || !std::isfinite(to) || from == 0) return "";
  return fmt::format("{:+.3g} %", 100 * (to - from) / std::abs(from));
}

std::string with_note(std::string word, const std::string& note) {
  return note.empty() ? word : word + ": " + note;
}

std::string counts_of(const Comparison& c) {
  if (c.counts_compared == 0 && c.counts.empty()) return "";
  if (c.counts.empty()) return fmt::format("counts: all {} are equal\n", c.counts_compared);
  TextTable table({fmt::format("counts: {} of {} differ", c.counts.size(), c.counts_compared), "A", "B", "B to A", ""});
  for (const CountDifference& d : c.counts)
    table.add({d.name, text_of(d.a), text_of(d.b), change_in_percent(d.a, d.b), with_note(word_of(d.change), d.note)});
  return table.text();
}

std::string accuracy_of(const Comparison& c) {
  if (c.accuracy.empty()) return "";
  TextTable table({"accuracy", "A", "B", "bound", ""});
  for (const AccuracyFigure& f : c.accuracy)
    table.add({f.name, text_of(f.a), text_of(f.b), f.bound ? fmt::format("{:.3g}", *f.bound) : "",
               with_note(word_of(f.change), f.note)});
  return table.text();
}

std::string outcomes_of(const Comparison& c) {
  if (c.outcomes.empty()) return "";
  TextTable table({"outcomes", "A", "B", ""});
  for (const OutcomeFigure& f : c.outcomes)
    table.add({f.name, text_of(f.a), text_of(f.b), with_note(word_of(f.change), f.note)});
  return table.text();
}

std::string times_of(const Comparison& c) {
  if (c.times.empty()) return "";
  TextTable table({"times", "A", "B", "B / A", "95 %", "p", ""});
  for (const TimeFigure& f : c.times) {
    const bool has_interval = f.low && f.high;
    table.add({f.name, fmt::format("{:.4g} {}", f.median_a, f.unit), fmt::format("{:.4g} {}", f.median_b, f.unit),
               fmt::format("{:.4f}", f.ratio), has_interval ? fmt::format("{:.4f} to {:.4f}", *f.low, *f.high) : "",
               f.p ? fmt::format("{:.2g}", *f.p) : "", f.note.empty() ? word_of(f.change) : f.note});
  }
  return table.text();
}

std::string line_of(const char* letter, const Origin& origin) {
  std::string from = origin.version.empty() ? "" : "verisim " + origin.version;
  if (!origin.commit.empty()) from += (from.empty() ? "commit " : ", commit ") + origin.commit;
  return fmt::format("{}: {}{}\n", letter, shown(origin.path), from.empty() ? "" : " (" + shown(from) + ")");
}

Json json_of_origin(const Origin& origin) {
  return {{"path", origin.path}, {"version", origin.version}, {"commit", origin.commit}};
}

template <typename T>
Json json_or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json json_of_time(const TimeFigure& f) {
  return {{"name", f.name},
          {"ratio", f.ratio},
          {"low", json_or_null(f.low)},
          {"high", json_or_null(f.high)},
          {"p", json_or_null(f.p)},
          {"a", f.median_a},
          {"b", f.median_b},
          {"unit", f.unit},
          {"repetitions", {f.count_a, f.count_b}},
          {"change", word_of(f.change)},
          {"note", f.note}};
}

}  // namespace

std::string table_of(const Comparison& c) {
  std::string text = line_of("A", c.a) + line_of("B", c.b);
  for (const std::string& notice : c.notices) text += "note: " + notice + "\n";
  for (const std::string& part : {outcomes_of(c), accuracy_of(c), counts_of(c), times_of(c)})
    if (!part.empty()) text += part;
  for (const std::string& name : c.only_a) text += "only in A: " + name + "\n";
  for (const std::string& name : c.only_b) text += "only in B: " + name + "\n";
  if (!c.first_difference.empty()) text += "first difference: " + c.first_difference + "\n";
  text += std::string("verdict: ") + name_of(verdict_of(c));
  bool is_first = true;
  for (const std::string& reason : reasons_of(c)) {
    text += (is_first ? ": " : "; ") + reason;
    is_first = false;
  }
  return text + "\n";
}

Json json_of(const Comparison& c) {
  Json j = {{"verdict", name_of(verdict_of(c))}, {"why", reasons_of(c)},     {"kind", c.kind},
            {"a", json_of_origin(c.a)},          {"b", json_of_origin(c.b)}, {"counts_compared", c.counts_compared}};
  for (const char* list : {"counts", "accuracy", "outcomes", "times"}) j[list] = Json::array();
  for (const CountDifference& d : c.counts)
    j["counts"].push_back({{"name", d.name},
                           {"a", json_value(d.a)},
                           {"b", json_value(d.b)},
                           {"change", word_of(d.change)},
                           {"note", d.note}});
  for (const AccuracyFigure& f : c.accuracy)
    j["accuracy"].push_back({{"name", f.name},
                             {"a", json_value(f.a)},
                             {"b", json_value(f.b)},
                             {"bound", json_or_null(f.bound)},
                             {"change", word_of(f.change)},
                             {"note", f.note}});
  for (const OutcomeFigure& f : c.outcomes)
    j["outcomes"].push_back({{"name", f.name},
                             {"a", json_value(f.a)},
                             {"b", json_value(f.b)},
                             {"change", word_of(f.change)},
                             {"note", f.note}});
  for (const TimeFigure& f : c.times) j["times"].push_back(json_of_time(f));
  j["only_a"] = c.only_a;
  j["only_b"] = c.only_b;
  j["first_difference"] = c.first_difference.empty() ? Json() : Json(c.first_difference);
  j["notes"] = c.notices;
  return j;
}

}  // namespace verisim::compare
