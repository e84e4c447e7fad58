#include "engine/vrpn/connection.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/vrpn/payload.hpp"

namespace verisim::vrpn {
namespace {

constexpr std::int32_t kIdCount = 2000;  // valid ids are below

std::string_view name_at(const std::vector<std::string>& names, std::int32_t id) {
  const auto i = static_cast<std::size_t>(id);
  return id >= 0 && i < names.size() ? std::string_view(names[i]) : std::string_view();
}

}  // namespace

std::int32_t id_of(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<std::int32_t>(found - names.begin());
}

Connection::Connection(const Names& names, std::optional<UdpEnd> own_udp)
    : names_(&names), own_udp_(std::move(own_udp)) {
  VERISIM_ASSERT(names.senders.size() < kIdCount);
  VERISIM_ASSERT(names.types.size() < kIdCount);
  for (const std::string& name : names.senders) VERISIM_ASSERT(is_name(name));
  for (const std::string& name : names.types) VERISIM_ASSERT(is_name(name));
  put_cookie(out_);
}

void Connection::receive(View bytes, Timestamp now, const Handler& handler) {
  if (faulty()) return;
  in_.insert(in_.end(), bytes.begin(), bytes.end());
  if (!established_) take_cookie(now);
  if (established_) take_messages(handler);
}

void Connection::take_cookie(Timestamp now) {
  if (in_.size() < kCookieBytes) return;
  if (!cookie_is_good(View(in_).first(kCookieBytes))) {
    fault_ = "does not speak VRPN protocol 07";
    return;
  }
  in_.erase(in_.begin(), in_.begin() + kCookieBytes);
  established_ = true;
  if (own_udp_) {
    Bytes host;
    put_text(host, own_udp_->host);
    send_system(kUdpDescription, own_udp_->port, now, host);
  }
  for (std::size_t i = 0; i < names_->senders.size(); ++i)
    send_system(kSenderDescription, static_cast<std::int32_t>(i), now, encode_name(names_->senders[i]));
  for (std::size_t i = 0; i < names_->types.size(); ++i)
    send_system(kTypeDescription, static_cast<std::int32_t>(i), now, encode_name(names_->types[i]));
}

void Connection::take_messages(const Handler& handler) {
  View rest(in_);
  while (!faulty()) {
    const ParsedMessage parsed = first_message(rest);
    if (parsed.state == ParsedMessage::State::malformed) fault_ = "sent a message of an impossible length";
    if (parsed.state != ParsedMessage::State::whole) break;
    take(parsed.message, handler);
    rest = rest.subspan(parsed.bytes);
  }
  in_.erase(in_.begin(), in_.end() - static_cast<std::ptrdiff_t>(rest.size()));
}

void Connection::receive_datagram(View datagram, const Handler& handler) {
  if (!established_) return;
  while (!datagram.empty() && !faulty()) {
    const ParsedMessage parsed = first_message(datagram);
    if (parsed.state != ParsedMessage::State::whole) return;
    if (parsed.message.type >= 0) take(parsed.message, handler);  // descriptions travel on TCP alone
    datagram = datagram.subspan(parsed.bytes);
  }
}

void Connection::take(const Message& message, const Handler& handler) {
  if (message.type >= 0) {
    const std::string_view sender = name_at(peer_senders_, message.sender);
    const std::string_view type = name_at(peer_types_, message.type);
    if (!sender.empty() && !type.empty()) handler({message.time, sender, type, message.payload});
    return;
  }
  if (message.type < kSystemTypeMin) fault_ = fmt::format("sent a message of type {}", message.type);
  if (message.type == kSenderDescription) describe(peer_senders_, message);
  if (message.type == kTypeDescription) describe(peer_types_, message);
  if (message.type == kUdpDescription && message.sender > 0 && message.sender <= 65535)
    peer_udp_ = UdpEnd{std::string(text_before_nul(message.payload).substr(0, kNameMax)),
                       static_cast<std::uint16_t>(message.sender)};
  if (message.type == kDisconnect) {
    peer_senders_.clear();
    peer_types_.clear();
  }
}

void Connection::describe(std::vector<std::string>& peer_names, const Message& message) {
  const auto name = decode_name(message.payload);
  if (!name || message.sender < 0 || message.sender >= kIdCount) {
    fault_ = fmt::format("described a name wrongly (id {})", message.sender);
    return;
  }
  const auto id = static_cast<std::size_t>(message.sender);
  if (id >= peer_names.size()) peer_names.resize(id + 1);
  peer_names[id] = *name;
}

void Connection::send(std::string_view sender, std::string_view type, Timestamp time, View payload) {
  const std::int32_t sender_id = id_of(names_->senders, sender);
  const std::int32_t type_id = id_of(names_->types, type);
  VERISIM_ASSERT(sender_id >= 0);
  VERISIM_ASSERT(type_id >= 0);
  if (!established_ || faulty()) return;
  append({time, sender_id, type_id, tcp_sequence_++, payload});
}

Bytes Connection::datagram(std::string_view sender, std::string_view type, Timestamp time, View payload) {
  VERISIM_ASSERT(established_);
  const std::int32_t sender_id = id_of(names_->senders, sender);
  const std::int32_t type_id = id_of(names_->types, type);
  VERISIM_ASSERT(sender_id >= 0);
  VERISIM_ASSERT(type_id >= 0);
  Bytes bytes;
  put_message(bytes, {time, sender_id, type_id, udp_sequence_++, payload});
  return bytes;
}

void Connection::send_system(std::int32_t type, std::int32_t sender, Timestamp time, View payload) {
  append({time, sender, type, tcp_sequence_++, payload});
}

void Connection::append(const Message& message) {
  put_message(out_, message);
  if (unsent().size() > kUnsentMax)
    fault_ = fmt::format("does not read: more than {} KiB wait for it", kUnsentMax / 1024);
}

void Connection::sent(std::size_t bytes) {
  VERISIM_ASSERT(bytes <= unsent().size());
  sent_ += bytes;
  if (sent_ == out_.size() || sent_ > kUnsentMax) {
    out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(sent_));
    sent_ = 0;
  }
}

}  // namespace verisim::vrpn
