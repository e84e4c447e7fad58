#include "engine/base/json.hpp"

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"

namespace verisim {

Json parse_json(std::string_view text) {
  return Json::parse(text);
}

Json parse_json_of(const std::string& file, const std::string& text, const std::string& advice) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    fail(ErrorKind::input, "{}:{}: is no JSON, or the file ends there; {}", file, line_of_byte(text, error.byte),
         advice);
  }
}

Json parse_json_or_discard(std::string_view text) {
  return Json::parse(text, nullptr, false);
}

std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace verisim
