#include "engine/vrpn/client.hpp"

#include <poll.h>

#include <array>
#include <charconv>

#include "engine/base/error.hpp"
#include "engine/vrpn/payload.hpp"

namespace verisim::vrpn {
namespace {

constexpr std::size_t kBuffer = 64 * 1024;
constexpr int kDatagramsPerTurn = 64;

/// Removes `prefix` from the front of `text` if it is there.
bool take_prefix(std::string& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.erase(0, prefix.size());
  return true;
}

}  // namespace

RemoteName parse_remote_name(const std::string& text) {
  const std::size_t at = text.find('@');
  RemoteName name;
  name.device = text.substr(0, at);
  if (at == std::string::npos || name.device.empty() || name.device.size() > kNameMax)
    fail(ErrorKind::usage, "{}: write it as DEVICE@HOST or DEVICE@HOST:PORT, such as WiiMote0@localhost", text);
  name.host = text.substr(at + 1);
  name.direct = take_prefix(name.host, "tcp://") || take_prefix(name.host, "tcp:");
  if (!name.direct) (void)(take_prefix(name.host, "x-vrpn://") || take_prefix(name.host, "x-vrpn:"));
  const std::size_t colon = name.host.find(':');
  if (colon != std::string::npos) {
    const std::string port = name.host.substr(colon + 1);
    const auto parsed = std::from_chars(port.data(), port.data() + port.size(), name.port);
    if (parsed.ec != std::errc() || parsed.ptr != port.data() + port.size() || name.port == 0)
      fail(ErrorKind::usage, "{}: '{}' is no port; write a number from 1 to 65535", text, port);
    name.host.erase(colon);
  }
  if (name.host.empty()) fail(ErrorKind::usage, "{}: no host after the @; write DEVICE@HOST, such as localhost", text);
  return name;
}

Client::Client(RemoteName remote, bool use_udp)
    : remote_(std::move(remote)),
      names_{{remote_.device}, {std::string(kPing)}},
      server_(resolve(remote_.host, remote_.port)),
      own_(local_address_toward(server_)),
      use_udp_(use_udp && !remote_.direct),
      buffer_(kBuffer) {
  if (remote_.direct) return;
  waiting_ = Socket::listen_tcp(own_);
  udp_ = Socket::bind_udp(own_);
}

void Client::turn(Timestamp now, int wait_ms, const Handler& handler) {
  VERISIM_ASSERT(wait_ms >= 0);  // below, poll would wait for ever
  if (connection_ == nullptr) seek(now);
  if (connection_ != nullptr) {
    ping(now);
    write();
  }
  // A socket that is not open is passed over.
  const bool wants_out = connecting_ || (connection_ != nullptr && !connection_->unsent().empty());
  std::array<pollfd, 3> polled = {pollfd{waiting_.fd(), POLLIN, 0},
                                  {udp_.fd(), POLLIN, 0},
                                  {stream_.fd(), static_cast<short>(POLLIN | (wants_out ? POLLOUT : 0)), 0}};
  if (::poll(polled.data(), polled.size(), wait_ms) <= 0) return;
  if (polled[2].revents != 0) read_stream(now, handler);
  if (polled[1].revents != 0) read_datagrams(handler);
  if (polled[0].revents != 0) {
    Address from;
    Socket socket = waiting_.accept(from);
    if (socket.open() && connection_ == nullptr) begin(std::move(socket));  // a second one is closed
  }
}

void Client::seek(Timestamp now) {
  if (now.seconds < next_request_) return;
  next_request_ = now.seconds + kRetry;
  if (!remote_.direct) {
    udp_.send_datagram(encode(ConnectionRequest{own_.host(), waiting_.local().port}), server_);
    return;
  }
  Socket socket = Socket::connect_tcp(server_);
  if (!socket.open()) return;
  begin(std::move(socket));
  connecting_ = true;
}

void Client::begin(Socket socket) {
  stream_ = std::move(socket);
  std::optional<UdpEnd> own_udp;
  if (use_udp_) own_udp = UdpEnd{own_.host(), udp_.local().port};
  connection_ = std::make_unique<Connection>(names_, own_udp);
  ponged_ = false;
  next_ping_ = 0;
}

void Client::lose(std::string why) {
  last_loss_ = std::move(why);
  connection_.reset();
  stream_ = Socket();
  connecting_ = false;
}

void Client::read_stream(Timestamp now, const Handler& handler) {
  if (connecting_) {
    if (stream_.connect_failed()) return lose("nobody listens at " + server_.text());
    connecting_ = false;
    return;
  }
  const int length = stream_.read(buffer_);
  if (length < 0) return lose(server_.text() + " closed the connection");
  connection_->receive(View(buffer_).first(static_cast<std::size_t>(length)), now,
                       [&](const Received& message) { take(message, handler); });
  if (connection_->faulty()) lose(server_.text() + " " + connection_->fault());
}

void Client::read_datagrams(const Handler& handler) {
  for (int i = 0; i < kDatagramsPerTurn; ++i) {
    Address from;
    const int length = udp_.read_datagram(buffer_, from);
    if (length < 0) return;
    if (connection_ == nullptr || from.ip != server_.ip) continue;
    connection_->receive_datagram(View(buffer_).first(static_cast<std::size_t>(length)),
                                  [&](const Received& message) { take(message, handler); });
  }
}

void Client::take(const Received& message, const Handler& handler) {
  if (message.sender != remote_.device) return;
  if (message.type == kPong)
    ponged_ = true;
  else
    handler(message);
}

void Client::ping(Timestamp now) {
  if (!connection_->established() || ponged_ || now.seconds < next_ping_) return;
  connection_->send(remote_.device, kPing, now, {});
  next_ping_ = now.seconds + 1;
}

void Client::write() {
  if (connecting_) return;
  while (!connection_->unsent().empty()) {
    const int length = stream_.write(connection_->unsent());
    if (length < 0) return lose(server_.text() + " closed the connection");
    if (length == 0) return;
    connection_->sent(static_cast<std::size_t>(length));
  }
}

}  // namespace verisim::vrpn
