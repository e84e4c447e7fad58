// JSON: what every --json prints, what stands in run files and batch folders, and what users give. Read and printed
// here alone: nlohmann's parser and printer cost 3 s in each unit that calls them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace verisim {

using Json = nlohmann::ordered_json;  ///< members stay in the order in which they were written

/// @throws Json::parse_error with the byte (engine/base/text.hpp: line_of_byte)
[[nodiscard]] Json parse_json(std::string_view text);

/// What a user gives. Error(input): "FILE:12: is no JSON, or the file ends there; ADVICE".
[[nodiscard]] Json parse_json_of(const std::string& file, const std::string& text, const std::string& advice);

/// is_discarded() where the text is no JSON.
[[nodiscard]] Json parse_json_or_discard(std::string_view text);

/// One valid object whatever bytes the names in it have: bytes that are not UTF-8 become U+FFFD (names are checked
/// where they enter, files of other people may hold anything). On one line, or with lines that are indented.
[[nodiscard]] std::string json_text(const Json& json, int indent = -1);

}  // namespace verisim
