// A VRPN server: listens, connects back to clients that ask by UDP, answers pings, and sends reports to all clients.
//
// A slow, silent or malformed client never disturbs another: no call waits for a client, each client has its own
// bounded queue, each turn reads at most kReadMax bytes from each, and where kClientsMax are connected a newcomer takes
// the place of one that has not sent its cookie yet. An error of a client closes that client only; only the constructor
// can fail. Not thread-safe; reads no clock. Source: reference/vrpn_wire.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/vrpn/connection.hpp"
#include "engine/vrpn/socket.hpp"

namespace verisim::vrpn {

class Server {
 public:
  static constexpr std::size_t kClientsMax = 255;
  static constexpr std::size_t kReadMax = 64 * 1024;     ///< bytes of one client in one turn
  static constexpr std::uint32_t kGreetingMax = 10;      ///< s that a client may take to send its cookie
  static constexpr std::int64_t kSettling = 100'000;     ///< us after a client's first ping until it is ready
  static constexpr std::int64_t kSilentMax = 1'000'000;  ///< us after which one that does not ping is ready, too

  /// Listens at `at` on TCP and UDP; port 0 takes one that is free for both. Error(io) if the port is taken.
  /// @param devices, types  names that this server sends; ping and pong are added
  /// @pre is_name(each of them)
  Server(const Address& at, std::vector<std::string> devices, std::vector<std::string> types);

  /// Called with messages of a client to one of our devices, except pings. `reply` answers that client alone.
  using Reply = std::function<void(std::string_view type, View payload)>;
  using RequestHandler = std::function<void(const Received& request, const Reply& reply)>;
  void on_request(RequestHandler handler) { request_handler_ = std::move(handler); }

  /// Waits up to `wait_ms` for events and handles all that have occurred. @pre wait_ms >= 0
  void turn(Timestamp now, int wait_ms);
  /// Sends to all clients, by datagram to those that asked for datagrams, else by TCP, with the next turn at the
  /// latest. @pre device and type are among the names given to the constructor
  void publish(std::string_view device, std::string_view type, Timestamp time, View payload);

  [[nodiscard]] const Address& address() const { return address_; }
  /// Number of clients whose cookie was received.
  [[nodiscard]] std::size_t clients() const;
  /// Number of clients that have pinged one of our devices, or been silent for a second, and taken all that was sent to
  /// them by TCP, names included, so that no report finds them unprepared: a datagram may overtake the description of
  /// its type.
  [[nodiscard]] std::size_t ready_clients() const;
  /// Bytes queued for the slowest client.
  [[nodiscard]] std::size_t unsent() const;
  /// One line for each client that came or went since the last call.
  [[nodiscard]] std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

 private:
  struct Client {
    Socket socket;
    Address address;
    bool connecting = false;  ///< back to a client that asked by UDP
    bool direct = false;      ///< came by TCP: never uses UDP
    bool greeted = false;     ///< its arrival was reported
    bool ready = false;       ///< see ready_clients()
    Timestamp greeted_at = {};
    std::optional<Timestamp> pinged = {};
    bool gone = false;
    std::uint32_t since = 0;  ///< s
    Connection connection;
  };

  void listen(const Address& at);
  void take_requests(Timestamp now);
  void accept_all(Timestamp now);
  void add(Socket socket, const Address& address, bool direct, Timestamp now);
  void make_room();
  void read(Client& client, Timestamp now);
  void take(Client& client, Timestamp now, const Received& message);
  void write(Client& client);
  void judge(Client& client, Timestamp now);
  void close_gone();
  [[nodiscard]] std::optional<Address> udp_end(const Client& client) const;

  Names names_;
  Socket tcp_;
  Socket udp_;
  Address address_;
  RequestHandler request_handler_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::vector<std::string> notices_;
  Bytes buffer_;
};

}  // namespace verisim::vrpn
