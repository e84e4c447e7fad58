#include "engine/vrpn/socket.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "engine/base/error.hpp"

namespace verisim::vrpn {
namespace {

constexpr int kBacklog = 128;
constexpr int kIdle = 10;               // s until a peer that says nothing is asked whether it is there …
constexpr int kProbeEvery = 5;          // s, and again …
constexpr int kProbes = 3;              // … before it is taken for gone
constexpr int kSendBuffer = 64 * 1024;  // small: what a peer does not read must not hide in the kernel for minutes

sockaddr_in native(const Address& address) {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_port = htons(address.port);
  a.sin_addr.s_addr = htonl(address.ip);
  return a;
}

Address from_native(const sockaddr_in& a) {
  return {ntohl(a.sin_addr.s_addr), ntohs(a.sin_port)};
}

// The sockets interface wants the general address type.
const sockaddr* general(const sockaddr_in& a) {
  return reinterpret_cast<const sockaddr*>(&a);
}
sockaddr* general(sockaddr_in& a) {
  return reinterpret_cast<sockaddr*>(&a);
}

Socket make(int type) {
  Socket made(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!made.open()) fail(ErrorKind::io, "cannot open a socket: {}", std::strerror(errno));
  return made;
}

void set_option(const Socket& socket, int level, int option, int value) {
  (void)::setsockopt(socket.fd(), level, option, &value, sizeof value);
}

void prepare_stream(const Socket& socket) {
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(socket, SOL_SOCKET, SO_SNDBUF, kSendBuffer);
  // A peer that vanished without a word, and reads datagrams, would be written to for ever.
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, kIdle);
  set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, kProbeEvery);
  set_option(socket, IPPROTO_TCP, TCP_KEEPCNT, kProbes);
}

void bind_to(const Socket& socket, const Address& at, const char* what) {
  const sockaddr_in a = native(at);
  if (::bind(socket.fd(), general(a), sizeof a) != 0)
    fail(ErrorKind::io, "{} {}: {}; choose another --port or --host", what, at.text(), std::strerror(errno));
}

bool would_wait() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

int transferred(ssize_t result) {
  if (result >= 0) return static_cast<int>(result);
  return would_wait() ? 0 : -1;
}

}  // namespace

std::string Address::host() const {
  return fmt::format("{}.{}.{}.{}", ip >> 24U, ip >> 16U & 255U, ip >> 8U & 255U, ip & 255U);
}

std::string Address::text() const {
  return fmt::format("{}:{}", host(), port);
}

std::optional<std::uint32_t> parse_ip(const std::string& host) {
  in_addr a{};
  if (::inet_pton(AF_INET, host.c_str(), &a) != 1) return {};
  return ntohl(a.s_addr);
}

Address resolve(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (error != 0) fail(ErrorKind::io, "host '{}': {}; give a name or an IPv4 address", host, ::gai_strerror(error));
  sockaddr_in a{};
  std::memcpy(&a, found->ai_addr, sizeof a);
  ::freeaddrinfo(found);
  return {from_native(a).ip, port};
}

Socket::~Socket() {
  if (open()) (void)::close(fd_);
}

Socket Socket::listen_tcp(const Address& at) {
  Socket socket = make(SOCK_STREAM);
  set_option(socket, SOL_SOCKET, SO_REUSEADDR, 1);  // a port in TIME_WAIT is free; one that is listened on is not
  bind_to(socket, at, "TCP");
  if (::listen(socket.fd(), kBacklog) != 0) fail(ErrorKind::io, "TCP {}: {}", at.text(), std::strerror(errno));
  return socket;
}

Socket Socket::bind_udp(const Address& at) {
  Socket socket = make(SOCK_DGRAM);
  bind_to(socket, at, "UDP");
  return socket;
}

Socket Socket::connect_tcp(const Address& to) {
  Socket socket = make(SOCK_STREAM);
  prepare_stream(socket);
  const sockaddr_in a = native(to);
  if (::connect(socket.fd(), general(a), sizeof a) != 0 && errno != EINPROGRESS) return {};
  return socket;
}

Address Socket::local() const {
  sockaddr_in a{};
  socklen_t length = sizeof a;
  (void)::getsockname(fd_, general(a), &length);
  return from_native(a);
}

Socket Socket::accept(Address& from) const {
  sockaddr_in a{};
  socklen_t length = sizeof a;
  Socket socket(::accept4(fd_, general(a), &length, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.open()) return socket;
  from = from_native(a);
  prepare_stream(socket);
  return socket;
}

bool Socket::connect_failed() const {
  int error = 0;
  socklen_t length = sizeof error;
  return ::getsockopt(fd_, SOL_SOCKET, SO_ERROR, &error, &length) != 0 || error != 0;
}

int Socket::read(std::span<std::uint8_t> into) const {
  const ssize_t n = ::recv(fd_, into.data(), into.size(), 0);
  return n == 0 ? -1 : transferred(n);
}

int Socket::write(View bytes) const {
  return transferred(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

int Socket::read_datagram(std::span<std::uint8_t> into, Address& from) const {
  sockaddr_in a{};
  socklen_t length = sizeof a;
  const ssize_t n = ::recvfrom(fd_, into.data(), into.size(), 0, general(a), &length);
  if (n < 0) return -1;
  from = from_native(a);
  return static_cast<int>(n);
}

void Socket::send_datagram(View bytes, const Address& to) const {
  const sockaddr_in a = native(to);
  (void)::sendto(fd_, bytes.data(), bytes.size(), 0, general(a), sizeof a);
}

Address local_address_toward(const Address& to) {
  const Socket probe = make(SOCK_DGRAM);
  const sockaddr_in a = native(to);
  if (::connect(probe.fd(), general(a), sizeof a) != 0)
    fail(ErrorKind::io, "no way to {}: {}", to.host(), std::strerror(errno));
  return {probe.local().ip, 0};
}

}  // namespace verisim::vrpn
