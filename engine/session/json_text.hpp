// What every --json prints and every JSON text in a run file is: one valid object, whatever bytes the names in it have.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace verisim {

/// On one line. Bytes that are not UTF-8 become U+FFFD: names are checked where they enter, files of other people may
/// hold anything.
template <typename Json>
[[nodiscard]] std::string json_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace verisim
