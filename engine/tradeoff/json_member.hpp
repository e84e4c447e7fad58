// Reading JSON from outside: what is not as it should be is named by its place, "rows[3].time_us.median is no number".
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/base/json.hpp"

namespace verisim::tradeoff {

/// What is wrong with a text of JSON, and where.
class JsonFault : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A member of a JSON text. Everything throws JsonFault for what is not there or of another kind.
class JsonMember {
 public:
  JsonMember(const Json& json, std::string place) : json_(&json), place_(std::move(place)) {}

  [[nodiscard]] const Json& json() const { return *json_; }
  [[nodiscard]] bool has(const char* name) const { return json_->is_object() && json_->contains(name); }
  [[nodiscard]] bool is_null() const { return json_->is_null(); }
  [[nodiscard]] JsonMember at(const std::string& name) const {
    if (!json_->is_object()) throw JsonFault((place_.empty() ? "it" : place_) + " is no object");
    if (!json_->contains(name)) throw JsonFault(fmt::format("{} is not there", below(name)));
    return {(*json_)[name], below(name)};
  }
  [[nodiscard]] std::vector<JsonMember> members() const {
    if (!json_->is_object()) throw JsonFault(place_ + " is no object");
    std::vector<JsonMember> all;
    for (const auto& [name, value] : json_->items()) all.push_back({value, below(name)});
    return all;
  }
  [[nodiscard]] std::vector<JsonMember> elements() const {
    if (!json_->is_array()) throw JsonFault(place_ + " is no list");
    std::vector<JsonMember> all;
    for (const auto& value : *json_) all.push_back({value, fmt::format("{}[{}]", place_, all.size())});
    return all;
  }
  [[nodiscard]] std::string text() const {
    if (!json_->is_string()) throw JsonFault(place_ + " is no text");
    return json_->get<std::string>();
  }
  [[nodiscard]] std::uint64_t count() const {
    if (!json_->is_number_unsigned()) throw JsonFault(place_ + " is no whole number of 0 or more");
    return json_->get<std::uint64_t>();
  }
  /// Finite.
  [[nodiscard]] double number() const {
    if (!json_->is_number() || !std::isfinite(json_->get<double>())) throw JsonFault(place_ + " is no number");
    return json_->get<double>();
  }
  [[nodiscard]] double number_from_0() const {
    if (!(number() >= 0)) throw JsonFault(place_ + " is below 0");
    return number();
  }

 private:
  [[nodiscard]] std::string below(const std::string& name) const { return place_.empty() ? name : place_ + "." + name; }

  const Json* json_;
  std::string place_;
};

}  // namespace verisim::tradeoff
