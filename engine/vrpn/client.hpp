// A VRPN client of one device. It asks for a connection (by UDP request or by TCP), asks again if the connection is
// lost, pings until the server has answered, and hands over every report. Reads no clock. No call waits longer than
// told. Source: reference/vrpn_wire.
#pragma once

#include <memory>
#include <string>

#include "engine/vrpn/connection.hpp"
#include "engine/vrpn/socket.hpp"

namespace verisim::vrpn {

/// "Device@host", "Device@host:port", "Device@x-vrpn://host:port"; with "tcp:" or "tcp://" before the host: directly.
struct RemoteName {
  std::string device;
  std::string host;
  std::uint16_t port = kDefaultPort;
  bool direct = false;  ///< by TCP; never uses UDP
};
/// Error(usage) naming the part that is wrong.
[[nodiscard]] RemoteName parse_remote_name(const std::string& text);

class Client {
 public:
  static constexpr std::uint32_t kRetry = 2;  ///< s between two requests

  /// `use_udp`: tell the server to send low-latency reports as datagrams (not on direct connections).
  /// Error(io) if the host is unknown or out of reach. @pre the device has a name (parse_remote_name)
  Client(RemoteName remote, bool use_udp);

  /// @pre wait_ms >= 0
  /// Waits up to `wait_ms`, and hands what came from the device to `handler`.
  void turn(Timestamp now, int wait_ms, const Handler& handler);

  [[nodiscard]] bool connected() const { return connection_ != nullptr && connection_->established(); }
  /// Why the last connection ended; empty if none has.
  [[nodiscard]] const std::string& last_loss() const { return last_loss_; }

 private:
  void seek(Timestamp now);
  void begin(Socket socket);
  void lose(std::string why);
  void read_stream(Timestamp now, const Handler& handler);
  void read_datagrams(const Handler& handler);
  void ping(Timestamp now);
  void write();
  void take(const Received& message, const Handler& handler);

  RemoteName remote_;
  Names names_;
  Address server_;
  Address own_;  ///< address of this client for the server
  bool use_udp_;
  Socket udp_;      ///< sends requests, takes reports
  Socket waiting_;  ///< for the server to connect back; not open if direct
  Socket stream_;
  std::unique_ptr<Connection> connection_;
  bool connecting_ = false;
  bool ponged_ = false;
  std::uint32_t next_request_ = 0;  ///< s
  std::uint32_t next_ping_ = 0;     ///< s
  std::string last_loss_;
  Bytes buffer_;
};

}  // namespace verisim::vrpn
