#include "engine/geometry/message.hpp"

#include <algorithm>
#include <functional>

namespace verisim {
namespace {

constexpr std::string_view kMagic = "verisim-cad 1\n";

void put(std::string& out, std::uint64_t n) {
  out.append(reinterpret_cast<const char*>(&n), sizeof n);
}
void put(std::string& out, std::string_view text) {
  put(out, text.size());
  out += text;
}

/// Takes length-prefixed pieces off the front of a message.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_(bytes) {}
  std::string_view take(std::size_t n) {
    if (n > rest_.size())
      fail(ErrorKind::input, "the CAD program's message ends in the middle; it was interrupted, try again");
    const std::string_view piece = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return piece;
  }
  std::uint64_t number() {
    std::uint64_t n = 0;
    std::memcpy(&n, take(sizeof n).data(), sizeof n);
    return n;
  }
  std::string text() { return std::string(take(number())); }

 private:
  std::string_view rest_;
};

void put(std::string& out, const NamedArray& table) {
  put(out, table.name);
  put(out, static_cast<std::uint64_t>(table.dtype));
  put(out, table.shape.size());
  for (const std::size_t n : table.shape) put(out, n);
  put(out, std::string_view(reinterpret_cast<const char*>(table.bytes.data()), table.bytes.size()));
  put(out, table.units);
  put(out, table.description);
}

NamedArray take_table(Cursor& in) {
  NamedArray table;
  table.name = in.text();
  table.dtype = static_cast<Dtype>(in.number());
  for (std::uint64_t left = in.number(); left > 0; --left) table.shape.push_back(in.number());
  const std::string bytes = in.text();
  table.bytes.resize(bytes.size());
  if (!bytes.empty()) std::memcpy(table.bytes.data(), bytes.data(), bytes.size());
  table.units = in.text();
  table.description = in.text();
  return table;
}

const NamedArray& find(const Group& group, std::string_view name) {
  const auto found =
      std::find_if(group.tables.begin(), group.tables.end(), [&](const NamedArray& t) { return t.name == name; });
  if (found == group.tables.end()) {
    fail(ErrorKind::input,
         "the CAD program's message '{}' has no '{}'; verisim and verisim-cad are of different versions, "
         "build both",
         group.name, name);
  }
  return *found;
}

}  // namespace

std::string with_length(std::string_view bytes) {
  std::string out;
  put(out, bytes);
  return out;
}

std::optional<std::string_view> after_length(std::string_view bytes) {
  std::uint64_t length = 0;
  if (bytes.size() < sizeof length) return std::nullopt;
  std::memcpy(&length, bytes.data(), sizeof length);
  bytes.remove_prefix(sizeof length);
  return bytes.size() < length ? std::nullopt : std::optional(bytes.substr(0, length));
}

std::string encode(const Message& message) {
  std::string out(kMagic);
  put(out, message.size());
  for (const Group& group : message) {
    put(out, group.name);
    put(out, group.tables.size());
    for (const NamedArray& table : group.tables) put(out, table);
  }
  return out;
}

Message decode(std::string_view bytes) {
  Cursor in(bytes);
  if (in.take(kMagic.size()) != kMagic) {
    fail(ErrorKind::input,
         "the CAD program's message has an unknown form; verisim and verisim-cad are of different "
         "versions, build both");
  }
  Message message;
  for (std::uint64_t groups = in.number(); groups > 0; --groups) {
    Group& group = message.emplace_back();
    group.name = in.text();
    for (std::uint64_t tables = in.number(); tables > 0; --tables) group.tables.push_back(take_table(in));
  }
  return message;
}

NamedArray text_table(std::string name, std::string_view text) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  return NamedArray::from<std::uint8_t>(std::move(name), {bytes, text.size()}, {text.size()}, "1", "UTF-8");
}

std::string text_of(const Group& group, std::string_view name) {
  const NamedArray& table = find(group, name);
  return {reinterpret_cast<const char*>(table.bytes.data()), table.bytes.size()};
}

double number_of(const Group& group, std::string_view name) {
  const std::vector<double> values = find(group, name).as<double>();
  return values.empty() ? 0 : values.front();
}

NamedArray number_table(std::string name, double value) {
  return NamedArray::from<double>(std::move(name), {&value, 1}, {1}, "1", "");
}

std::vector<NamedArray> tables_of(const Solid& solid) {
  std::vector<std::uint8_t> kinds;
  std::vector<std::uint32_t> size_counts;
  std::vector<std::uint32_t> child_counts;
  std::vector<double> sizes;
  std::vector<double> placements;  // 7 a node: position, then quaternion x y z w
  const std::function<void(const Solid&)> visit = [&](const Solid& node) {
    for (const auto& child : node.children) {
      VERISIM_ASSERT(child != nullptr);
      visit(*child);
    }
    kinds.push_back(static_cast<std::uint8_t>(node.kind));
    size_counts.push_back(static_cast<std::uint32_t>(node.sizes.size()));
    child_counts.push_back(static_cast<std::uint32_t>(node.children.size()));
    sizes.insert(sizes.end(), node.sizes.begin(), node.sizes.end());
    const Vector3d& p = node.placement.position;
    const Quaterniond& q = node.placement.rotation;
    placements.insert(placements.end(), {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
  };
  visit(solid);
  return {NamedArray::from<std::uint8_t>("kinds", kinds, {kinds.size()}, "1", "Solid::Kind of each node, post-order"),
          NamedArray::from<std::uint32_t>("size_counts", size_counts, {kinds.size()}, "1", ""),
          NamedArray::from<std::uint32_t>("child_counts", child_counts, {kinds.size()}, "1", ""),
          NamedArray::from<double>("sizes", sizes, {sizes.size()}, "m", ""),
          NamedArray::from<double>("placements", placements, {kinds.size(), 7}, "m", "")};
}

Solid solid_from(const Group& group) {
  const auto kinds = find(group, "kinds").as<std::uint8_t>();
  const auto size_counts = find(group, "size_counts").as<std::uint32_t>();
  const auto child_counts = find(group, "child_counts").as<std::uint32_t>();
  const auto sizes = find(group, "sizes").as<double>();
  const auto placements = find(group, "placements").as<double>();
  VERISIM_ASSERT(size_counts.size() == kinds.size());
  VERISIM_ASSERT(child_counts.size() == kinds.size());
  VERISIM_ASSERT(placements.size() == 7 * kinds.size());
  std::vector<Solid> stack;
  auto next_size = sizes.begin();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    VERISIM_ASSERT(size_counts[i] <= static_cast<std::size_t>(sizes.end() - next_size));
    VERISIM_ASSERT(child_counts[i] <= stack.size());
    Solid node;
    node.kind = static_cast<Solid::Kind>(kinds[i]);
    node.sizes.assign(next_size, next_size + size_counts[i]);
    next_size += size_counts[i];
    const auto first_child = stack.end() - child_counts[i];
    for (auto child = first_child; child != stack.end(); ++child) {
      node.children.push_back(std::make_shared<const Solid>(std::move(*child)));
    }
    stack.erase(first_child, stack.end());
    const double* p = &placements[7 * i];
    node.placement = {{p[0], p[1], p[2]}, Quaterniond(p[6], p[3], p[4], p[5])};
    stack.push_back(std::move(node));
  }
  VERISIM_ASSERT(stack.size() == 1);
  return std::move(stack.front());
}

}  // namespace verisim
