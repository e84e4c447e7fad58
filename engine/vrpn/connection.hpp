// One side of one connection without its sockets: received bytes, decoded messages, bytes to send
// (reference/vrpn_wire, "Connection set-up", "Names and ids", "Channels").
//
// Connections are independent of each other; they only use the same names. A peer that breaks the protocol, or does not
// read, makes its own connection faulty and no other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/vrpn/message.hpp"

namespace verisim::vrpn {

/// Names of one side's senders and types; the id of a name is its index. The same for all connections of that side, and
/// constant while one is open.
struct Names {
  std::vector<std::string> senders;
  std::vector<std::string> types;
};
/// Index of a name, or -1.
[[nodiscard]] std::int32_t id_of(const std::vector<std::string>& names, std::string_view name);

/// A message from the peer whose sender and type the peer has described.
struct Received {
  Timestamp time;
  std::string_view sender;
  std::string_view type;
  View payload;
};
using Handler = std::function<void(const Received&)>;

/// Address at which the peer receives datagrams.
struct UdpEnd {
  std::string host;  ///< as the peer wrote it; may be a name
  std::uint16_t port = 0;
};

class Connection {
 public:
  static constexpr std::size_t kUnsentMax = 256 * 1024;  ///< bytes that wait for a peer that does not read

  /// Queues the cookie. `own_udp`: described to the peer once its cookie is there. `names` must outlive this.
  /// @pre every name can be described (is_name), and there are fewer than 2000 of each
  explicit Connection(const Names& names, std::optional<UdpEnd> own_udp = {});

  /// Takes bytes from TCP, split anywhere. Hands every decoded message to `handler`. @param now  time stamp of answers
  void receive(View bytes, Timestamp now, const Handler& handler);
  /// One datagram. One that is malformed is ignored: anyone may have sent it.
  void receive_datagram(View datagram, const Handler& handler);

  /// Queues a message for TCP. Before established() it is dropped. @pre sender and type are among the names
  void send(std::string_view sender, std::string_view type, Timestamp time, View payload);
  /// The same message as one datagram. @pre established(); sender and type are among the names
  [[nodiscard]] Bytes datagram(std::string_view sender, std::string_view type, Timestamp time, View payload);

  [[nodiscard]] bool established() const { return established_; }  ///< the peer's cookie was good
  [[nodiscard]] const std::optional<UdpEnd>& peer_udp() const { return peer_udp_; }
  [[nodiscard]] bool faulty() const { return !fault_.empty(); }      ///< to be closed
  [[nodiscard]] const std::string& fault() const { return fault_; }  ///< why, one line

  [[nodiscard]] View unsent() const { return View(out_).subspan(sent_); }
  /// `bytes` of unsent() have left. @pre bytes <= unsent().size()
  void sent(std::size_t bytes);

 private:
  void take_cookie(Timestamp now);
  void take_messages(const Handler& handler);
  void take(const Message& message, const Handler& handler);
  void describe(std::vector<std::string>& peer_names, const Message& message);
  void send_system(std::int32_t type, std::int32_t sender, Timestamp time, View payload);
  void append(const Message& message);

  const Names* names_;
  std::optional<UdpEnd> own_udp_;
  std::optional<UdpEnd> peer_udp_;
  bool established_ = false;
  std::string fault_;
  Bytes in_;  ///< at most one incomplete message
  Bytes out_;
  std::size_t sent_ = 0;  ///< of out_
  std::uint32_t tcp_sequence_ = 0;
  std::uint32_t udp_sequence_ = 0;
  std::vector<std::string> peer_senders_;  ///< by the peer's id; empty: not described
  std::vector<std::string> peer_types_;
};

}  // namespace verisim::vrpn
