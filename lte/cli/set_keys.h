// Expert settings of a tool: keys of one repeatable flag, --set key=value.
//
// Keys are typed and checked as flags are, and an unknown one is answered with the nearest that
// there is. A key that is set to its default is as if it had not been set: what the tool prints as
// its configuration lists all of them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace lte {

class SetKeys {
 public:
  /// Reads the text of a value into its variable.
  /// @return  what is wrong with it, such as "expected on or off"; or nothing
  using Read = std::function<std::string(const std::string& text)>;
  /// The variable as text.
  using Show = std::function<std::string()>;

  /// Each adds a key. Variables must outlive this and have their defaults. Ranges are inclusive.
  void add(const std::string& key, int64_t* value, int64_t low, int64_t high,
           const std::string& help);
  void add(const std::string& key, int* value, int low, int high, const std::string& help);
  void add(const std::string& key, double* value, double low, double high, const std::string& help);
  void add(const std::string& key, bool* value, const std::string& help);  ///< on or off
  /// One of some words.
  void add(const std::string& key, std::string* value, std::vector<std::string> words,
           const std::string& help);
  /// @param kind  "SIZE", as the help shows it
  void add(const std::string& key, const std::string& kind, Read read, Show show,
           const std::string& help);

  /// Adds --set to `app`, whose help then lists the keys. This must outlive it.
  void add_to(CLI::App* app);

  /// Reads what --set was given, later values over earlier ones. When the command line is parsed.
  /// @throws lte::Error of one line that names the key
  void read();

  /// Whether the command line sets a key.
  bool is_given(const std::string& key) const;
  /// All keys with their values in force, in the order in which they were added.
  std::vector<std::string> in_force() const;

 private:
  struct Key {
    std::string name, kind, help;
    Read read;
    Show show;
    bool given = false;
  };
  Key* find(const std::string& name);

  std::vector<Key> keys_;
  std::vector<std::string> values_;  ///< as given
  CLI::Option* option_ = nullptr;
};

}  // namespace lte
