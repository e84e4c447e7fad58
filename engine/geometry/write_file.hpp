// Writing a file in one piece.
#pragma once

#include <string>

namespace verisim {

/// Replaces the file's content. Error(io) naming the path if the folder is missing or read-only or the disk is full.
void write_file(const std::string& path, const std::string& content);

}  // namespace verisim
