#include "engine/session/prepared_parts.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/base/own_file.hpp"
#include "engine/base/text.hpp"
#include "engine/geometry/cad_client.hpp"
#include "engine/session/build_id.hpp"
#include "engine/session/origin.hpp"

namespace verisim {
namespace {

namespace fs = std::filesystem;

/// An environment variable that holds an absolute path; else empty.
fs::path folder_in(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path path = value == nullptr ? "" : value;
  return path.is_absolute() ? path : fs::path();
}

}  // namespace

std::string prepared_folder() {
  if (const char* named = std::getenv("VERISIM_CACHE"); named != nullptr && *named != '\0')
    return fs::absolute(named).string();
  if (const fs::path cache = folder_in("XDG_CACHE_HOME"); !cache.empty()) return (cache / "verisim").string();
  if (const fs::path home = folder_in("HOME"); !home.empty()) return (home / ".cache" / "verisim").string();
  return {};
}

std::shared_ptr<PreparedStore> prepared_parts(bool wanted) {
  if (!wanted) return nullptr;
  const std::string folder = prepared_folder();
  if (folder.empty()) return nullptr;
  try {
    const std::string self = build_id_of(own_file()), cad = build_id_of(cad_program());
    if (self.empty() || cad.empty()) return nullptr;
    return std::make_shared<PreparedStore>(folder, self + " " + cad + " " + cpu_model());
  } catch (const Error&) {  // no verisim-cad: whoever needs it says so
    return nullptr;
  }
}

std::string damage_warning(const PreparedStore* store) {
  if (store == nullptr || store->damaged() == 0) return {};
  return fmt::format("{} prepared part(s) in {} were damaged and have been made anew", store->damaged(),
                     store->folder());
}

void warn_of_damage(const PreparedStore* store) {
  if (const std::string text = damage_warning(store); !text.empty())
    std::fprintf(stderr, "warning: %s\n", shown(text).c_str());
}

}  // namespace verisim
