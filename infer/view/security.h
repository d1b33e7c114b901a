// Who may talk to the server: where a request comes from, and whether it knows the token.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lte::infer::view {

struct Access {
  std::string token;     ///< empty: none is asked for
  bool loopback = true;  ///< the server listens to this machine alone
  uint16_t port = 0;
};

/// What of a request is judged.
struct Caller {
  std::string_view target;  ///< "/socket?token=..."
  std::string_view host;    ///< the header Host, empty if missing
  std::string_view origin;  ///< the header Origin, empty if missing
};

/// The path of a target: what stands before '?'.
std::string_view path_of(std::string_view target);

/// The value of `key` in the query of a target, without decoding; empty if there is none.
std::string_view query_value(std::string_view target, std::string_view key);

/// Whether both are equal, in a time that depends on the lengths alone.
bool equal_secrets(std::string_view a, std::string_view b);

/// Why a page or socket is refused; nullptr if it is not.
///
/// On loopback the Host must name this machine: a foreign name that resolves to 127.0.0.1 (DNS
/// rebinding) is refused. A browser's Origin must be this server. Without an Origin, which no
/// browser leaves out of a WebSocket, only Host and token count.
const char* refusal(const Access& access, const Caller& caller, bool is_socket);

/// 128 bits of the system's randomness as 32 hexadecimal digits.
std::string random_token();

/// Whether `text` may stand in an address as it is: 8 to 128 letters, digits, '-' and '_'.
bool is_token(std::string_view text);

}  // namespace lte::infer::view
