#include "infer/view/security.h"

#include <algorithm>
#include <cctype>
#include <random>

#include "lte/base/check.h"

namespace lte::infer::view {
namespace {

/// "localhost:8420" -> "localhost"; "[::1]:8420" -> "[::1]".
std::string_view without_port(std::string_view host) {
  const size_t colon = host.rfind(':');
  const bool has_port = colon != host.npos && host.find(']', colon) == host.npos;
  return has_port ? host.substr(0, colon) : host;
}

bool names_this_machine(std::string_view host, uint16_t port) {
  const std::string_view name = without_port(host);
  const bool known = name == "localhost" || name == "127.0.0.1" || name == "[::1]";
  return known && (name.size() == host.size() || host.substr(name.size()) == concat(':', port));
}

}  // namespace

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

std::string_view query_value(std::string_view target, std::string_view key) {
  const size_t mark = target.find('?');
  if (mark == target.npos) return {};
  std::string_view query = target.substr(mark + 1);
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    if (pair.size() > key.size() && pair.substr(0, key.size()) == key && pair[key.size()] == '=')
      return pair.substr(key.size() + 1);
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
  }
  return {};
}

bool equal_secrets(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

const char* refusal(const Access& access, const Caller& caller, bool is_socket) {
  if (access.loopback && !names_this_machine(caller.host, access.port))
    return "the address must be that of this machine";
  if (is_socket && !caller.origin.empty() && caller.origin != concat("http://", caller.host))
    return "a page of another origin";
  if (!access.token.empty() && !equal_secrets(query_value(caller.target, "token"), access.token))
    return "the token of the address is missing or wrong";
  return nullptr;
}

std::string random_token() {
  std::random_device device;
  std::string out;
  for (int word = 0; word < 4; ++word) {
    uint32_t bits = device();
    for (int digit = 0; digit < 8; ++digit, bits >>= 4) out += "0123456789abcdef"[bits & 15];
  }
  return out;
}

bool is_token(std::string_view text) {
  return text.size() >= 8 && text.size() <= 128 &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; });
}

}  // namespace lte::infer::view
