#include "engine/vrpn/server.hpp"

#include <poll.h>

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/vrpn/payload.hpp"

namespace verisim::vrpn {
namespace {

constexpr int kPortAttempts = 20;     // a port that is free for TCP may be taken for UDP
constexpr int kRequestsPerTurn = 16;  // connection requests; the rest waits

Names names_of(std::vector<std::string> devices, std::vector<std::string> types) {
  types.emplace_back(kPing);
  types.emplace_back(kPong);
  return {std::move(devices), std::move(types)};
}

}  // namespace

Server::Server(const Address& at, std::vector<std::string> devices, std::vector<std::string> types)
    : names_(names_of(std::move(devices), std::move(types))), buffer_(kReadMax) {
  for (const std::string& name : names_.senders) VERISIM_ASSERT(is_name(name));
  for (const std::string& name : names_.types) VERISIM_ASSERT(is_name(name));
  listen(at);
}

void Server::listen(const Address& at) {
  for (int attempt = 1;; ++attempt) {
    try {
      tcp_ = Socket::listen_tcp(at);
      address_ = tcp_.local();
      udp_ = Socket::bind_udp(address_);
      return;
    } catch (const Error&) {
      if (at.port != 0 || attempt == kPortAttempts) throw;
    }
  }
}

void Server::turn(Timestamp now, int wait_ms) {
  VERISIM_ASSERT(wait_ms >= 0);  // below, poll would wait for ever
  for (const auto& client : clients_) write(*client);
  std::vector<pollfd> polled = {{tcp_.fd(), POLLIN, 0}, {udp_.fd(), POLLIN, 0}};
  for (const auto& client : clients_) {
    const bool wants_out = client->connecting || !client->connection.unsent().empty();
    polled.push_back({client->socket.fd(), static_cast<short>(POLLIN | (wants_out ? POLLOUT : 0)), 0});
  }
  if (::poll(polled.data(), polled.size(), wait_ms) > 0) {
    for (std::size_t i = 0; i < clients_.size(); ++i)
      if (polled[2 + i].revents != 0) read(*clients_[i], now);
    if (polled[1].revents != 0) take_requests(now);
    if (polled[0].revents != 0) accept_all(now);
  }
  for (const auto& client : clients_) {
    write(*client);
    judge(*client, now);
  }
  close_gone();
}

void Server::take_requests(Timestamp now) {
  for (int i = 0; i < kRequestsPerTurn; ++i) {
    Address from;
    const int length = udp_.read_datagram(buffer_, from);
    if (length < 0) return;
    const auto request = decode_request(View(buffer_).first(static_cast<std::size_t>(length)));
    if (!request) continue;
    // Stock looks names up, and all of its clients wait meanwhile. Whoever sends a name is where the datagram is from.
    const Address to{parse_ip(request->host).value_or(from.ip), request->port};
    const auto same = [&](const auto& c) { return c->connecting && c->address.text() == to.text(); };
    if (std::any_of(clients_.begin(), clients_.end(), same)) continue;
    Socket socket = Socket::connect_tcp(to);
    if (!socket.open()) continue;
    add(std::move(socket), to, false, now);
  }
}

void Server::accept_all(Timestamp now) {
  Address from;
  for (Socket socket = tcp_.accept(from); socket.open(); socket = tcp_.accept(from))
    add(std::move(socket), from, true, now);
}

void Server::add(Socket socket, const Address& address, bool direct, Timestamp now) {
  if (clients_.size() >= kClientsMax) make_room();
  if (clients_.size() >= kClientsMax) {
    notices_.push_back(fmt::format("{} refused: {} clients are enough", address.text(), kClientsMax));
    return;
  }
  clients_.push_back(std::make_unique<Client>(Client{.socket = std::move(socket),
                                                     .address = address,
                                                     .connecting = !direct,
                                                     .direct = direct,
                                                     .since = now.seconds,
                                                     .connection = Connection(names_)}));
}

/// Whoever came and sent no cookie yet keeps nobody out who may: the one that has waited longest goes.
void Server::make_room() {
  const auto silent = std::find_if(clients_.begin(), clients_.end(),
                                   [](const auto& client) { return !client->connection.established(); });
  if (silent == clients_.end()) return;
  notices_.push_back(fmt::format("{} closed: it sent no cookie, and others come", (*silent)->address.text()));
  clients_.erase(silent);
}

void Server::read(Client& client, Timestamp now) {
  if (client.connecting) {
    client.gone = client.socket.connect_failed();
    client.connecting = false;
    return;  // what it sent is read in the next turn
  }
  const int length = client.socket.read(buffer_);
  if (length < 0) client.gone = true;
  if (length <= 0) return;
  client.connection.receive(View(buffer_).first(static_cast<std::size_t>(length)), now,
                            [&](const Received& message) { take(client, now, message); });
}

void Server::take(Client& client, Timestamp now, const Received& message) {
  if (id_of(names_.senders, message.sender) < 0) return;
  if (message.type == kPing) {
    if (!client.pinged) client.pinged = now;
    client.connection.send(message.sender, kPong, now, {});
  } else if (request_handler_) {
    request_handler_(message, [&](std::string_view type, View payload) {
      client.connection.send(message.sender, type, now, payload);
    });
  }
}

void Server::publish(std::string_view device, std::string_view type, Timestamp time, View payload) {
  for (const auto& client : clients_) {
    Connection& connection = client->connection;
    if (client->gone || !connection.established()) continue;
    const std::optional<Address> udp = udp_end(*client);
    if (udp)
      udp_.send_datagram(connection.datagram(device, type, time, payload), *udp);
    else
      connection.send(device, type, time, payload);
  }
}

std::optional<Address> Server::udp_end(const Client& client) const {
  const auto& end = client.connection.peer_udp();
  if (client.direct || !end) return {};
  return Address{parse_ip(end->host).value_or(client.address.ip), end->port};
}

void Server::write(Client& client) {
  if (client.connecting || client.gone) return;
  while (!client.connection.unsent().empty()) {
    const int length = client.socket.write(client.connection.unsent());
    if (length < 0) client.gone = true;
    if (length <= 0) return;
    client.connection.sent(static_cast<std::size_t>(length));
  }
}

void Server::judge(Client& client, Timestamp now) {
  const Connection& connection = client.connection;
  if (connection.established() && !client.greeted) {
    client.greeted = true;
    client.greeted_at = now;
    notices_.push_back(fmt::format("{} connected{}", client.address.text(), client.direct ? " directly" : ""));
  }
  if (client.greeted && connection.unsent().empty()) {
    const bool pinged = client.pinged && microseconds_between(*client.pinged, now) >= kSettling;
    client.ready = client.ready || pinged || microseconds_between(client.greeted_at, now) >= kSilentMax;
  }
  if (client.gone) {
    if (client.greeted) notices_.push_back(fmt::format("{} left", client.address.text()));
  } else if (connection.faulty()) {
    notices_.push_back(fmt::format("{} closed: it {}", client.address.text(), connection.fault()));
    client.gone = true;
  } else if (!connection.established() && now.seconds > client.since + kGreetingMax) {
    notices_.push_back(fmt::format("{} closed: it sent no cookie for {} s", client.address.text(), kGreetingMax));
    client.gone = true;
  }
}

void Server::close_gone() {
  std::erase_if(clients_, [](const auto& client) { return client->gone; });
}

std::size_t Server::clients() const {
  return static_cast<std::size_t>(
      std::count_if(clients_.begin(), clients_.end(), [](const auto& c) { return c->connection.established(); }));
}

std::size_t Server::ready_clients() const {
  return static_cast<std::size_t>(
      std::count_if(clients_.begin(), clients_.end(), [](const auto& c) { return c->ready; }));
}

std::size_t Server::unsent() const {
  std::size_t most = 0;
  for (const auto& client : clients_)
    if (client->connection.established()) most = std::max(most, client->connection.unsent().size());
  return most;
}

}  // namespace verisim::vrpn
