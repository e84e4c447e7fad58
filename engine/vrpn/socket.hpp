// IPv4 sockets that never wait: TCP and UDP, closed when they go out of scope. Linux.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "engine/vrpn/bytes.hpp"

namespace verisim::vrpn {

struct Address {
  std::uint32_t ip = 0;  ///< host byte order
  std::uint16_t port = 0;
  [[nodiscard]] std::string host() const;  ///< "127.0.0.1"
  [[nodiscard]] std::string text() const;  ///< "127.0.0.1:3883"
};
/// Numbers only; no name is looked up.
[[nodiscard]] std::optional<std::uint32_t> parse_ip(const std::string& host);
/// Looks a name up, which may take as long as the network takes. Error(io) if it has no IPv4 address.
[[nodiscard]] Address resolve(const std::string& host, std::uint16_t port);

class Socket {
 public:
  Socket() = default;
  explicit Socket(int fd) : fd_(fd) {}
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket();

  /// Bound to `at`; port 0 takes a free one. Error(io) with the reason if that cannot be had.
  [[nodiscard]] static Socket listen_tcp(const Address& at);
  [[nodiscard]] static Socket bind_udp(const Address& at);
  /// Begins to connect. Writable once that is decided; then connect_failed() is valid. Not open if refused at once.
  [[nodiscard]] static Socket connect_tcp(const Address& to);

  [[nodiscard]] bool open() const { return fd_ >= 0; }
  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] Address local() const;
  /// A waiting connection; not open if there is none.
  [[nodiscard]] Socket accept(Address& from) const;
  [[nodiscard]] bool connect_failed() const;

  /// Bytes read or written; 0: not now; -1: closed or broken.
  [[nodiscard]] int read(std::span<std::uint8_t> into) const;
  [[nodiscard]] int write(View bytes) const;
  /// One datagram's length; -1: none waits. A datagram longer than `into` is cut.
  [[nodiscard]] int read_datagram(std::span<std::uint8_t> into, Address& from) const;
  /// Sends a datagram, or drops it if it cannot be sent now.
  void send_datagram(View bytes, const Address& to) const;

 private:
  int fd_ = -1;
};

/// The local address from which `to` is reached.
[[nodiscard]] Address local_address_toward(const Address& to);

}  // namespace verisim::vrpn
